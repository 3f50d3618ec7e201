//! The bootstrap particle filter: predict, update, resample, estimate.
//!
//! Gordon, Salmond and Smith, "Novel approach to nonlinear/non-Gaussian Bayesian state estimation" (1993).
//! The model is an argument of each step, so one filter takes any number of sensors, and a measurement that
//! is missing is a step that is left out.

use crate::estimate;
use crate::model::{Dynamics, Likelihood};
use crate::particles::Particles;
use crate::persist;
use crate::random::Rng;
use crate::refine::{Memory, Refinement, Report};
use crate::resample::Scheme;
pub use crate::weights::UpdateError;
use crate::weights::Weights;

/// A particle filter of `N` particles with a state of `D` dimensions.
///
/// Takes 4 N (D + 2) + 8 bytes, has no heap and never moves itself: put it into a `static`, where it takes no flash.
///
/// ```
/// use foxhunt::filter::ParticleFilter;
/// use foxhunt::model::RandomWalk;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut filter = ParticleFilter::<1, 500>::new();
/// filter.initialise(&mut rng, |rng| [10.0 * normal(rng)]);
/// // The state was measured as 3, with a standard deviation of 0.5.
/// let likelihood = |[x]: &[f32; 1]| -0.5 * ((x - 3.0) / 0.5).powi(2);
/// filter.step(&RandomWalk { sigma: [0.1] }, &likelihood, 1.0, &mut rng)?;
/// assert!((filter.mean()[0] - 3.0).abs() < 0.2);
/// # Ok::<(), foxhunt::filter::UpdateError>(())
/// ```
///
/// See [`crate::model`] for a model of one's own.
#[derive(Debug, Clone)]
pub struct ParticleFilter<const D: usize, const N: usize> {
    pub(crate) particles: Particles<D, N>,
    pub(crate) weights: Weights<N>,
}

impl<const D: usize, const N: usize> ParticleFilter<D, N> {
    /// All particles at the origin, with equal weights, in bits that are all zero. [`ParticleFilter::weights`] are zeros
    /// until a prediction, an update or [`ParticleFilter::initialise`] makes them sum to one.
    pub const EMPTY: Self = Self {
        particles: Particles::EMPTY,
        weights: Weights::EMPTY,
    };

    /// [`ParticleFilter::EMPTY`].
    pub const fn new() -> Self {
        Self::EMPTY
    }

    /// Draws the state of every particle from `draw`, the prior, and makes their weights equal.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        self.particles.initialise(rng, draw);
        self.weights.make_equal();
    }

    /// One step of the filter: resamples if the effective sample size is below `N / 2`, predicts by `dt` seconds, updates,
    /// and returns the log-evidence.
    ///
    /// Call the parts yourself for another threshold or scheme, for a missing measurement ([`predict`](Self::predict)
    /// alone), or for a second measurement at the same time ([`update`](Self::update) alone).
    ///
    /// # Errors
    /// When no particle is left with any weight; the measurement then counts as missing.
    pub fn step<R: Rng + ?Sized>(
        &mut self,
        model: &impl Dynamics<D>,
        measurement: &impl Likelihood<D>,
        dt: f32,
        rng: &mut R,
    ) -> Result<f32, UpdateError> {
        self.resample_below(0.5, rng);
        self.predict(model, dt, rng);
        self.update(measurement)
    }

    /// Moves every particle by `dt` seconds.
    pub fn predict<R: Rng + ?Sized>(&mut self, dynamics: &impl Dynamics<D>, dt: f32, rng: &mut R) {
        if self.weights.are_empty() {
            self.weights.make_equal();
        }
        dynamics.predict(&mut self.particles.columns_mut(), dt, rng);
    }

    /// Weighs every particle by a measurement, and returns the log-evidence: the natural logarithm of the
    /// probability (density) of the measurement given all earlier ones. It is the sum over the steps that
    /// compares models; a step far below the others does not fit.
    ///
    /// # Errors
    /// When no particle is left with any weight; the filter is then as before.
    pub fn update(&mut self, likelihood: &impl Likelihood<D>) -> Result<f32, UpdateError> {
        let log_likelihoods = self.weights.log_likelihoods_mut();
        likelihood.log_likelihoods(&self.particles.columns(), log_likelihoods);
        self.weights.update()
    }

    /// Resamples if the effective sample size is below `fraction` of the number of particles; says whether it did.
    ///
    /// Do so before a prediction rather than after an update: the estimate of a weighted cloud is the better one.
    pub fn resample_below<R: Rng + ?Sized>(&mut self, fraction: f32, rng: &mut R) -> bool {
        let needed = self.effective_sample_size() < fraction * N as f32;
        if needed {
            self.resample(Scheme::Systematic, rng);
        }
        needed
    }

    /// Replaces light particles by copies of heavy ones and makes the weights equal.
    pub fn resample<R: Rng + ?Sized>(&mut self, scheme: Scheme, rng: &mut R) {
        self.weights.resample(scheme, rng, |ancestors, scratch| {
            self.particles.gather(ancestors, scratch);
        });
    }

    /// Moves the particles by the log-density `target` and leaves their weights as they are: see [`crate::refine`]
    /// for when and by what. ([`crate::proposal::UnscentedParticleFilter::refine`] makes the weights equal.)
    pub fn refine<R: Rng + ?Sized>(
        &mut self,
        refinement: &impl Refinement<D>,
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report {
        let columns = &mut self.particles.columns_mut();
        refinement.refine(columns, target, memory, rng)
    }

    /// How many equally weighted particles the cloud is worth, from 1 to `N`.
    pub fn effective_sample_size(&self) -> f32 {
        self.weights.effective_sample_size()
    }

    /// Weighted mean of the states.
    // Once in flash.
    #[inline(never)]
    pub fn mean(&self) -> [f32; D] {
        estimate::mean(&self.particles.columns(), self.weights())
    }

    /// Weighted covariance of the states.
    pub fn covariance(&self) -> [[f32; D]; D] {
        estimate::covariance(&self.particles.columns(), self.weights())
    }

    /// The states.
    pub fn particles(&self) -> &Particles<D, N> {
        &self.particles
    }

    /// The states, one column per dimension, to refine them between steps.
    pub fn columns_mut(&mut self) -> [&mut [f32]; D] {
        self.particles.columns_mut()
    }

    /// The weights, which sum to one; see [`ParticleFilter::EMPTY`].
    pub fn weights(&self) -> &[f32] {
        self.weights.weights()
    }

    /// Natural log-weights with an arbitrary common offset.
    pub fn log_weights(&self) -> &[f32] {
        self.weights.log_weights()
    }
}

impl<const D: usize, const N: usize> Default for ParticleFilter<D, N> {
    fn default() -> Self {
        Self::new()
    }
}

persist!(impl[const D: usize, const N: usize] ParticleFilter<D, N> as "ParticleFilter"(D, N) { particles, weights });

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::model::RandomWalk;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

    fn spread_out() -> (ParticleFilter<2, 200>, Xoshiro128PlusPlus) {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(61);
        let mut filter = ParticleFilter::new();
        filter.initialise(&mut rng, |rng| [normal(rng), normal(rng)]);
        (filter, rng)
    }

    #[test]
    fn memory_is_four_columns() {
        assert!(size_of::<ParticleFilter<2, 200>>() <= 16 * 200 + 8);
    }

    #[test]
    fn a_new_filter_that_only_predicts_has_moments() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(62);
        let mut filter = ParticleFilter::<1, 200>::new();
        filter.predict(&RandomWalk { sigma: [2.0] }, 1.0, &mut rng);
        assert_eq!(filter.weights(), [1.0 / 200.0; 200]);
        let variance = filter.covariance()[0][0];
        assert!(filter.mean()[0].abs() < 0.6 && (variance - 4.0).abs() < 1.4);
    }

    #[test]
    fn a_measurement_that_nothing_explains_changes_nothing() {
        let (mut filter, _) = spread_out();
        filter.update(&|[x, _]: &[f32; 2]| -x * x).unwrap();
        let before = filter.clone();
        for impossible in [f32::NEG_INFINITY, f32::NAN, f32::INFINITY] {
            let result = filter.update(&|_: &[f32; 2]| impossible);
            assert_eq!(result, Err(UpdateError::AllWeightsZero));
            assert_eq!(filter.weights(), before.weights());
            assert_eq!(filter.weights.log_sum(), before.weights.log_sum());
            assert_eq!(filter.log_weights(), before.log_weights());
        }
    }

    #[test]
    fn a_particle_that_is_impossible_dies_and_the_others_live() {
        let (mut filter, mut rng) = spread_out();
        filter
            .update(&|[x, _]: &[f32; 2]| if *x > 0.0 { 0.0 } else { f32::NAN })
            .unwrap();
        let alive = filter
            .weights()
            .iter()
            .zip(filter.particles().columns()[0])
            .filter(|(w, _)| **w > 0.0);
        assert!(alive.count() > 0);
        filter.resample(Scheme::Systematic, &mut rng);
        assert!(filter.particles().columns()[0].iter().all(|x| *x > 0.0));
    }

    #[test]
    fn evidence_is_the_probability_of_the_measurement() {
        // The evidence of a constant likelihood is that constant, whatever the weights.
        let (mut filter, mut rng) = spread_out();
        assert!((filter.update(&|_: &[f32; 2]| -7.0).unwrap() + 7.0).abs() < 1e-5);
        filter
            .update(&|[x, y]: &[f32; 2]| -x * x - 0.3 * y)
            .unwrap();
        assert!((filter.update(&|_: &[f32; 2]| 3.0).unwrap() - 3.0).abs() < 1e-5);
        filter.resample(Scheme::Stratified, &mut rng);
        assert!((filter.update(&|_: &[f32; 2]| -200.0).unwrap() + 200.0).abs() < 1e-4);
        // A new filter has equal weights as well.
        let mut fresh = ParticleFilter::<1, 77>::new();
        assert!((fresh.update(&|_: &[f32; 1]| 1.5).unwrap() - 1.5).abs() < 1e-5);
    }

    #[test]
    fn resampling_waits_for_a_small_sample_size() {
        let (mut filter, mut rng) = spread_out();
        assert!(!filter.resample_below(0.5, &mut rng));
        filter
            .update(&|[x, y]: &[f32; 2]| -20.0 * (x * x + y * y))
            .unwrap();
        assert!(filter.effective_sample_size() < 100.0);
        let mean = filter.mean();
        assert!(filter.resample_below(0.5, &mut rng));
        assert_eq!(filter.effective_sample_size(), 200.0);
        assert!(
            filter
                .mean()
                .iter()
                .zip(mean)
                .all(|(after, before)| (after - before).abs() < 0.05)
        );
    }

    #[test]
    fn the_columns_of_a_random_walk_are_its_steps() {
        let (filter, rng) = spread_out();
        let walk = RandomWalk { sigma: [2.0, 0.5] };
        let mut moved = filter.clone();
        moved.predict(&walk, 4.0, &mut rng.clone());
        let variance = |d: usize| {
            let steps = moved.particles.columns()[d]
                .iter()
                .zip(filter.particles.columns()[d]);
            steps
                .map(|(after, before)| (after - before) * (after - before))
                .sum::<f32>()
                / 200.0
        };
        // 16 and 1; the sigma of a variance of 200 samples is a tenth of it.
        assert!((variance(0) - 16.0).abs() < 5.3);
        assert!((variance(1) - 1.0).abs() < 0.33);
    }

    #[test]
    fn a_step_resamples_predicts_and_updates() {
        let (mut stepped, mut rng) = spread_out();
        let mut by_parts = stepped.clone();
        let mut parts_rng = rng.clone();
        let walk = RandomWalk { sigma: [0.3; 2] };
        for step in 0..10 {
            let near = |[x, y]: &[f32; 2]| -8.0 * ((x - 0.1 * step as f32).powi(2) + y * y);
            let evidence = stepped.step(&walk, &near, 1.0, &mut rng);
            by_parts.resample_below(0.5, &mut parts_rng);
            by_parts.predict(&walk, 1.0, &mut parts_rng);
            assert_eq!(evidence, by_parts.update(&near));
            assert_eq!(stepped.mean(), by_parts.mean());
        }
        assert!((stepped.mean()[0] - 0.9).abs() < 0.2);
        // A measurement that is refused counts as missing.
        let mut missing = stepped.clone();
        let refused = stepped.step(&walk, &|_: &[f32; 2]| f32::NAN, 1.0, &mut rng.clone());
        assert_eq!(refused, Err(UpdateError::AllWeightsZero));
        missing.resample_below(0.5, &mut rng);
        missing.predict(&walk, 1.0, &mut rng);
        assert_eq!(stepped.particles.columns(), missing.particles.columns());
    }
}
