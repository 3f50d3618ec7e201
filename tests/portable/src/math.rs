use foxhunt::math;

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    ("math::exp", exp),
    ("math::ln", ln),
    ("math::sqrt", sqrt),
    ("math::sin_cos", sin_cos),
    ("math::atan2", atan2),
    ("math::wrap", wrap),
    ("math::special_values", special_values),
];

/// Numbers of both signs and of many magnitudes.
fn arguments() -> impl Iterator<Item = f32> {
    (0..4096_u32).map(|i| f32::from_bits(i.wrapping_mul(0x9e37_79b9)))
}

/// Evenly spaced numbers.
fn range(from: f32, to: f32) -> impl Iterator<Item = f32> {
    (0..4096_u16).map(move |i| from + (to - from) * (f32::from(i) / 4095.0))
}

fn exp() -> Digest {
    let mut digest = Digest::new();
    range(-90.0, 80.0)
        .chain(arguments())
        .for_each(|x| digest.add(&[math::exp(x)]));
    digest
}

fn ln() -> Digest {
    let mut digest = Digest::new();
    range(0.0, 10.0)
        .chain(arguments())
        .for_each(|x| digest.add(&[math::ln(x)]));
    digest
}

fn sqrt() -> Digest {
    let mut digest = Digest::new();
    range(0.0, 10.0)
        .chain(arguments())
        .for_each(|x| digest.add(&[math::sqrt(x)]));
    digest
}

fn sin_cos() -> Digest {
    let mut digest = Digest::new();
    range(-10.0, 10.0).chain(arguments()).for_each(|x| {
        let (sin, cos) = math::sin_cos(x);
        digest.add(&[sin, cos]);
    });
    digest
}

fn atan2() -> Digest {
    let mut digest = Digest::new();
    for (y, x) in range(-3.0, 3.0)
        .zip(range(2.0, -5.0))
        .chain(arguments().zip(arguments().skip(7)))
    {
        digest.add(&[math::atan2(y, x)]);
    }
    digest
}

fn wrap() -> Digest {
    let mut digest = Digest::new();
    range(-20.0, 20.0)
        .chain(arguments())
        .for_each(|x| digest.add(&[math::wrap(x)]));
    digest
}

fn special_values() -> Digest {
    assert!(math::exp(f32::NEG_INFINITY) < 1e-37);
    assert!(math::exp(f32::NAN).is_nan());
    assert!(math::sqrt(-1.0).is_nan());
    assert!(math::ln(f32::NAN).is_nan());
    let mut digest = Digest::new();
    for x in [
        0.0,
        -0.0,
        1.0,
        f32::MAX,
        f32::MIN_POSITIVE,
        1e-40,
        f32::INFINITY,
        f32::NAN,
    ] {
        let (sin, cos) = math::sin_cos(x);
        digest.add(&[
            math::exp(x),
            math::ln(x),
            math::sqrt(x),
            math::wrap(x),
            sin,
            cos,
        ]);
        digest.add(&[math::atan2(x, x), math::atan2(x, -1.0), math::atan2(1.0, x)]);
    }
    digest
}
