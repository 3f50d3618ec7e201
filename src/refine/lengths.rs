//! The unit of distances between states.

use core::f32::consts::TAU;

use crate::math::vector::direction;
use crate::math::{sin_cos, sqrt};
use crate::random::{Rng, normal, uniform};

/// The unit of the distances in the configuration of a refinement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Lengths {
    /// That of the state, for every dimension: metres, as a rule. A step in metres that suits the first cloud does
    /// nothing for the last, or ruins it.
    Absolute,
    /// The standard deviation of the particles, of each dimension on its own, so that dimensions may differ in unit.
    #[default]
    Relative,
}

/// The unit of every dimension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale<const D: usize> {
    /// In the unit of the state; zero where the particles do not differ.
    unit: [f32; D],
    /// Zero where the unit is: no distance in a dimension without extent.
    inverse: [f32; D],
}

impl<const D: usize> Scale<D> {
    pub(super) fn new(lengths: Lengths, columns: &[&[f32]; D]) -> Self {
        let unit = match lengths {
            Lengths::Absolute => [1.0; D],
            Lengths::Relative => columns.map(sigma),
        };
        let inverse = unit.map(|u| if u > 0.0 { 1.0 / u } else { 0.0 });
        Self { unit, inverse }
    }

    /// A state, or a difference of two, in these units.
    #[inline(always)]
    pub(super) fn measure(&self, mut state: [f32; D]) -> [f32; D] {
        for (x, inverse) in state.iter_mut().zip(self.inverse) {
            *x *= inverse;
        }
        state
    }

    /// What is `length` times the measured `offset` away from `from`.
    #[inline(always)]
    pub(super) fn away(&self, mut from: [f32; D], length: f32, offset: [f32; D]) -> [f32; D] {
        for ((x, unit), offset) in from.iter_mut().zip(self.unit).zip(offset) {
            *x += unit * (length * offset);
        }
        from
    }

    /// Standard normal in these units; zero in a dimension without extent.
    #[inline(always)]
    pub(super) fn noise<R: Rng + ?Sized>(&self, rng: &mut R) -> [f32; D] {
        self.inverse.map(|inverse| {
            let sample = normal(rng);
            if inverse > 0.0 { sample } else { 0.0 }
        })
    }
}

/// Standard deviation of a column; zero of an empty one or one that holds no numbers.
fn sigma(column: &[f32]) -> f32 {
    let inverse = 1.0 / column.len() as f32;
    let mean = inverse * column.iter().sum::<f32>();
    let squares: f32 = column.iter().map(|x| (x - mean) * (x - mean)).sum();
    let sigma = sqrt(inverse * squares);
    // False for NaN. Below, the inverse would not be finite.
    if (f32::MIN_POSITIVE..=f32::MAX).contains(&sigma) {
        sigma
    } else {
        0.0
    }
}

/// A direction of length one, each as likely, and a part of the way, uniform between 0 and 1.
#[inline(always)]
pub(super) fn anywhere<const D: usize, R: Rng + ?Sized>(rng: &mut R) -> ([f32; D], f32) {
    let mut direction_taken = [0.0; D];
    if D == 2 {
        // One draw for both: 65,536 directions and as many lengths.
        const STEP: f32 = 1.0 / 65_536.0;
        let word = rng.next_u32();
        let (sin, cos) = sin_cos((word >> 16) as f32 * (TAU * STEP));
        for (x, component) in direction_taken.iter_mut().zip([cos, sin]) {
            *x = component;
        }
        return (direction_taken, (f32::from(word as u16) + 0.5) * STEP);
    }
    direction_taken.fill_with(|| normal(rng));
    // A normal sample is never zero.
    (
        direction(direction_taken).unwrap_or(direction_taken),
        uniform(rng),
    )
}
