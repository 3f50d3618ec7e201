//! The work: sixty bearings on a source that stands still, from a straight drive past it.

use core::f64::consts::TAU;

/// Where the source stands, in metres east and north.
pub const SOURCE: [f32; 2] = [1200.0, 800.0];
/// Length of the drive, in metres east from the origin.
pub const TRACK_M: f64 = 1500.0;
/// How many bearings are taken, equally spaced, at both ends too.
pub const STEPS: usize = 60;
/// Variance of a bearing, in square radians.
pub const BEARING_VARIANCE: f32 = 3.801e-4;
/// Variance of the random walk per step and axis, in square metres.
pub const WALK_VARIANCE: f32 = 1.0;
/// Standard deviation of the initial cloud around the source per axis, in metres.
pub const CLOUD_SIGMA_M: f32 = 50.0;
/// Seed of every filter's own generator.
pub const SEED: u64 = 1;

/// A bearing and the place where it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Metres east and north.
    pub position: [f32; 2],
    /// Radians counter-clockwise from east.
    pub bearing: f32,
}

/// The bearings in the order of the drive: the same bits on every platform, because only `libm` and
/// Knuth's linear congruential generator make them.
pub fn sightings() -> [Sighting; STEPS] {
    let mut state = 20_260_101_u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    core::array::from_fn(|step| {
        let east = TRACK_M * step as f64 / (STEPS - 1) as f64;
        let truth = libm::atan2(f64::from(SOURCE[1]), f64::from(SOURCE[0]) - east);
        // Box-Muller; one minus the uniform keeps zero away from the logarithm.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - uniform()));
        let normal = radius * libm::cos(TAU * uniform());
        let bearing = truth + libm::sqrt(f64::from(BEARING_VARIANCE)) * normal;
        Sighting {
            position: [east as f32, 0.0],
            bearing: bearing as f32,
        }
    })
}

/// Distance of an estimate from the source, in metres; NaN if the estimate is.
pub fn error_m(estimate: [f32; 2]) -> f32 {
    libm::hypotf(estimate[0] - SOURCE[0], estimate[1] - SOURCE[1])
}
