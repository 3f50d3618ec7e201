//! Angles in radians.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_4, PI};

use super::ROUND;

/// Keeps a quotient finite when both coordinates are zero, and vanishes beside any other coordinate.
const TINY: f32 = 1e-30;

/// Angle of the vector (x, y), counter-clockwise from the x-axis, in [-pi, pi]; about zero for (0, 0).
///
/// The argument order is that of every `atan2`: y first. NaN for a non-finite coordinate.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    // Both halves of a quadrant are reached from its diagonal, where the ratio is within [-1, 1]: no swap
    // of the coordinates, no branch.
    let (across, along) = (y.abs(), x.abs() + TINY);
    let t = atan_fine((across - along) / (across + along));
    let angle = if x < 0.0 {
        3.0 * FRAC_PI_4 - t
    } else {
        FRAC_PI_4 + t
    };
    angle.copysign(y)
}

/// atan p for p within [-1, 1], error 5e-7.
#[inline(always)]
fn atan_fine(p: f32) -> f32 {
    let q = p * p;
    p * (9.999_961e-1
        + q * (-3.331_737e-1
            + q * (1.980_781_6e-1
                + q * (-1.323_334_2e-1
                    + q * (7.962_367e-2 + q * (-3.360_422e-2 + q * 6.811_793e-3))))))
}

/// atan p for p within [-1, 1], error 1.2e-5: a hundredth of the smallest sigma that a bearing may have.
#[inline(always)]
pub(crate) fn atan_coarse(p: f32) -> f32 {
    let q = p * p;
    let square = q * q;
    // In pairs, which do not wait for each other.
    let low = 9.998_663e-1 - q * 3.303_048e-1;
    let high = 1.801_593e-1 - q * 8.515_635e-2 + square * 2.084_511_4e-2;
    p * (low + square * high)
}

/// Sine and cosine. See [`math`](super) for how the error grows with the angle.
#[inline(always)]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let quarters = x * FRAC_2_PI;
    let rounded = quarters + ROUND;
    let f = quarters - (rounded - ROUND);
    let q = f * f;
    let s = f * (1.570_788_5 + q * (-6.457_12e-1 + q * 7.766_739e-2));
    let c = 1.0 + q * (-1.233_697 + q * (2.535_986_4e-1 - q * 2.040_835_3e-2));
    let quadrant = rounded.to_bits();
    let (sin, cos) = if quadrant & 1 == 0 { (s, c) } else { (c, s) };
    // Bit 1 of the quadrant is the sign of the sine; the cosine is a quadrant ahead.
    let sin_sign = (quadrant & 2) << 30;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(sin.to_bits() ^ sin_sign),
        f32::from_bits(cos.to_bits() ^ cos_sign),
    )
}

/// The same angle in [-pi, pi].
///
/// NaN for an angle that is not finite or beyond a million radians, where an f32 has lost its direction.
#[inline(always)]
pub fn wrap(angle: f32) -> f32 {
    // 2 pi in two parts: the product of the first, which has ten bits, with the number of turns is exact.
    const TURN_HIGH: f32 = 6.281_25;
    const TURN_LOW: f32 = 1.935_307_2e-3;
    let rounded = angle * (0.5 / PI) + ROUND;
    let turns = rounded - ROUND;
    let wrapped = (angle - turns * TURN_HIGH) - turns * TURN_LOW;
    // The rounded quotient may have chosen the wrong side of half a turn.
    let wrapped = if wrapped > PI {
        (wrapped - TURN_HIGH) - TURN_LOW
    } else if wrapped < -PI {
        (wrapped + TURN_HIGH) + TURN_LOW
    } else {
        wrapped
    };
    if angle.abs() <= 1e6 {
        wrapped
    } else {
        f32::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    #[test]
    fn axes() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 6e-7, "{a} is not {b}");
        near(atan2(0.0, 1.0), 0.0);
        near(atan2(1.0, 0.0), FRAC_PI_2);
        near(atan2(0.0, -1.0), PI);
        near(atan2(-1.0, 0.0), -FRAC_PI_2);
        near(atan2(0.0, 0.0), 0.0);
        near(atan2(0.0, 1e-30), 0.0);
        near(atan2(3e-9, 3e-9), FRAC_PI_4);
        assert!(atan2(f32::NAN, 1.0).is_nan());
        assert!(atan2(f32::INFINITY, 1.0).is_nan());
    }

    #[test]
    fn wrapping_ends_within_half_a_turn() {
        for turns in -150_000..150_000 {
            let straight = turns as f32 * PI;
            let angle = wrap(straight);
            assert!(angle.abs() <= PI, "{turns} half turns give {angle}");
            // Whole turns less, as far as 2 pi is known.
            let less = (f64::from(straight) - f64::from(angle)) / core::f64::consts::TAU;
            let off = less - f64::from((less + 0.5 * less.signum()) as i32);
            assert!(off.abs() < 5e-6, "{turns} half turns give {angle}");
        }
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e7, -1e30] {
            assert!(wrap(bad).is_nan());
        }
    }
}
