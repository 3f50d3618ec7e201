//! The unscented particle filter.

use super::{Sensor, Transition};
use crate::filter::{ParticleFilter, UpdateError};
use crate::kalman::{Covariance, Gaussian, Unscented};
use crate::model::Likelihood;
use crate::particles::{read, write};
use crate::random::Rng;
use crate::refine::{Memory, Refinement, Report};
use crate::resample::Scheme;

/// A particle filter of `N` particles with a state of `D` dimensions, each of which runs an unscented Kalman filter
/// to see where the measurement draws it.
///
/// van der Merwe, Doucet, de Freitas and Wan, "The unscented particle filter" (2000): a particle samples its next
/// state from its own filter's posterior, and weighs likelihood times transition over the density it was drawn from.
/// Its covariance stays with it, also when it is resampled.
///
/// The weights are exact in expectation, but useful only while a particle's covariance is not much wider than
/// [`Transition::noise`]: few of the states that it proposes can then be reached from where the particle is. Where
/// the noise is small beside what is known of the state, call [`UnscentedParticleFilter::forget`] before each step.
///
/// An outlier draws every particle away. Return NaN from [`Sensor::residual`] beyond some sigmas: the particle then
/// moves blindly, and [`Likelihood::log_likelihood`] has the tails.
///
/// Takes 4 N (D^2 + D + 2) + 8 bytes. `4 D + 4` calls of the model a particle and step.
///
/// ```
/// use foxhunt::kalman::{Covariance, Unscented};
/// use foxhunt_problems::gamma;
/// use foxhunt::proposal::UnscentedParticleFilter;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
/// use foxhunt::resample::Scheme;
///
/// let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
/// let mut filter = UnscentedParticleFilter::<1, 10>::EMPTY;
/// filter.initialise(&mut rng, &Covariance::ZERO, |_| [gamma::START]);
/// for (dynamics, truth, measurement) in gamma::simulate(0.04, 1e-2, &mut nature).take(50) {
///     filter.step(&Unscented::DEFAULT, &dynamics, &measurement, 1.0, &mut rng).unwrap();
///     assert!((filter.mean()[0] - truth).abs() < 2.0);
///     filter.resample(Scheme::Systematic, &mut rng);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct UnscentedParticleFilter<const D: usize, const N: usize> {
    cloud: ParticleFilter<D, N>,
    /// Factors of the particles' covariances: by column, row and particle.
    factors: [[[f32; N]; D]; D],
}

impl<const D: usize, const N: usize> UnscentedParticleFilter<D, N> {
    /// All particles at the origin with no uncertainty of their own, with equal weights, in bits that are all zero.
    pub const EMPTY: Self = Self {
        cloud: ParticleFilter::EMPTY,
        factors: [[[0.0; N]; D]; D],
    };

    /// Draws the state of every particle from `draw`, and gives each the same `covariance` of its own to start with:
    /// [`Covariance::ZERO`] if `draw` samples the prior, that of the prior if `draw` returns its mean.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        covariance: &Covariance<D>,
        draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        self.cloud.initialise(rng, draw);
        for i in 0..N {
            self.set_covariance(i, covariance);
        }
    }

    /// Sets the covariances of all particles to zero; their states and weights stay.
    ///
    /// To be called before each step where the noise of the transition is small beside what is known of the state. A
    /// particle then proposes from the noise of one step: a local linearisation, Doucet, Godsill and Andrieu, "On
    /// sequential Monte Carlo sampling methods for Bayesian filtering" (2000), section II.D.
    pub fn forget(&mut self) {
        self.factors = [[[0.0; N]; D]; D];
    }

    /// Moves every particle by `dt` seconds to where the measurement `sensor` draws it, and weighs it. Returns the
    /// log-evidence, as [`crate::filter::ParticleFilter::update`] does.
    ///
    /// A particle whose Kalman filter fails moves blindly, as in a bootstrap filter, and keeps its covariance. So do all
    /// without a measurement: its residual is NaN, and its log-likelihood 0.
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
            let from = read(&self.cloud.particles.columns(), i);
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
            write(&mut self.cloud.columns_mut(), i, to);
            let log_likelihoods = self.cloud.weights.log_likelihoods_mut();
            if let Some(place) = log_likelihoods.get_mut(i) {
                *place = sensor.log_likelihood(&to) + log_ratio;
            }
        }
        self.cloud.weights.update()
    }

    /// Replaces light particles by copies of heavy ones, covariances and all, and makes the weights equal.
    pub fn resample<R: Rng + ?Sized>(&mut self, scheme: Scheme, rng: &mut R) {
        let ParticleFilter { particles, weights } = &mut self.cloud;
        weights.resample(scheme, rng, |ancestors, scratch| {
            particles.gather(ancestors, scratch);
            for column in self.factors.as_flattened_mut() {
                ancestors.gather(column, scratch);
            }
        });
    }

    /// Moves the particles by `refinement` towards or within the density `target`, and makes their weights equal,
    /// which [`ParticleFilter::refine`] does not: in place of resampling if it is greedy, after it if it keeps the target.
    /// Their covariances stay for the next step.
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
        let report = self.cloud.refine(refinement, target, memory, rng);
        self.cloud.weights.make_equal();
        report
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
        *self.cloud.weights.columns_mut().1 = weights;
    }

    /// The particles and their weights.
    pub fn cloud(&self) -> &ParticleFilter<D, N> {
        &self.cloud
    }

    /// Weighted mean of the states.
    pub fn mean(&self) -> [f32; D] {
        self.cloud.mean()
    }

    /// Weighted covariance of the states.
    pub fn covariance(&self) -> [[f32; D]; D] {
        self.cloud.covariance()
    }
}
