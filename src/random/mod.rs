//! Random numbers in f32, from any generator that implements [`rand_core::Rng`].
//!
//! The generator is always an argument: nothing here holds one, so one seed replays one run.
//! [`Xoshiro128PlusPlus`] is a good default on 32-bit machines: 16 bytes of state and about a dozen instructions.
//!
//! ```
//! use foxhunt::random::{self, SeedableRng, Xoshiro128PlusPlus};
//!
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(2026);
//! let sample = random::normal(&mut rng);
//! assert!(sample.abs() < 7.0);
//! ```

mod normal_table;

pub use rand_core::{Rng, SeedableRng};
pub use rand_xoshiro::Xoshiro128PlusPlus;

use crate::math::larger;
use normal_table::QUANTILE;

const TWO_POW_MINUS_24: f32 = 1.0 / 16_777_216.0;

/// Uniform on [0, 1): every multiple of 2^-24, equally often.
#[inline(always)]
pub fn uniform<R: Rng + ?Sized>(rng: &mut R) -> f32 {
    (rng.next_u32() >> 8) as f32 * TWO_POW_MINUS_24
}

/// Uniform on the open interval (0, 1): safe to take the logarithm of, or of one minus it.
#[inline(always)]
pub fn uniform_open<R: Rng + ?Sized>(rng: &mut R) -> f32 {
    ((rng.next_u32() >> 9) as f32 + 0.5) * (2.0 * TWO_POW_MINUS_24)
}

/// Standard normal, by inversion of the distribution function: one draw of the generator a sample, the
/// same time for each, tails to 6.3 sigma, quantiles exact to 4e-4.
#[inline(always)]
pub fn normal<R: Rng + ?Sized>(rng: &mut R) -> f32 {
    normal_of(rng.next_u32())
}

/// The standard normal sample that stands for these bits.
#[inline(always)]
pub(crate) fn normal_of(bits: u32) -> f32 {
    // A signed odd integer, never zero.
    normal_quantile((bits | 1) as i32 as f32)
}

/// The number of sigmas beyond which a normal distribution has the probability `outside`, both tails together; exact to
/// 4e-4, from a probability of 1e-9 on.
pub(crate) fn two_sided_quantile(outside: f32) -> f32 {
    let quantile = normal_quantile(2_147_483_648.0 * outside.clamp(1e-9, 1.0));
    larger(quantile, 0.0)
}

/// The quantile of the normal distribution whose sign is that of `distance`, and whose distance from the end of the tail
/// is its magnitude, from 1 to 2^31, in probabilities of 2^-32.
#[inline(always)]
fn normal_quantile(distance: f32) -> f32 {
    // The exponent selects the polynomial.
    let bits = distance.to_bits();
    let [c0, c1, c2, _] = QUANTILE[(bits >> 22 & 63) as usize];
    let g = distance.abs();
    f32::from_bits(c0.to_bits() ^ (bits & 0x8000_0000)) + distance * (c1 + g * c2)
}

#[cfg(test)]
mod tests;
