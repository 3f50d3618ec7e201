//! The unscented particle filter.

use super::{Sensor, Transition};
use crate::estimate;
use crate::filter::UpdateError;
use crate::kalman::{Covariance, Gaussian, Unscented};
use crate::math::ln;
use crate::model::Likelihood;
use crate::particles::{read, write};
use crate::random::Rng;
use crate::refine::{Memory, Refinement, Report};
use crate::resample::{Scheme, resample};
use crate::weights;

/// A particle filter of `N` particles with a state of `D` dimensions, each of which runs an unscented Kalman filter
/// to see where the measurement draws it.
///
/// van der Merwe, Doucet, de Freitas and Wan, "The unscented particle filter" (2000): a particle samples its next
/// state from its own filter's posterior, and weighs likelihood times transition over the density it was drawn from,
/// so the weights are exact whatever the proposal. Its covariance stays with it, also when it is resampled.
///
/// Takes 4 N (D^2 + D + 2) + 8 bytes. `4 D + 4` calls of the model a particle and step.
///
/// ```
/// use foxhunt::kalman::{Covariance, Unscented};
/// use foxhunt::problems::gamma;
/// use foxhunt::proposal::UnscentedParticleFilter;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
/// use foxhunt::resample::Scheme;
///
/// let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
/// let mut filter = UnscentedParticleFilter::<1, 10>::new();
/// filter.initialise(&mut rng, &Covariance::ZERO, |_| [gamma::START]);
/// for (dynamics, truth, measurement) in gamma::simulate(0.04, 1e-2, &mut nature).take(50) {
///     filter.step(&Unscented::DEFAULT, &dynamics, &measurement, 1.0, &mut rng).unwrap();
///     assert!((filter.mean()[0] - truth).abs() < 2.0);
///     filter.resample(Scheme::Systematic, &mut rng);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct UnscentedParticleFilter<const D: usize, const N: usize> {
    columns: [[f32; N]; D],
    /// Factors of the particles' covariances: by column, row and particle.
    factors: [[[f32; N]; D]; D],
    log_weights: [f32; N],
    weights: [f32; N],
    log_sum: f32,
    effective_sample_size: f32,
}

impl<const D: usize, const N: usize> UnscentedParticleFilter<D, N> {
    /// All particles at the origin with no uncertainty of their own, with equal weights.
    pub const fn new() -> Self {
        const { assert!(D > 0 && N > 0 && N <= 1 << 16) };
        Self {
            columns: [[0.0; N]; D],
            factors: [[[0.0; N]; D]; D],
            log_weights: [0.0; N],
            weights: [1.0 / N as f32; N],
            log_sum: ln(N as f32),
            effective_sample_size: N as f32,
        }
    }

    /// Draws the state of every particle from `draw`, and gives each the same `covariance` of its own to start with:
    /// that of the prior as a rule, none when the state is known.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        covariance: &Covariance<D>,
        mut draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        for i in 0..N {
            write(&mut self.columns_mut(), i, draw(rng));
            self.set_covariance(i, covariance);
        }
        self.equal_weights();
    }

    /// Moves every particle by `dt` seconds to where the measurement `sensor` draws it, and weighs it. Returns the
    /// log-evidence, as [`crate::filter::ParticleFilter::update`] does.
    ///
    /// A particle whose Kalman filter fails moves blindly, as in a bootstrap filter, and keeps its covariance.
    ///
    /// # Errors
    /// When no particle is left with any weight. The particles then are where they were drawn, with their weights
    /// as before.
    pub fn step<const M: usize, R: Rng + ?Sized>(
        &mut self,
        unscented: &Unscented,
        transition: &impl Transition<D>,
        sensor: &impl Sensor<D, M>,
        dt: f32,
        rng: &mut R,
    ) -> Result<f32, UpdateError> {
        let process = transition.noise(dt);
        let noise = sensor.noise();
        for i in 0..N {
            let from = read(&self.columns(), i);
            let mut proposal = Gaussian {
                mean: from,
                covariance: self.covariance_of(i),
            };
            let drawn = unscented
                .predict(&mut proposal, |x| transition.mean(x, dt), &process)
                .and_then(|()| unscented.update(&mut proposal, |x| sensor.residual(x), &noise))
                .map(|_| proposal.draw(rng));
            let (to, log_ratio) = match drawn {
                Ok(to) => {
                    self.set_covariance(i, &proposal.covariance);
                    let log_transition = transition.log_transition(&from, &to, dt);
                    (to, log_transition - proposal.log_density(to))
                }
                Err(_) => (transition.step(from, dt, rng), 0.0),
            };
            write(&mut self.columns_mut(), i, to);
            if let Some(weight) = self.weights.get_mut(i) {
                *weight = sensor.log_likelihood(&to) + log_ratio;
            }
        }
        let Some(normalised) = weights::reweigh(&mut self.log_weights, &mut self.weights) else {
            weights::normalise(&mut self.log_weights, &mut self.weights);
            return Err(UpdateError::AllWeightsZero);
        };
        let log_evidence = normalised.shift + normalised.log_sum - self.log_sum;
        self.log_sum = normalised.log_sum;
        self.effective_sample_size = normalised.effective_sample_size;
        Ok(log_evidence)
    }

    /// Replaces light particles by copies of heavy ones, covariances and all, and makes the weights equal.
    pub fn resample<R: Rng + ?Sized>(&mut self, scheme: Scheme, rng: &mut R) {
        // Both columns of weights are about to be equal: until then they serve as memory.
        let ancestors = resample(scheme, &self.weights, &mut self.log_weights, rng);
        for column in self
            .columns
            .iter_mut()
            .chain(self.factors.as_flattened_mut())
        {
            ancestors.gather(column, &mut self.weights);
        }
        self.equal_weights();
    }

    /// Moves the particles by `refinement` towards or within the density `target`, and makes their weights equal: in
    /// place of resampling if it is greedy, after it if it keeps the target. Their covariances stay for the next step.
    ///
    /// With a greedy [`crate::refine::DifferentialEvolution`] this is the UPFDE of Li, Wang and Wang (2011). The target
    /// that it takes is [`crate::proposal::Posterior`]: with the likelihood alone it forgets what was known before.
    pub fn refine<R: Rng + ?Sized>(
        &mut self,
        refinement: &impl Refinement<D>,
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report {
        let columns = &mut self.columns_mut();
        let report = refinement.refine(columns, target, &mut memory.workspace(), rng);
        self.equal_weights();
        report
    }

    fn equal_weights(&mut self) {
        self.log_weights = [0.0; N];
        self.weights = [1.0 / N as f32; N];
        self.log_sum = ln(N as f32);
        self.effective_sample_size = N as f32;
    }

    pub(super) fn covariance_of(&self, i: usize) -> Covariance<D> {
        let entry = |column: &[f32; N]| column.get(i).copied().unwrap_or(0.0);
        let columns = self.factors.each_ref();
        Covariance::from_columns(columns.map(|rows| rows.each_ref().map(entry)))
    }

    pub(super) fn set_covariance(&mut self, i: usize, covariance: &Covariance<D>) {
        let entries = self.factors.as_flattened_mut().iter_mut();
        for (column, value) in entries.zip(covariance.columns().as_flattened()) {
            if let Some(place) = column.get_mut(i) {
                *place = *value;
            }
        }
    }

    #[cfg(test)]
    pub(super) fn set_weights(&mut self, weights: [f32; N]) {
        self.weights = weights;
    }

    /// How many equally weighted particles the cloud is worth, from 1 to `N`.
    pub fn effective_sample_size(&self) -> f32 {
        self.effective_sample_size
    }

    /// Weighted mean of the states.
    pub fn mean(&self) -> [f32; D] {
        estimate::mean(&self.columns(), &self.weights)
    }

    /// Weighted covariance of the states.
    pub fn covariance(&self) -> [[f32; D]; D] {
        estimate::covariance(&self.columns(), &self.weights)
    }

    /// The states, one column per dimension.
    pub fn columns(&self) -> [&[f32]; D] {
        self.columns.each_ref().map(|column| column.as_slice())
    }

    fn columns_mut(&mut self) -> [&mut [f32]; D] {
        self.columns.each_mut().map(|column| column.as_mut_slice())
    }

    /// Natural log-weights with an arbitrary common offset.
    pub fn log_weights(&self) -> &[f32] {
        &self.log_weights
    }

    /// The weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }
}

impl<const D: usize, const N: usize> Default for UnscentedParticleFilter<D, N> {
    fn default() -> Self {
        Self::new()
    }
}
