//! Elementary functions in f32, the same to the last bit on every platform.
//!
//! Short polynomials, no tables, no branches that depend on the data, no f64, and no platform `libm`:
//! a host and a microcontroller compute identical numbers. [`ACCURACY`] states the largest error of each
//! function over its range; the tests hold each of them to it, densely, against f64.
//!
//! ```
//! use foxhunt::math;
//!
//! let (sin, cos) = math::sin_cos(0.5);
//! assert!((math::atan2(sin, cos) - 0.5).abs() < 2e-6);
//! ```

mod accuracy;
mod angle;
mod exponential;
mod hardware;

pub use accuracy::{ACCURACY, Accuracy, Measure};
pub(crate) use angle::atan_coarse;
pub use angle::{atan2, sin_cos, wrap};
pub(crate) use exponential::exp_of_weight;
pub use exponential::{exp, ln};
pub use hardware::sqrt;

/// Adding and subtracting 1.5 * 2^23 rounds an f32 of magnitude below 2^22 to the nearest integer, which
/// then stands in the low bits of the sum.
const ROUND: f32 = 12_582_912.0;
