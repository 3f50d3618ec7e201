//! The bootstrap particle filter: predict, update, resample, estimate.
//!
//! Gordon, Salmond and Smith, "Novel approach to nonlinear/non-Gaussian Bayesian state estimation" (1993).
//! The model is an argument of each step, so one filter takes any number of sensors, and a measurement that
//! is missing is a step that is left out.

use core::fmt;

use crate::estimate;
use crate::math::ln;
use crate::model::{Dynamics, Likelihood};
use crate::particles::{Particles, copy};
use crate::random::Rng;
use crate::resample::{Scheme, resample};
use crate::weights;

/// A particle filter of `N` particles with a state of `D` dimensions.
///
/// Takes 4 N (D + 2) + 8 bytes, has no heap and never moves itself: put it into a `static`.
///
/// See [`crate::model`] for a complete example.
#[derive(Debug, Clone)]
pub struct ParticleFilter<const D: usize, const N: usize> {
    particles: Particles<D, N>,
    /// The exponentials of the log-weights, scaled to sum to one.
    weights: [f32; N],
    /// Natural logarithm of the sum of the exponentials of the log-weights.
    log_sum: f32,
    effective_sample_size: f32,
}

/// Why an update was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum UpdateError {
    /// Every particle finds the measurement impossible (log-likelihood minus infinity, or NaN). The filter
    /// stays as it was: leave the measurement out, or start again from elsewhere.
    AllWeightsZero,
}

impl fmt::Display for UpdateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("every particle finds the measurement impossible")
    }
}

impl core::error::Error for UpdateError {}

impl<const D: usize, const N: usize> ParticleFilter<D, N> {
    /// All particles at the origin, with equal weights; see [`ParticleFilter::initialise`].
    pub const fn new() -> Self {
        Self {
            particles: Particles::new(),
            weights: [1.0 / N as f32; N],
            log_sum: ln(N as f32),
            effective_sample_size: N as f32,
        }
    }

    /// Draws the state of every particle from `draw`, the prior, and makes their weights equal.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        self.particles.initialise(rng, draw);
        self.weights = [1.0 / N as f32; N];
        self.equal_weights();
    }

    /// Moves every particle by `dt` seconds.
    pub fn predict<R: Rng + ?Sized>(
        &mut self,
        dynamics: &impl Dynamics<D>,
        dt: f32,
        rng: &mut R,
    ) {
        dynamics.predict(&mut self.particles.columns_mut(), dt, rng);
    }

    /// Weighs every particle by a measurement, and returns the log-evidence: the natural logarithm of the
    /// probability (density) of the measurement given all earlier ones. It is the sum over the steps that
    /// compares models; a step far below the others does not fit.
    ///
    /// # Errors
    /// When no particle is left with any weight; the filter is then as before.
    pub fn update(&mut self, likelihood: &impl Likelihood<D>) -> Result<f32, UpdateError> {
        // The weights follow from the log-weights, so their column is free to collect the sums.
        likelihood.log_likelihoods(&self.particles.columns(), &mut self.weights);
        for (w, l) in self.weights.iter_mut().zip(self.particles.log_weights()) {
            *w += l;
        }
        let largest = weights::maximum(&self.weights);
        let log_weights = self.particles.log_weights_mut();
        if largest == f32::NEG_INFINITY {
            let sums = weights::exponentiate(log_weights, &mut self.weights, 0.0);
            weights::scale(&mut self.weights, 1.0 / sums.weights);
            return Err(UpdateError::AllWeightsZero);
        }
        log_weights.copy_from_slice(&self.weights);
        let sums = weights::exponentiate(log_weights, &mut self.weights, largest);
        weights::scale(&mut self.weights, 1.0 / sums.weights);
        let log_sum = ln(sums.weights);
        let log_evidence = largest + log_sum - self.log_sum;
        self.log_sum = log_sum;
        self.effective_sample_size = sums.effective_sample_size();
        Ok(log_evidence)
    }

    /// Resamples if the effective sample size is below `share` of the number of particles; says whether it did.
    ///
    /// Do so before a prediction rather than after an update: the estimate of a weighted cloud is the better one.
    pub fn resample_below<R: Rng + ?Sized>(&mut self, share: f32, rng: &mut R) -> bool {
        let needed = self.effective_sample_size < share * N as f32;
        if needed {
            self.resample(Scheme::Systematic, rng);
        }
        needed
    }

    /// Replaces light particles by copies of heavy ones and makes the weights equal.
    pub fn resample<R: Rng + ?Sized>(&mut self, scheme: Scheme, rng: &mut R) {
        let mut columns = self.particles.columns_mut();
        resample(scheme, &mut self.weights, rng, |from, to| copy(&mut columns, from, to));
        self.particles.log_weights_mut().fill(0.0);
        self.equal_weights();
    }

    fn equal_weights(&mut self) {
        self.log_sum = ln(N as f32);
        self.effective_sample_size = N as f32;
    }

    /// How many equally weighted particles the cloud is worth, from 1 to `N`.
    pub fn effective_sample_size(&self) -> f32 {
        self.effective_sample_size
    }

    /// Weighted mean of the states.
    pub fn mean(&self) -> [f32; D] {
        estimate::mean(&self.particles.columns(), &self.weights)
    }

    /// Weighted covariance of the states.
    pub fn covariance(&self) -> [[f32; D]; D] {
        estimate::covariance(&self.particles.columns(), &self.weights)
    }

    /// The states and log-weights.
    pub fn particles(&self) -> &Particles<D, N> {
        &self.particles
    }

    /// The states, one column per dimension, to refine them between steps.
    pub fn columns_mut(&mut self) -> [&mut [f32]; D] {
        self.particles.columns_mut()
    }

    /// The weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }
}

impl<const D: usize, const N: usize> Default for ParticleFilter<D, N> {
    fn default() -> Self {
        Self::new()
    }
}
