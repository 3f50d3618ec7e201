//! Exponential and logarithm.

use core::f32::consts::{LN_2, LOG2_E};

use super::ROUND;

/// Bits of 2^t for t within [-126, 128): the integer part goes into the exponent, a polynomial of degree 5 takes
/// the rest. As bits, because a loop then stores them without a detour through a floating-point register.
#[inline(always)]
const fn exp2_bits(t: f32) -> u32 {
    let rounded = t + ROUND;
    let f = t - (rounded - ROUND);
    // Relative error below 2^-21.6 for f within [-1/2, 1/2], with the rounding of f32.
    // Even and odd powers apart: one product more than Horner's rule, but two chains that do not wait for each other.
    let square = f * f;
    let even = 1.000_000_1 + square * (2.402_212e-1 + square * 9.675_541e-3);
    let odd = 6.931_469_7e-1 + square * (5.550_713_3e-2 + square * 1.327_647_2e-3);
    let p = even + f * odd;
    p.to_bits().wrapping_add(rounded.to_bits() << 23)
}

/// e^x, over the whole range of f32; NaN for NaN.
#[inline(always)]
pub const fn exp(x: f32) -> f32 {
    // |x| <= 87, on the bits without the sign.
    let within = x.to_bits() << 1 <= 87f32.to_bits() << 1;
    f32::from_bits(if within {
        exp2_bits(x * LOG2_E)
    } else {
        exp_outside(x).to_bits()
    })
}

/// Where the result overflows or is subnormal. Apart, so that it takes no registers from the loop that calls `exp`.
#[cold]
#[inline(never)]
const fn exp_outside(x: f32) -> f32 {
    if x.is_nan() {
        // Its bits are no number to shift.
        f32::NAN
    } else if x < -110.0 {
        0.0
    } else if x > 90.0 {
        f32::INFINITY
    } else {
        let root = f32::from_bits(exp2_bits(0.5 * LOG2_E * x));
        root * root
    }
}

/// e^x of a log-weight relative to the largest, so x <= 0: a weight below 2^-60 of the largest, or NaN, is zero.
///
/// Squares and sums of what it returns stay far above the subnormal numbers, which some processors handle
/// a hundred times slower.
#[inline(always)]
pub(crate) const fn exp_of_weight(x: f32) -> f32 {
    let t = x * LOG2_E;
    // Below -126 these bits mean nothing, and the choice drops them. It is one of two numbers, not a branch.
    let w = exp2_bits(t);
    f32::from_bits(if t >= -60.0 { w } else { 0 })
}

/// 1 - e^-x, also where that is too small to be a difference.
pub(crate) fn one_minus_exp(x: f32) -> f32 {
    if x < 0.02 {
        x * (1.0 - x * (0.5 - x / 6.0))
    } else {
        1.0 - exp(-x)
    }
}

/// Natural logarithm: minus infinity for zero and subnormal numbers, NaN for a negative argument.
#[inline(always)]
pub const fn ln(x: f32) -> f32 {
    const SMALLEST: u32 = f32::MIN_POSITIVE.to_bits();
    const BEYOND: u32 = f32::INFINITY.to_bits();
    // Positive, normal and finite, in one comparison.
    let bits = x.to_bits();
    if bits.wrapping_sub(SMALLEST) < BEYOND - SMALLEST {
        ln_of_normal(bits)
    } else {
        ln_special(bits)
    }
}

#[cold]
#[inline(never)]
const fn ln_special(bits: u32) -> f32 {
    let x = f32::from_bits(bits);
    if x < 0.0 {
        f32::NAN
    } else if x < 1.0 {
        f32::NEG_INFINITY
    } else {
        // Infinity and NaN are their own logarithms.
        x
    }
}

/// Natural logarithm of a positive normal number, from its bits.
#[inline(always)]
const fn ln_of_normal(bits: u32) -> f32 {
    // Splits x into m * 2^e with m within [sqrt(1/2), sqrt(2)), so that the logarithm has no cancellation near 1.
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let e = (bits.wrapping_sub(SQRT_HALF) as i32) >> 23;
    let m = f32::from_bits(bits.wrapping_sub((e as u32) << 23));
    let t = m - 1.0;
    // Absolute error below 2^-21.1 and relative error below 2^-19.6 for such m, with the rounding of f32.
    let p = t
        * (1.000_001
            + t * (-5.000_111_3e-1
                + t * (3.331_450_9e-1
                    + t * (-2.490_974_4e-1
                        + t * (2.049_633e-1 + t * (-1.866_785_5e-1 + t * 1.189_610_8e-1))))));
    p + e as f32 * LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_exp() {
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp(-1e9), 0.0);
        assert_eq!(exp(1e9), f32::INFINITY);
        assert!(exp(f32::NAN).is_nan() && exp(f32::from_bits(0x7fc0_0001)).is_nan());
        assert!((exp(-87.0) / (-87f64).exp() as f32 - 1.0).abs() < 1e-5);
        assert!((exp(88.5) / 88.5f64.exp() as f32 - 1.0).abs() < 1e-5);
        assert!(exp(-100.0) > 0.0 && exp(-100.0) < f32::MIN_POSITIVE);
    }

    #[test]
    fn edges_of_a_weight() {
        assert_eq!(exp_of_weight(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp_of_weight(-42.0), 0.0);
        assert!(exp_of_weight(-41.5) > 0.0);
        assert!((exp_of_weight(0.0) - 1.0).abs() < 2e-7);
    }

    #[test]
    fn edges_of_ln() {
        assert_eq!(ln(0.0), f32::NEG_INFINITY);
        assert_eq!(ln(-0.0), f32::NEG_INFINITY);
        assert_eq!(ln(f32::INFINITY), f32::INFINITY);
        assert!(ln(-1.0).is_nan());
        assert!(ln(f32::NAN).is_nan());
        assert_eq!(ln(1.0), 0.0);
    }
}
