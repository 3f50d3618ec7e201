//! Elementary functions in f32, the same to the last bit on every platform.
//!
//! Short polynomials, no tables, no branches that depend on the data, no f64, and no platform `libm`:
//! a host and a microcontroller compute identical numbers.
//!
//! The largest error of each function, over the range that filters use and over the whole range; for `atan2`, of the angle
//! at any radius. The tests hold each of them to it, densely, against f64:
//!
//! | function | from | to | largest error | |
//! |---|--:|--:|--:|---|
//! | `exp` | -10 | 0 | 8e-7 | relative |
//! | `exp` | -87 | 88 | 6e-6 | relative |
//! | `ln` | 0.5 | 2 | 5e-7 | absolute |
//! | `ln` | 1e-30 | 1e30 | 8e-6 | absolute |
//! | `sqrt` | 0 | 1e6 | 6e-8 | relative |
//! | `atan2` | -pi | pi | 8e-7 | absolute |
//! | `sin` | -pi | pi | 1e-6 | absolute |
//! | `sin` | -1000 | 1000 | 1.5e-4 | absolute |
//! | `cos` | -pi | pi | 1e-6 | absolute |
//! | `cos` | -1000 | 1000 | 1.5e-4 | absolute |
//! | `wrap` | -pi | pi | 0 | absolute |
//! | `wrap` | -1000 | 1000 | 2e-7 | absolute |
//!
//! ```
//! use foxhunt::math;
//!
//! let (sin, cos) = math::sin_cos(0.5);
//! assert!((math::atan2(sin, cos) - 0.5).abs() < 2e-6);
//! ```

mod angle;
mod exponential;
mod hardware;
pub(crate) mod vector;

pub(crate) use angle::atan_coarse;
pub use angle::{atan2, sin_cos, wrap};
pub use exponential::{exp, ln};
pub(crate) use exponential::{exp_of_weight, one_minus_exp};
pub use hardware::sqrt;

/// ln(2 pi)
pub(crate) const LN_TAU: f32 = ln(core::f32::consts::TAU);

/// Adding and subtracting 1.5 * 2^23 rounds an f32 of magnitude below 2^22 to the nearest integer, which
/// then stands in the low bits of the sum.
pub(crate) const ROUND: f32 = 12_582_912.0;

/// The larger of two numbers, and `b` if they cannot be compared: one comparison, where `f32::max` calls a function on many
/// cores.
#[inline]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, and `b` if they cannot be compared.
#[inline]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
