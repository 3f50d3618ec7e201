//! Directions, and the conventions that they come in.

use core::f32::consts::{FRAC_PI_2, PI};

use crate::math::wrap;
use crate::snapshot::{Error, Reader, Value, Writer};

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

impl Value for Bearing {
    const SIZE: usize = 4;

    fn write(&self, to: &mut Writer<'_>) {
        self.0.write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        // As it was: what has been wrapped is not wrapped again.
        match f32::read(from)? {
            radians if radians.abs() > PI => Err(Error::Malformed),
            radians => Ok(Self(radians)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compass_degrees_come_back() {
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
