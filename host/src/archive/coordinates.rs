//! Places and angles as people read them.

use foxhunt::aoa::geodesy::{Geodetic, LocalPlane};

/// Longitude and latitude in degrees, as GeoJSON has them, of a place in metres east and north of the plane's origin; `None`
/// beyond the plane. To 1e-7 degree, as the gateway reports it.
pub fn coordinates(plane: &LocalPlane, place: [f32; 2]) -> Option<[f64; 2]> {
    plane.to_geodetic(place).ok().map(degrees)
}

/// Longitude and latitude in degrees.
pub(super) fn degrees(place: Geodetic) -> [f64; 2] {
    [place.longitude_e7(), place.latitude_e7()].map(|value| f64::from(value) / 1e7)
}

/// The time of day, `hh:mm:ss.sss`.
pub(super) fn clock(time_ms: u32) -> String {
    let (seconds, milliseconds) = (time_ms / 1000, time_ms % 1000);
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!(
        "{hours:02}:{minutes:02}:{:02}.{milliseconds:03}",
        seconds % 60
    )
}

/// So many decimals.
pub(super) fn rounded(value: impl Into<f64>, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value.into() * scale).round() / scale
}

/// Degrees clockwise from north within a turn, of radians counter-clockwise from east.
pub(super) fn compass(radians: f64) -> f64 {
    rounded((90.0 - radians.to_degrees()).rem_euclid(360.0), 2) % 360.0
}

/// The same of an axis, which has no sense: within half a turn.
pub(super) fn axis(radians: f32) -> f64 {
    rounded(compass(f64::from(radians)) % 180.0, 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn times_and_angles() {
        assert_eq!(clock(86_399_999), "23:59:59.999");
        assert_eq!(clock(34_204_005), "09:30:04.005");
        assert_eq!(compass(0.0), 90.0);
        assert_eq!(compass(FRAC_PI_2), 0.0);
        assert_eq!(compass(FRAC_PI_2 + 1e-9), 0.0);
        assert_eq!(compass(PI), 270.0);
        assert_eq!(axis(-1.0e-9 - FRAC_PI_2 as f32), 0.0);
        assert_eq!(axis(0.0), 90.0);
        assert_eq!(rounded(1.234_56_f32, 3), 1.235);
    }
}
