//! Bearings that do not come as lines.

use super::clock::TimeOfDay;
use super::config::BearingReference;
use super::formats::format::{Reading, Reference};
use super::outcome::Rejected;
use crate::aoa::geodesy::Geodetic;

/// A bearing that a program has already decoded, such as one from a network, for
/// [`Vehicle::push_record`](super::Vehicle::push_record).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BearingRecord {
    /// When it was taken, in milliseconds after midnight UTC; `None` for the receiver's latest time.
    pub time_ms: Option<u32>,
    /// Where it was taken; `None` for where the receiver says that the vehicle was then.
    pub place: Option<Geodetic>,
    /// Clockwise from what `reference` says, in degrees from 0 to 360.
    pub degrees: f32,
    /// What `degrees` count from.
    pub reference: BearingReference,
    /// Where the bow pointed, in degrees clockwise from true north from 0 to 360; `None` for what the receiver says. Of no
    /// use for a bearing from true north.
    pub heading_deg: Option<f32>,
    /// Standard deviation, in radians; `None` for what [`Config`](super::Config) says of the quality.
    pub sigma_rad: Option<f32>,
    /// 0 to 100.
    pub quality: f32,
}

impl BearingRecord {
    /// A bearing of full quality that was taken now and here, clockwise from true north.
    pub const fn new(degrees: f32) -> Self {
        Self {
            time_ms: None,
            place: None,
            degrees,
            reference: BearingReference::TrueNorth,
            heading_deg: None,
            sigma_rad: None,
            quality: 100.0,
        }
    }

    pub(super) fn reading(&self) -> Result<Reading, Rejected> {
        let of_a_turn = |degrees: f32| (0.0..=360.0).contains(&degrees);
        if !self.heading_deg.is_none_or(of_a_turn) {
            return Err(Rejected::OutOfRange);
        }
        let mut reading = Reading::new(self.degrees, self.quality, None)?;
        reading.time = self.time_ms.map(|time| TimeOfDay::from_epoch(time.into()));
        reading.place = self.place;
        reading.best.sigma_rad = self.sigma_rad;
        reading.reference = match self.reference {
            BearingReference::TrueNorth => Reference::North,
            BearingReference::Relative => Reference::Bow(self.heading_deg),
        };
        Ok(reading)
    }
}
