//! A spectrum as a likelihood of particles.

use super::{Spectrum, Temper};
use crate::aoa::Bearing;
use crate::math::atan2;
use crate::model::Likelihood;

/// The tempered spectrum of an array that stood somewhere: of any state whose first two dimensions are metres east and
/// north, up to a constant.
///
/// It knows of all directions from which the source may be heard, where a
/// [`BearingLikelihood`](crate::aoa::BearingLikelihood) knows of one. Every particle costs an arc tangent and two look-ups.
///
/// ```
/// use foxhunt::aoa::{Bearing, spectrum::{Spectrum, SpectrumLikelihood, Temper}};
/// use foxhunt::model::Likelihood;
///
/// let mut spectrum = Spectrum::new();
/// for degree in 0..360 {
///     spectrum.push(if degree == 90 { 20.0 } else { 0.0 })?;
/// }
/// // The array's axis points east, so its left is the north.
/// let likelihood = SpectrumLikelihood::new(&spectrum, [0.0, 0.0], Bearing::from_radians(0.0), Temper { exponent: 0.2 });
/// let at = |place: [f32; 2]| likelihood.log_likelihood(&place);
/// assert!(at([0.0, 500.0]) > at([500.0, 0.0]) + 0.9);
/// # Ok::<(), foxhunt::aoa::spectrum::SpectrumError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SpectrumLikelihood<'a> {
    spectrum: &'a Spectrum,
    position: [f32; 2],
    axis: f32,
    highest: f32,
    scale: f32,
}

impl<'a> SpectrumLikelihood<'a> {
    /// Of a spectrum taken at a `position`, in metres, by an array whose axis points in the direction `axis`.
    pub fn new(spectrum: &'a Spectrum, position: [f32; 2], axis: Bearing, temper: Temper) -> Self {
        Self {
            spectrum,
            position,
            axis: axis.radians(),
            highest: spectrum.highest(),
            scale: temper.per_level(),
        }
    }

    #[inline(always)]
    fn at(&self, x: f32, y: f32) -> f32 {
        let direction = atan2(y - self.position[1], x - self.position[0]);
        self.scale * (self.spectrum.interpolate(direction - self.axis) - self.highest)
    }
}

impl<const D: usize> Likelihood<D> for SpectrumLikelihood<'_> {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        const { assert!(D >= 2, "a position takes two dimensions") };
        self.at(state[0], state[1])
    }

    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        const { assert!(D >= 2, "a position takes two dimensions") };
        for ((x, y), out) in columns[0].iter().zip(columns[1]).zip(out) {
            *out = self.at(*x, *y);
        }
    }
}
