//! The density that a filter approximates.

use super::Transition;
use crate::math::{exp_of_weight, ln};
use crate::model::Likelihood;
use crate::particles::read;

/// The posterior after one step from a weighted cloud: the likelihood times the mixture of the transitions of all
/// particles.
///
/// It is a [`Likelihood`] of the new state, so it is what a refinement has to aim at if it is to keep the posterior of a
/// state that moves. Each evaluation calls [`Transition::log_transition`] for every particle of the old cloud that has
/// a weight: `N` times, and a refinement evaluates up to [`crate::refine::Refinement::evaluations`] times.
///
/// ```
/// use foxhunt::filter::ParticleFilter;
/// use foxhunt::model::RandomWalk;
/// use foxhunt::proposal::Posterior;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
/// use foxhunt::refine::{DifferentialEvolution, Memory};
/// use foxhunt::resample::Scheme;
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let walk = RandomWalk { sigma: [1.0] };
/// let mut filter = ParticleFilter::<1, 100>::EMPTY;
/// let mut before = ParticleFilter::EMPTY;
/// let mut memory = Memory::EMPTY;
/// filter.initialise(&mut rng, |rng| [normal(rng)]);
/// for measured in [0.3, 1.1, 2.4, 2.2, 3.0] {
///     let measurement = |[x]: &[f32; 1]| -0.5 * ((x - measured) / 0.1).powi(2);
///     before.clone_from(&filter);
///     filter.predict(&walk, 1.0, &mut rng);
///     filter.update(&measurement)?;
///     filter.resample(Scheme::Systematic, &mut rng);
///     // Few particles were left, with many copies of each: move them apart.
///     let target = Posterior {
///         transition: &walk,
///         dt: 1.0,
///         columns: before.particles().columns(),
///         log_weights: before.log_weights(),
///         likelihood: &measurement,
///     };
///     filter.refine(&DifferentialEvolution::METROPOLIS, &target, &mut memory, &mut rng);
///     assert!((filter.mean()[0] - measured).abs() < 0.1);
/// }
/// # Ok::<(), foxhunt::filter::UpdateError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Posterior<'a, const D: usize, T, L> {
    /// How states move.
    pub transition: &'a T,
    /// Over how many seconds.
    pub dt: f32,
    /// The cloud before the step.
    pub columns: [&'a [f32]; D],
    /// Its log-weights, with any common offset.
    pub log_weights: &'a [f32],
    /// The measurement after the step.
    pub likelihood: &'a L,
}

impl<const D: usize, T: Transition<D>, L: Likelihood<D>> Likelihood<D> for Posterior<'_, D, T, L> {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        let log_likelihood = self.likelihood.log_likelihood(state);
        if log_likelihood.is_nan() || log_likelihood == f32::NEG_INFINITY {
            return f32::NEG_INFINITY;
        }
        let (mut largest, mut sum) = (f32::NEG_INFINITY, 0.0);
        for (i, log_weight) in self.log_weights.iter().enumerate() {
            if *log_weight == f32::NEG_INFINITY {
                continue;
            }
            let from = read(&self.columns, i);
            let term = log_weight + self.transition.log_transition(&from, state, self.dt);
            if term > largest {
                sum = 1.0 + sum * exp_of_weight(largest - term);
                largest = term;
            } else {
                // Nothing if it is NaN, or minus infinity.
                sum += exp_of_weight(term - largest);
            }
        }
        log_likelihood + largest + ln(sum)
    }
}
