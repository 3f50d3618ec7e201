//! Directions, and bearings taken at a place and time.

use core::f32::consts::{FRAC_PI_2, PI, TAU};

use crate::error::messages;
use crate::math::wrap;
use crate::snapshot::{by_value, value_as};

/// A direction in the local east-north plane.
///
/// Held as a mathematical angle: radians, counter-clockwise from east, in [-pi, pi]. Compasses and
/// direction finders count clockwise from north, or from the bow of the vehicle, so there is no
/// plain `new`: every constructor names the convention of what it is given.
///
/// ```
/// use foxhunt::aoa::Bearing;
///
/// let north_west = Bearing::from_compass_degrees(315.0);
/// assert!((north_west.radians() - 2.3561945).abs() < 1e-6);
///
/// // The array reads 30 degrees to the right of a bow that points south-east.
/// let absolute = Bearing::from_relative_degrees(30.0, 135.0);
/// assert!((absolute.compass_degrees() - 165.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Bearing(f32);

impl Bearing {
    /// From radians counter-clockwise from east, the convention of `atan2(north, east)`.
    pub fn from_radians(radians: f32) -> Self {
        Self(wrap(radians))
    }

    /// From degrees clockwise from true north.
    pub fn from_compass_degrees(degrees: f32) -> Self {
        Self(wrap(FRAC_PI_2 - degrees * (PI / 180.0)))
    }

    /// From degrees clockwise from the bow of a vehicle, whose own `heading` is in degrees clockwise
    /// from true north.
    pub fn from_relative_degrees(degrees: f32, heading: f32) -> Self {
        Self::from_compass_degrees(heading + degrees)
    }

    /// Radians counter-clockwise from east, in [-pi, pi]; NaN if it was made from an angle that is not
    /// finite or beyond a million radians.
    pub const fn radians(self) -> f32 {
        self.0
    }

    /// Degrees clockwise from true north, in [0, 360).
    pub fn compass_degrees(self) -> f32 {
        let degrees = 90.0 - self.0 * (180.0 / PI);
        let degrees = if degrees < 0.0 {
            degrees + 360.0
        } else {
            degrees
        };
        // Just west of north the sum rounds up.
        if degrees >= 360.0 { 0.0 } else { degrees }
    }
}

// As it was: what has been wrapped is not wrapped again.
value_as!(Bearing as f32:
    |bearing| bearing.0,
    |radians| Some(Self(radians)).filter(|_| radians.is_nan() || radians.abs() <= PI),
);

/// A bearing on the source, where and when it was taken, by which station, and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Observation {
    time_ms: u32,
    position: [f32; 2],
    bearing: Bearing,
    sigma_rad: f32,
    /// In 65,536ths of a turn, counter-clockwise from east.
    heading: u16,
    station: u8,
    channel: u8,
}

/// Why an [`Observation`], an [`Alternative`](crate::aoa::Alternative), a place or a spectrum was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ObservationError {
    /// The latitude is not from -90 to 90 degrees.
    Latitude,
    /// The longitude is not from -180 to 180 degrees.
    Longitude,
    /// A plane cannot have its origin within five degrees of a pole.
    NearPole,
    /// A position is not finite, or further from the origin than [`Observation::MAX_COORDINATE_M`], or than
    /// [`LocalPlane::MAX_RANGE_M`](crate::aoa::geodesy::LocalPlane::MAX_RANGE_M) when it is converted.
    Position,
    /// `bearing` is not finite.
    Bearing,
    /// `sigma_rad` is not from [`Observation::MIN_SIGMA_RAD`] to [`Observation::MAX_SIGMA_RAD`].
    Sigma,
    /// `probability` is not from 0 to 1.
    Probability,
    /// A level of a spectrum is not from 0 to
    /// [`Spectrum::MAX_DECIBELS`](crate::aoa::spectrum::Spectrum::MAX_DECIBELS).
    Level,
    /// A spectrum has more values than degrees.
    Degrees,
}

messages!(ObservationError {
    Self::Latitude => "latitude must be from -90 to 90 degrees",
    Self::Longitude => "longitude must be from -180 to 180 degrees",
    Self::NearPole => "origin is within five degrees of a pole",
    Self::Position => "position is not finite or too far from the origin",
    Self::Bearing => "bearing is not finite",
    Self::Sigma => "sigma_rad is out of range",
    Self::Probability => "probability must be from 0 to 1",
    Self::Level => "a level is out of range",
    Self::Degrees => "more values than degrees",
});

/// Why a bearing was not taken. The locator is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PushError {
    /// It was taken before all bearings that the locator still keeps: it comes too late.
    TooOld,
    /// A bearing of the same station and time has been taken already.
    Duplicate,
    /// A reading without a single bearing.
    Empty,
}

messages!(PushError {
    Self::TooOld => "the bearing is older than all that are kept",
    Self::Duplicate => "a bearing of this station and time was taken already",
    Self::Empty => "the reading holds no bearing",
});

impl Observation {
    /// Largest coordinate, in metres: beyond it an f32 no longer resolves a decimetre.
    pub const MAX_COORDINATE_M: f32 = 1e6;
    /// Smallest standard deviation of a bearing, in radians.
    pub const MIN_SIGMA_RAD: f32 = 1e-3;
    /// Largest standard deviation of a bearing, in radians; a bearing worse than that says nothing.
    pub const MAX_SIGMA_RAD: f32 = 3.2;

    /// A `bearing` taken at the time `time_ms` and at `position` (metres east and north of the origin), with the standard
    /// deviation `sigma_rad` (radians).
    ///
    /// Times are milliseconds from any origin and may wrap: two are compared by their difference, of less than 24 days.
    ///
    /// # Errors
    /// Names the argument that is not finite or out of range.
    pub fn new(
        time_ms: u32,
        position: [f32; 2],
        bearing: Bearing,
        sigma_rad: f32,
    ) -> Result<Self, ObservationError> {
        let near = |v: f32| v.abs() <= Self::MAX_COORDINATE_M;
        if !(near(position[0]) && near(position[1])) {
            return Err(ObservationError::Position);
        }
        if !bearing.radians().is_finite() {
            return Err(ObservationError::Bearing);
        }
        if !(Self::MIN_SIGMA_RAD..=Self::MAX_SIGMA_RAD).contains(&sigma_rad) {
            return Err(ObservationError::Sigma);
        }
        Ok(Self {
            time_ms,
            position,
            bearing,
            sigma_rad,
            heading: 0,
            station: 0,
            channel: 0,
        })
    }

    /// The same bearing, taken by another station than number 0: by another antenna array.
    #[must_use]
    pub const fn from_station(mut self, station: u8) -> Self {
        self.station = station;
        self
    }

    /// The same bearing, heard on another channel than number 0: on another frequency, or of another tag.
    #[must_use]
    pub const fn on_channel(mut self, channel: u8) -> Self {
        self.channel = channel;
        self
    }

    /// The same bearing, taken by an array that pointed there: what the array gets wrong in one direction as it sees it, it
    /// gets wrong again. Kept to 0.006 degrees.
    #[must_use]
    pub fn with_heading(mut self, heading: Bearing) -> Self {
        const STEPS: f32 = 65_536.0 / TAU;
        // From -32,768 to 32,768, which are one direction; NaN becomes zero.
        self.heading = (heading.radians() * STEPS) as i32 as u16;
        self
    }

    /// Where the array pointed: east, if that was not said.
    pub fn heading(&self) -> Bearing {
        const STEP: f32 = TAU / 65_536.0;
        Bearing(STEP * f32::from(self.heading as i16))
    }

    /// When it was taken, in milliseconds.
    pub const fn time_ms(&self) -> u32 {
        self.time_ms
    }

    /// Number of the antenna array that took it.
    pub const fn station(&self) -> u8 {
        self.station
    }

    /// Number of the channel that it was heard on.
    pub const fn channel(&self) -> u8 {
        self.channel
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
    pub const fn sigma_rad(&self) -> f32 {
        self.sigma_rad
    }

    /// The same bearing with another standard deviation, which is in range.
    pub(in crate::aoa) const fn with_sigma(mut self, sigma_rad: f32) -> Self {
        self.sigma_rad = sigma_rad;
        self
    }

    /// The same with a bearing that is turned by an angle in radians.
    pub(in crate::aoa) fn turned_by(mut self, angle: f32) -> Self {
        self.bearing = Bearing::from_radians(self.bearing.radians() + angle);
        self
    }

    /// Inverse of the variance, in 1 / rad^2.
    pub(in crate::aoa) fn information(&self) -> f32 {
        1.0 / (self.sigma_rad * self.sigma_rad)
    }

    /// Milliseconds from `earlier` to this time; negative if this is the earlier one.
    pub(in crate::aoa) const fn since_ms(&self, earlier_ms: u32) -> i32 {
        self.time_ms.wrapping_sub(earlier_ms) as i32
    }
}

impl AsRef<Self> for Observation {
    fn as_ref(&self) -> &Self {
        self
    }
}

value_as!(Observation as ((u32, [f32; 2]), ((Bearing, f32), [u8; 4])):
    |taken| (
        (taken.time_ms, taken.position),
        ((taken.bearing, taken.sigma_rad), bytes(taken)),
    ),
    |((time_ms, position), ((bearing, sigma_rad), [station, channel, low, high]))| {
        let mut observation = Self::new(time_ms, position, bearing, sigma_rad).ok()?;
        observation.heading = u16::from_le_bytes([low, high]);
        Some(observation.from_station(station).on_channel(channel))
    },
);

by_value!(Observation);

/// Station, channel and heading.
const fn bytes(observation: &Observation) -> [u8; 4] {
    let [low, high] = observation.heading.to_le_bytes();
    [observation.station, observation.channel, low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_kept_to_half_a_step() {
        let at_rest = Observation::new(0, [0.0; 2], Bearing(0.0), 0.1).unwrap();
        assert_eq!(at_rest.heading(), Bearing(0.0));
        for tenth in -1_800..=1_800 {
            let radians = (tenth as f32 * 0.1).to_radians();
            let heading = at_rest
                .with_heading(Bearing::from_radians(radians))
                .heading();
            let off = wrap(heading.radians() - radians).abs();
            assert!(off <= TAU / 65_536.0, "{tenth}: {off}");
        }
        let nowhere = at_rest.with_heading(Bearing::from_radians(f32::NAN));
        assert_eq!(nowhere.heading(), Bearing(0.0));
    }

    #[test]
    fn observations_reach_to_the_ends_of_their_ranges() {
        let new = |x, y, sigma_rad| Observation::new(0, [x, y], Bearing(0.0), sigma_rad);
        for (x, y, sigma_rad) in [(1e6, -1e6, 0.001), (-1e6, 1e6, 3.2)] {
            assert!(new(x, y, sigma_rad).is_ok());
        }
        for (x, y) in [(1.1e6, 0.0), (0.0, -1.1e6), (f32::NAN, 0.0)] {
            assert_eq!(new(x, y, 0.1), Err(ObservationError::Position));
        }
        for sigma_rad in [0.000_9, 3.21, f32::NAN] {
            assert_eq!(new(0.0, 0.0, sigma_rad), Err(ObservationError::Sigma));
        }
    }

    #[test]
    fn compass_degrees_are_restored() {
        for tenth in 0..3600 {
            let degrees = tenth as f32 * 0.1;
            let back = Bearing::from_compass_degrees(degrees).compass_degrees();
            let off = (back - degrees).abs();
            assert!(off.min(360.0 - off) < 1e-4 && (0.0..360.0).contains(&back));
        }
        assert!(Bearing::from_compass_degrees(-1e-6).compass_degrees() < 360.0);
        assert!(
            Bearing::from_compass_degrees(f32::INFINITY)
                .radians()
                .is_nan()
        );
    }
}
