//! How tags move, how their radio differs from the map, and how the tracker works.

use crate::ConfigError;
use crate::config::{require, require_within};

/// How a [`Tracker`](super::Tracker) works.
///
/// ```
/// use foxhunt::fingerprint::tracker::Config;
///
/// const CART: Config = foxhunt::config!(Config { velocity_sigma_m_s: 3.0, ..Config::DEFAULT });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// Standard deviation of a tag's velocity along an axis when nothing is known of it, in metres a second: 0.01 to 100.
    pub velocity_sigma_m_s: f32,
    /// Variance that a velocity gains every second, in m^2/s^3: 0.0001 to 1000.
    pub velocity_noise_m2_s3: f32,
    /// Seconds in which a velocity falls to 1/e: at least 0.1; infinite for one that stays.
    pub velocity_memory_s: f32,
    /// Standard deviation in dB, 0.1 to 30, of the difference between a walk and the survey at one place, however many
    /// packets are averaged: by how a tag is worn, say. It adds to the error that the map states.
    pub mismatch_sigma_db: f32,
    /// Seconds in which what a tag at rest remembers of the map's error falls to 1/e: at least 0.1. Where it moves, that
    /// falls with the distance, too, over the length that the map states.
    pub error_memory_s: f32,
    /// The power, 0.01 to 1, to which the likelihood of a scan of twelve beacons is raised: below 1 because readings at one
    /// time have errors in common, too. Fewer beacons have less in common, so it is nearer to 1 for them.
    pub tempering: f32,
    /// Readings that differ by more than so many sigmas count as if they differed by that: none of them excludes a place.
    /// At least 0.5; infinite for normal errors.
    pub gate_sigmas: f32,
    /// The lowest and the highest strength in dBm that a radio can report, at least 10 dB apart within -128 and 127.
    pub range_dbm: [f32; 2],
    /// The probability, 0 to 0.99, that a tag reads otherwise than the one of the survey. At 0 no offset is estimated.
    pub offset_probability: f32,
    /// Standard deviation of its offset in that case, in dB: 0.1 to 50.
    pub offset_sigma_db: f32,
    /// Variance that an offset gains every second, in dB^2/s, by how the tag is worn: 0 to 100.
    pub offset_noise_db2_s: f32,
    /// Packets of so many milliseconds, up to a minute, make one update at their mean time; 0 for an update by every
    /// packet. Those of one beacon are averaged, so the work of an update does not grow with them.
    pub window_ms: u32,
    /// Fraction of the particles, 0 to 1, that is drawn anew from the match with the map when the evidence has gone
    /// against them.
    pub redraw_fraction: f32,
    /// A place is uncertain when its standard deviation in the worst direction is larger than this, in metres: 0.001 to 1,000,000.
    pub uncertain_sigma_m: f32,
}

impl Config {
    /// People on foot, who stop and turn, in the reach of a dozen radios: on the floor of an office, by Bluetooth.
    ///
    /// How each value was chosen is in the list of constants, which also says of which the measured walks were not kept apart.
    pub const DEFAULT: Self = Self {
        velocity_sigma_m_s: 0.5,
        velocity_noise_m2_s3: 0.09,
        velocity_memory_s: 7.0,
        mismatch_sigma_db: 2.0,
        error_memory_s: 10.0,
        tempering: 0.4,
        gate_sigmas: 4.0,
        range_dbm: [-110.0, -10.0],
        offset_probability: 0.1,
        offset_sigma_db: 8.0,
        offset_noise_db2_s: 0.3,
        window_ms: 500,
        redraw_fraction: 1.0 / 3.0,
        uncertain_sigma_m: 5.0,
    };

    /// A tunnel: at any pace up to that of a bicycle, past few radios, whose packets are nearly independent.
    pub const TUNNEL: Self = Self {
        velocity_sigma_m_s: 1.5,
        velocity_noise_m2_s3: 0.2,
        velocity_memory_s: f32::INFINITY,
        tempering: 1.0,
        gate_sigmas: f32::INFINITY,
        ..Self::DEFAULT
    };

    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self:
            velocity_sigma_m_s 0.01..=100.0,
            velocity_noise_m2_s3 0.0001..=1000.0,
            mismatch_sigma_db 0.1..=30.0,
            tempering 0.01..=1.0,
            offset_probability 0.0..=0.99,
            offset_sigma_db 0.1..=50.0,
            offset_noise_db2_s 0.0..=100.0,
            redraw_fraction 0.0..=1.0,
            uncertain_sigma_m 0.001..=1e6,
        );
        require!(
            self.velocity_memory_s >= 0.1,
            "velocity_memory_s is less than 0.1"
        );
        require!(
            self.error_memory_s >= 0.1,
            "error_memory_s is less than 0.1"
        );
        require!(self.window_ms <= 60_000, "window_ms is more than 60000");
        require!(self.gate_sigmas >= 0.5, "gate_sigmas is less than 0.5");
        let [lowest, highest] = self.range_dbm;
        require!(
            lowest >= -128.0 && highest <= 127.0 && highest - lowest >= 10.0,
            "range_dbm is not an interval of 10 dB or more within -128 and 127"
        );
        Ok(())
    }

    /// Whether a radio can report such a strength; false for NaN.
    pub(crate) fn accepts(&self, rssi_dbm: f32) -> bool {
        let [lowest, highest] = self.range_dbm;
        rssi_dbm >= lowest && rssi_dbm <= highest
    }
}
