//! Latitude and longitude to metres, and back.
//!
//! An f32 holds degrees to half a metre at best, so coordinates stay integers of 1e-7 degree (11 mm) until
//! their difference from an origin is taken; from there f32 metres resolve millimetres.

use super::ObservationError;
use crate::math;
use crate::snapshot::{by_value, value_as};

/// Degrees of 1e-7 in half a turn.
const HALF_TURN_E7: i32 = 1_800_000_000;
const QUARTER_TURN_E7: i32 = HALF_TURN_E7 / 2;
const RADIANS_PER_E7: f32 = core::f32::consts::PI / HALF_TURN_E7 as f32;
const E7_PER_RADIAN: f32 = HALF_TURN_E7 as f32 / core::f32::consts::PI;

/// WGS84: semi-major axis in metres and first eccentricity squared.
const SEMI_MAJOR_M: f32 = 6_378_137.0;
const ECCENTRICITY_2: f32 = 6.694_38e-3;

/// A place on the WGS84 ellipsoid, in integers of 1e-7 degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Geodetic {
    latitude_e7: i32,
    longitude_e7: i32,
}

impl Geodetic {
    /// From degrees times 1e7, north and east positive.
    ///
    /// # Errors
    /// Names the coordinate that is out of range.
    pub const fn new(latitude_e7: i32, longitude_e7: i32) -> Result<Self, ObservationError> {
        if latitude_e7 < -QUARTER_TURN_E7 || latitude_e7 > QUARTER_TURN_E7 {
            return Err(ObservationError::Latitude);
        }
        if longitude_e7 < -HALF_TURN_E7 || longitude_e7 > HALF_TURN_E7 {
            return Err(ObservationError::Longitude);
        }
        Ok(Self {
            latitude_e7,
            longitude_e7,
        })
    }

    /// Degrees north of the equator, times 1e7.
    pub const fn latitude_e7(self) -> i32 {
        self.latitude_e7
    }

    /// Degrees east of Greenwich, times 1e7.
    pub const fn longitude_e7(self) -> i32 {
        self.longitude_e7
    }

    /// Whether another place is less than so many metres away; no for one beyond the range of a [`LocalPlane`] here.
    #[inline(never)]
    pub fn is_within(self, other: Self, metres: f32) -> bool {
        let moved = LocalPlane::new(self).and_then(|plane| plane.to_local(other));
        moved.is_ok_and(|[east, north]| east * east + north * north < metres * metres)
    }
}

/// The plane that touches the ellipsoid at an origin: metres east and north of it.
///
/// It is the east-north plane of the usual ECEF to ENU conversion, by its Taylor series about the origin,
/// of third order in latitude and fifth in longitude: exact to a centimetre and 1e-5 of the distance, in both
/// directions and across the antimeridian.
///
/// ```
/// use foxhunt::aoa::geodesy::{Geodetic, LocalPlane};
///
/// let origin = Geodetic::new(481_173_000, 115_166_667)?;
/// let plane = LocalPlane::new(origin)?;
/// let [east, north] = plane.to_local(Geodetic::new(481_183_000, 115_166_667)?)?;
/// assert!(east.abs() < 0.01 && (north - 111.2).abs() < 0.05);
/// assert_eq!(plane.to_geodetic([0.0, 0.0])?, origin);
/// # Ok::<(), foxhunt::aoa::ObservationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LocalPlane {
    origin: Geodetic,
    sin_latitude: f32,
    /// Distance of a parallel from the axis, in metres: its value at the origin and its first three
    /// derivatives by the latitude, divided by 1, 2 and 6.
    parallel: [f32; 4],
    /// Metres north along the meridian, the same; it begins with the first derivative.
    meridian: [f32; 3],
}

impl LocalPlane {
    /// Longest distance from the origin, in metres, that is converted.
    pub const MAX_RANGE_M: f32 = 100_000.0;

    /// Closer to a pole the series in longitude is too short.
    const MAX_LATITUDE_E7: i32 = 850_000_000;
    /// Larger than the range, which spans 0.9 degrees of latitude.
    const MAX_LATITUDE_STEP_RAD: f32 = 0.02;
    /// Where the parallel is shortest the range spans 0.22 rad of longitude.
    const MAX_LONGITUDE_STEP_RAD: f32 = 0.25;

    /// The plane through `origin`.
    ///
    /// # Errors
    /// [`ObservationError::NearPole`] above 85 degrees north or south.
    pub fn new(origin: Geodetic) -> Result<Self, ObservationError> {
        if origin.latitude_e7.abs() > Self::MAX_LATITUDE_E7 {
            return Err(ObservationError::NearPole);
        }
        let (sin, cos) = sin_cos_latitude(origin.latitude_e7);
        // Radius of the prime vertical N, and of the meridian M with its derivative by the latitude.
        let w2 = 1.0 - ECCENTRICITY_2 * sin * sin;
        let prime = SEMI_MAJOR_M / math::sqrt(w2);
        let meridian = prime * (1.0 - ECCENTRICITY_2) / w2;
        let slope = 3.0 * ECCENTRICITY_2 * sin * cos * meridian / w2;
        // The distance from the axis is p = N cos, with p' = -M sin.
        Ok(Self {
            origin,
            sin_latitude: sin,
            parallel: [
                prime * cos,
                -meridian * sin,
                -0.5 * (meridian * cos + slope * sin),
                (meridian * sin - 2.0 * slope * cos) / 6.0,
            ],
            meridian: [meridian, 0.5 * slope, -meridian / 6.0],
        })
    }

    /// Where the plane touches the ellipsoid.
    pub const fn origin(&self) -> Geodetic {
        self.origin
    }

    /// Metres east and north of the origin.
    ///
    /// # Errors
    /// [`ObservationError::Position`] beyond [`Self::MAX_RANGE_M`].
    pub fn to_local(&self, place: Geodetic) -> Result<[f32; 2], ObservationError> {
        // Exact in integers; longitudes the short way round.
        let latitude_step = place.latitude_e7 - self.origin.latitude_e7;
        let longitude_step =
            wrap_e7(i64::from(place.longitude_e7) - i64::from(self.origin.longitude_e7));
        let d = latitude_step as f32 * RADIANS_PER_E7;
        let l = longitude_step as f32 * RADIANS_PER_E7;
        if d.abs() > Self::MAX_LATITUDE_STEP_RAD || l.abs() > Self::MAX_LONGITUDE_STEP_RAD {
            return Err(ObservationError::Position);
        }
        let p = self.parallel(d);
        let [m1, m2, m3] = self.meridian;
        let east = p * sin(l);
        let north = d * (m1 + d * (m2 + d * m3)) + self.sin_latitude * p * one_minus_cos(l);
        within_range([east, north])
    }

    /// The place at `local` metres east and north of the origin.
    ///
    /// # Errors
    /// [`ObservationError::Position`] if not finite or beyond [`Self::MAX_RANGE_M`].
    pub fn to_geodetic(&self, local: [f32; 2]) -> Result<Geodetic, ObservationError> {
        /// Each round leaves less than a tenth of the error, even at 85 degrees.
        const ROUNDS: u32 = 6;
        let [east, north] = within_range(local)?;
        let [m1, m2, m3] = self.meridian;
        let (mut d, mut l) = (0.0, 0.0);
        for _ in 0..ROUNDS {
            let p = self.parallel(d);
            l = asin(east / p);
            d = (north - self.sin_latitude * p * one_minus_cos(l)) / (m1 + d * (m2 + d * m3));
        }
        let latitude = self.origin.latitude_e7 + round(d * E7_PER_RADIAN);
        let longitude =
            wrap_e7(i64::from(self.origin.longitude_e7) + i64::from(round(l * E7_PER_RADIAN)));
        Geodetic::new(latitude, longitude)
    }

    /// Distance from the axis, in metres, of the parallel `d` radians north of the origin.
    fn parallel(&self, d: f32) -> f32 {
        let [p0, p1, p2, p3] = self.parallel;
        p0 + d * (p1 + d * (p2 + d * p3))
    }
}

value_as!(Geodetic as (i32, i32):
    |place| (place.latitude_e7, place.longitude_e7),
    |(latitude_e7, longitude_e7)| Self::new(latitude_e7, longitude_e7).ok(),
);

value_as!(LocalPlane as Geodetic: |plane| plane.origin, |origin| Self::new(origin).ok());

by_value!(Geodetic, LocalPlane);

/// Sine and cosine of a latitude. Beyond 45 degrees they are computed from the angle to the pole, whose integer is exact, so
/// that the cosine keeps its relative accuracy.
fn sin_cos_latitude(latitude_e7: i32) -> (f32, f32) {
    let magnitude = latitude_e7.abs();
    let (sin, cos) = if magnitude <= QUARTER_TURN_E7 / 2 {
        math::sin_cos(magnitude as f32 * RADIANS_PER_E7)
    } else {
        let (cos, sin) = math::sin_cos((QUARTER_TURN_E7 - magnitude) as f32 * RADIANS_PER_E7);
        (sin, cos)
    };
    (if latitude_e7 < 0 { -sin } else { sin }, cos)
}

/// The same longitude, from -180 to 180 degrees.
fn wrap_e7(longitude_e7: i64) -> i32 {
    const HALF: i64 = HALF_TURN_E7 as i64;
    let wrapped = if longitude_e7 > HALF {
        longitude_e7 - 2 * HALF
    } else if longitude_e7 < -HALF {
        longitude_e7 + 2 * HALF
    } else {
        longitude_e7
    };
    wrapped as i32
}

fn within_range(local: [f32; 2]) -> Result<[f32; 2], ObservationError> {
    let [east, north] = local;
    // Not `>`: a NaN is out of range too.
    if east * east + north * north <= LocalPlane::MAX_RANGE_M * LocalPlane::MAX_RANGE_M {
        Ok(local)
    } else {
        Err(ObservationError::Position)
    }
}

/// To the nearest integer; the cast saturates.
fn round(x: f32) -> i32 {
    (if x < 0.0 { x - 0.5 } else { x + 0.5 }) as i32
}

// Series for angles within a quarter of a radian, exact to an f32. `math::sin_cos` has an error of 1e-6 at any angle, which
// is metres on the ground.

fn sin(x: f32) -> f32 {
    let q = x * x;
    x * (1.0 + q * (-1.0 / 6.0 + q * (1.0 / 120.0)))
}

fn one_minus_cos(x: f32) -> f32 {
    let q = x * x;
    q * (0.5 + q * (-1.0 / 24.0 + q * (1.0 / 720.0)))
}

fn asin(x: f32) -> f32 {
    let q = x * x;
    x * (1.0 + q * (1.0 / 6.0 + q * (3.0 / 40.0 + q * (15.0 / 336.0))))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// Exact metres east and north, through earth-centred coordinates.
    fn exact(origin: Geodetic, place: Geodetic) -> [f64; 2] {
        const F: f64 = 1.0 / 298.257_223_563;
        const E2: f64 = F * (2.0 - F);
        let earth_centred = |g: Geodetic| {
            let (latitude, longitude) = radians(g);
            let n = 6_378_137.0 / (1.0 - E2 * latitude.sin().powi(2)).sqrt();
            [
                n * latitude.cos() * longitude.cos(),
                n * latitude.cos() * longitude.sin(),
                n * (1.0 - E2) * latitude.sin(),
            ]
        };
        let (latitude, longitude) = radians(origin);
        let (a, b) = (earth_centred(origin), earth_centred(place));
        let [x, y, z] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let outward = longitude.cos() * x + longitude.sin() * y;
        [
            longitude.cos() * y - longitude.sin() * x,
            latitude.cos() * z - latitude.sin() * outward,
        ]
    }

    fn radians(g: Geodetic) -> (f64, f64) {
        (
            (f64::from(g.latitude_e7) * 1e-7).to_radians(),
            (f64::from(g.longitude_e7) * 1e-7).to_radians(),
        )
    }

    fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// Origins up to 85 degrees, some beside the antimeridian, and places round each up to `reach` metres.
    fn grid(reach: f64) -> Vec<(Geodetic, Geodetic)> {
        let mut pairs = Vec::new();
        for latitude in -85..=85 {
            for longitude in [-1_800_000_000, -1_799_999_000, -1_234_567, 0, 1_799_990_001] {
                let origin = Geodetic::new(latitude * 10_000_000, longitude).unwrap();
                let metres_per_e7 = 6_371_000.0 * 1e-7_f64.to_radians();
                let parallel = metres_per_e7 * f64::from(latitude).to_radians().cos();
                for east in -8..=8 {
                    for north in -8..=8 {
                        let (east, north) = (f64::from(east) / 8.0, f64::from(north) / 8.0);
                        if east.hypot(north) > 1.0 {
                            continue;
                        }
                        let step = [reach * north / metres_per_e7, reach * east / parallel];
                        let place = Geodetic::new(
                            origin.latitude_e7 + step[0] as i32,
                            wrap_e7(i64::from(longitude) + step[1] as i64),
                        );
                        pairs.push((origin, place.unwrap()));
                    }
                }
            }
        }
        pairs
    }

    /// Largest error as a fraction of what is allowed, to metres and back.
    fn worst(reach: f64) -> (f64, f64) {
        let mut worst = (0.0_f64, 0.0_f64);
        for (origin, place) in grid(reach) {
            let plane = LocalPlane::new(origin).unwrap();
            let exact_local = exact(origin, place);
            let allowed = 0.01 + 1e-5 * exact_local[0].hypot(exact_local[1]);
            let local = plane.to_local(place).unwrap();
            let error = far(local.map(f64::from), exact_local);
            worst.0 = worst.0.max(error / allowed);
            // Back: the place that is found for rounded metres, taken to exact metres again.
            let found = plane.to_geodetic(exact_local.map(|m| m as f32)).unwrap();
            let error = far(exact(origin, found), exact_local);
            worst.1 = worst.1.max(error / allowed);
        }
        worst
    }

    #[test]
    fn longitudes_go_on_behind_the_date_line() {
        for (longitude, expected) in [(181, -179), (-181, 179), (180, 180), (-180, -180), (7, 7)] {
            assert_eq!(wrap_e7(longitude * 10_000_000), expected * 10_000_000);
        }
    }

    #[test]
    fn places_are_near_or_far() {
        let here = Geodetic::new(481_173_000, 115_166_667).unwrap();
        // 11.12 metres further north.
        let there = Geodetic::new(481_174_000, 115_166_667).unwrap();
        assert!(here.is_within(there, 11.2) && !here.is_within(there, 11.0));
        assert!(there.is_within(here, 11.2));
        assert!(!here.is_within(Geodetic::new(0, 0).unwrap(), 1e9));
    }

    #[test]
    fn the_error_is_within_a_centimetre_and_1e_5_of_the_distance() {
        for reach in [0.05, 3.0, 50.0, 1_000.0, 7_000.0, 20_000.0, 95_000.0] {
            let (to_local, to_geodetic) = worst(reach);
            std::println!("{reach} m: {to_local:.3} and {to_geodetic:.3} of the allowance");
            assert!(to_local < 1.0 && to_geodetic < 1.0);
        }
    }

    #[test]
    fn places_out_of_range_are_refused() {
        assert_eq!(
            Geodetic::new(900_000_001, 0),
            Err(ObservationError::Latitude)
        );
        assert_eq!(Geodetic::new(i32::MIN, 0), Err(ObservationError::Latitude));
        assert_eq!(Geodetic::new(0, i32::MAX), Err(ObservationError::Longitude));
        let arctic = Geodetic::new(850_000_001, 0).unwrap();
        assert_eq!(LocalPlane::new(arctic), Err(ObservationError::NearPole));

        let plane = LocalPlane::new(Geodetic::new(480_000_000, 110_000_000).unwrap()).unwrap();
        for (latitude, longitude) in [
            (491_000_000, 110_000_000),
            (480_000_000, 125_000_000),
            (-480_000_000, -700_000_000),
            (900_000_000, 1_800_000_000),
            (-900_000_000, -1_800_000_000),
        ] {
            let place = Geodetic::new(latitude, longitude).unwrap();
            assert_eq!(plane.to_local(place), Err(ObservationError::Position));
        }
        // Where the series in latitude is nearly zero again, far beyond its range.
        let south = LocalPlane::new(Geodetic::new(-700_000_000, 0).unwrap()).unwrap();
        for latitude in 600..=850 {
            let place = Geodetic::new(latitude * 1_000_000, 0).unwrap();
            assert_eq!(south.to_local(place), Err(ObservationError::Position));
        }
        for local in [
            [1e5, 1e5],
            [f32::NAN, 0.0],
            [0.0, f32::INFINITY],
            [1e30, 0.0],
        ] {
            assert_eq!(plane.to_geodetic(local), Err(ObservationError::Position));
        }
    }

    #[test]
    fn conversion_to_metres_and_back_restores_every_place() {
        let origin = Geodetic::new(522_296_000, 210_122_000).unwrap();
        let plane = LocalPlane::new(origin).unwrap();
        for step in -2_000..2_000 {
            let place = Geodetic::new(522_296_000 + step * 7, 210_122_000 - step * 11).unwrap();
            let found = plane.to_geodetic(plane.to_local(place).unwrap()).unwrap();
            assert!((found.latitude_e7 - place.latitude_e7).abs() <= 1);
            assert!((found.longitude_e7 - place.longitude_e7).abs() <= 1);
        }
    }
}
