//! Filters that look at the measurement before they move their particles.
//!
//! A bootstrap filter moves blindly and weighs afterwards: with few particles, or a precise measurement, none of
//! them lands where the weight is. These use more of the model, the density of its [`Transition`], to do better:
//!
//! | filter | carries | good for | evaluations of the model a step |
//! |---|---|---|---|
//! | [`UnscentedParticleFilter`] | `N` particles, each with a covariance | any dimension, one mode a particle | `(4 D + 4) N` |
//! | [`AuxiliaryFilter`] | `N` particles | one or two dimensions, any shape | about `3 G N` |
//! | [`PointMassFilter`] | `N` points with weights, nothing random | one or two dimensions, noise in all of them | about `3 G N` |
//!
//! `G` is the number of cells of a transient grid, whose memory the caller lends: at least 16 in one dimension; in two,
//! the grid is a square, so `G` is a square number, at least 256.
//!
//! Figures of each on two models: section 3 of the chapter
//! [What the papers said](https://github.com/foxhunt-rs/foxhunt/blob/main/docs/src/papers.md) of the guide. A normal
//! proposal misleads where a posterior has several modes.

mod auxiliary;
mod grid;
mod moments;
mod point_mass;
mod posterior;
mod unscented;

#[cfg(test)]
mod tests;

use crate::kalman::Covariance;
use crate::math::{LN_TAU, ln, sqrt};
use crate::model::{Dynamics, Likelihood, RandomWalk};

pub use auxiliary::AuxiliaryFilter;
pub use point_mass::PointMassFilter;
pub use posterior::Posterior;
pub use unscented::UnscentedParticleFilter;

/// Dynamics whose density can be written down.
pub trait Transition<const D: usize>: Dynamics<D> {
    /// Mean of the successors of `from` after `dt` seconds.
    fn mean(&self, from: &[f32; D], dt: f32) -> [f32; D];

    /// Covariance of the successors about their mean.
    fn noise(&self, dt: f32) -> Covariance<D>;

    /// Natural logarithm of the density at `to` of the successors of `from`; minus infinity where they cannot be. A
    /// constant that is the same for all states may be left out, and is then missing in the evidence.
    ///
    /// For normal noise: [`Gaussian`](crate::kalman::Gaussian)` { mean, covariance }.log_density(*to)`.
    fn log_transition(&self, from: &[f32; D], to: &[f32; D], dt: f32) -> f32;
}

/// A likelihood that comes from a measurement of `M` dimensions with additive noise.
pub trait Sensor<const D: usize, const M: usize>: Likelihood<D> {
    /// Measured less expected for a state; wrapped where it is an angle.
    fn residual(&self, state: &[f32; D]) -> [f32; M];

    /// Covariance of the noise.
    fn noise(&self) -> Covariance<M>;
}

impl<const D: usize> Transition<D> for RandomWalk<D> {
    fn mean(&self, from: &[f32; D], _dt: f32) -> [f32; D] {
        *from
    }

    fn noise(&self, dt: f32) -> Covariance<D> {
        Covariance::diagonal(self.sigma.map(|sigma| sigma * sqrt(dt)))
    }

    fn log_transition(&self, from: &[f32; D], to: &[f32; D], dt: f32) -> f32 {
        let steps = from.iter().zip(to).zip(self.sigma);
        steps
            .map(|((from, to), sigma)| {
                let spread = sigma * sqrt(dt);
                let step = (to - from) / spread;
                -0.5 * (step * step + LN_TAU) - ln(spread)
            })
            .sum()
    }
}
