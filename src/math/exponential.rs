//! Exponential and logarithm.

use core::f32::consts::{LN_2, LOG2_E};

use super::ROUND;

/// 2^t for t within [-126, 128]: the integer part goes into the exponent, a polynomial of degree 5 takes the rest.
#[inline(always)]
const fn exp2(t: f32) -> f32 {
    let rounded = t + ROUND;
    let f = t - (rounded - ROUND);
    let p = 1.000_000_1
        + f * (6.931_469_7e-1
            + f * (2.402_212e-1
                + f * (5.550_713_3e-2 + f * (9.675_541e-3 + f * 1.327_647_2e-3))));
    f32::from_bits(p.to_bits().wrapping_add(rounded.to_bits() << 23))
}

/// e^x: zero below -87, infinite above 88, NaN for NaN.
#[inline(always)]
pub const fn exp(x: f32) -> f32 {
    if x < -87.0 {
        0.0
    } else if x > 88.0 {
        f32::INFINITY
    } else {
        exp2(x * LOG2_E)
    }
}

/// e^x of a log-weight relative to the largest, so x <= 0: a weight below 2^-60 of the largest is zero.
///
/// Squares and sums of what it returns stay far above the subnormal numbers, which some processors handle
/// a hundred times slower.
#[inline(always)]
pub(crate) const fn exp_of_weight(x: f32) -> f32 {
    let t = x * LOG2_E;
    let t_kept = if t < -60.0 { -60.0 } else { t };
    let w = exp2(t_kept);
    if t < -60.0 { 0.0 } else { w }
}

/// Natural logarithm: minus infinity for zero and subnormal numbers, NaN for a negative argument.
#[inline(always)]
pub const fn ln(x: f32) -> f32 {
    if x >= f32::MIN_POSITIVE && x <= f32::MAX {
        ln_of_normal(x)
    } else if x < 0.0 {
        f32::NAN
    } else if x < 1.0 {
        f32::NEG_INFINITY
    } else {
        // Infinity and NaN are their own logarithms.
        x
    }
}

/// Natural logarithm of a positive normal number.
#[inline(always)]
const fn ln_of_normal(x: f32) -> f32 {
    // Splits x into m * 2^e with m within [sqrt(1/2), sqrt(2)), so that the logarithm has no cancellation near 1.
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let e = (x.to_bits().wrapping_sub(SQRT_HALF) as i32) >> 23;
    let m = f32::from_bits(x.to_bits().wrapping_sub((e as u32) << 23));
    let t = m - 1.0;
    let p = t
        * (9.999_999_5e-1
            + t * (-5.000_036_5e-1
                + t * (3.333_506e-1
                    + t * (-2.496_991e-1
                        + t * (1.990_016_5e-1
                            + t * (-1.725_083e-1 + t * (1.622_258e-1 - t * 1.010_689_6e-1)))))));
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
        assert!(exp(f32::NAN).is_nan());
        assert!((exp(-87.0) / (-87f64).exp() as f32 - 1.0).abs() < 1e-5);
        assert!((exp(88.0) / 88f64.exp() as f32 - 1.0).abs() < 1e-5);
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
