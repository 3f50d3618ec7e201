//! One bearing, taken at one place.

use core::fmt;

use super::Bearing;
use crate::snapshot::{Error, Reader, Value, Writer};

/// A bearing on the source, the place it was taken from and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Observation {
    position: [f32; 2],
    bearing: Bearing,
    deviation: f32,
}

/// Why an [`Observation`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ObservationError {
    /// `position` is not finite, or further than [`Observation::MAX_COORDINATE_M`] from the origin.
    Position,
    /// `bearing` is not finite.
    Bearing,
    /// `deviation` is not within [`Observation::MIN_DEVIATION_RAD`] and [`Observation::MAX_DEVIATION_RAD`].
    Deviation,
    /// `share` is not within 0 and 1.
    Share,
}

impl fmt::Display for ObservationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position is not finite or too far from the origin",
            Self::Bearing => "bearing is not finite",
            Self::Deviation => "deviation is out of range",
            Self::Share => "share is not within 0 and 1",
        })
    }
}

impl core::error::Error for ObservationError {}

impl Observation {
    /// Largest coordinate, in metres: beyond it an f32 no longer resolves a decimetre.
    pub const MAX_COORDINATE_M: f32 = 1e6;
    /// Smallest standard deviation of a bearing, in radians.
    pub const MIN_DEVIATION_RAD: f32 = 1e-3;
    /// Largest standard deviation of a bearing, in radians; a bearing worse than that says nothing.
    pub const MAX_DEVIATION_RAD: f32 = 3.2;

    /// A `bearing` taken at `position` (metres east and north of the origin) with the standard
    /// deviation `deviation` (radians).
    ///
    /// # Errors
    /// Names the argument that is not finite or out of range.
    pub fn new(
        position: [f32; 2],
        bearing: Bearing,
        deviation: f32,
    ) -> Result<Self, ObservationError> {
        let near = |v: f32| v.abs() <= Self::MAX_COORDINATE_M;
        if !(near(position[0]) && near(position[1])) {
            return Err(ObservationError::Position);
        }
        if !bearing.radians().is_finite() {
            return Err(ObservationError::Bearing);
        }
        if !(Self::MIN_DEVIATION_RAD..=Self::MAX_DEVIATION_RAD).contains(&deviation) {
            return Err(ObservationError::Deviation);
        }
        Ok(Self {
            position,
            bearing,
            deviation,
        })
    }

    /// Where it was taken, in metres east and north of the origin.
    pub const fn position(&self) -> [f32; 2] {
        self.position
    }

    /// The direction of the source.
    pub const fn bearing(&self) -> Bearing {
        self.bearing
    }

    /// Standard deviation of the bearing, in radians.
    pub const fn deviation(&self) -> f32 {
        self.deviation
    }

    /// What the bearing counts for beside others: the inverse of its variance.
    pub(super) fn information(&self) -> f32 {
        1.0 / (self.deviation * self.deviation)
    }
}

/// One of several bearings of one reading that exclude each other, like the peaks of a [spectrum](super::spectrum).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Alternative {
    observation: Observation,
    share: f32,
}

impl Alternative {
    /// A bearing with the probability, beside the others, that it is the one if any is. All together are to have one.
    ///
    /// # Errors
    /// When the `share` is outside 0 to 1.
    pub const fn new(observation: Observation, share: f32) -> Result<Self, ObservationError> {
        if !(share >= 0.0 && share <= 1.0) {
            return Err(ObservationError::Share);
        }
        Ok(Self { observation, share })
    }

    /// The bearing.
    pub const fn observation(&self) -> &Observation {
        &self.observation
    }

    /// Its share.
    pub const fn share(&self) -> f32 {
        self.share
    }
}

impl From<Observation> for Alternative {
    /// Without any other.
    fn from(observation: Observation) -> Self {
        Self {
            observation,
            share: 1.0,
        }
    }
}

impl Value for Observation {
    const SIZE: usize = <[f32; 2]>::SIZE + Bearing::SIZE + f32::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        self.position.write(to);
        self.bearing.write(to);
        self.deviation.write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        let position = Value::read(from)?;
        let bearing = Value::read(from)?;
        let deviation = Value::read(from)?;
        Self::new(position, bearing, deviation).map_err(|_| Error::Malformed)
    }
}
