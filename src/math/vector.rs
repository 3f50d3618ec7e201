//! Vectors of any dimension.

use super::sqrt;

/// `a` less `b`.
#[inline(always)]
pub(crate) fn difference<const D: usize>(mut a: [f32; D], b: [f32; D]) -> [f32; D] {
    for (a, b) in a.iter_mut().zip(b) {
        *a -= b;
    }
    a
}

/// `a` and `factor` times `b`.
#[inline(always)]
pub(crate) fn plus_scaled<const D: usize>(mut a: [f32; D], factor: f32, b: [f32; D]) -> [f32; D] {
    for (a, b) in a.iter_mut().zip(b) {
        *a += factor * b;
    }
    a
}

/// The scalar product.
#[inline(always)]
pub(crate) fn dot<const D: usize>(a: [f32; D], b: [f32; D]) -> f32 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

/// The square of the length of `offset`.
#[inline(always)]
pub(crate) fn square<const D: usize>(offset: [f32; D]) -> f32 {
    dot(offset, offset)
}

/// The direction of `offset`, of length one; `None` when it has none.
#[inline(always)]
pub(crate) fn direction<const D: usize>(offset: [f32; D]) -> Option<[f32; D]> {
    let length = sqrt(square(offset));
    let inverse = 1.0 / length;
    (length > 0.0 && inverse > 0.0).then(|| offset.map(|x| x * inverse))
}
