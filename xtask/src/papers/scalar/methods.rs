//! The methods that are compared, on any model of one dimension.

use foxhunt::{
    filter::ParticleFilter,
    kalman::{Covariance, Unscented},
    model::Likelihood,
    proposal::{
        AuxiliaryFilter, PointMassFilter, Posterior, Sensor, Transition, UnscentedParticleFilter,
    },
    random::Xoshiro128PlusPlus,
    refine::{Memory, Refinement},
    resample::Scheme,
};

use super::{Estimates, Problem};
use crate::papers::counted::{Counted, Counter};

/// What a refinement aims at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The likelihood of the measurement alone.
    Likelihood,
    /// The posterior, by the cloud of the step before.
    Posterior,
}

/// A cloud, kept while the next one is made.
struct Before {
    column: Vec<f32>,
    log_weights: Vec<f32>,
}

impl Before {
    fn new(column: &[f32], log_weights: &[f32]) -> Self {
        Self {
            column: column.to_vec(),
            log_weights: log_weights.to_vec(),
        }
    }

    fn posterior<'a, T: Transition<1>, L: Likelihood<1>>(
        &'a self,
        transition: &'a T,
        likelihood: &'a L,
    ) -> Posterior<'a, 1, T, L> {
        Posterior {
            transition,
            dt: 1.0,
            columns: [&self.column],
            log_weights: &self.log_weights,
            likelihood,
        }
    }
}

/// Calls `step` with the counted model of every step.
fn walk<T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    mut step: impl FnMut(&Counted<'_, T>, &Counted<'_, M>) -> f32,
) -> Estimates {
    let counter = Counter::default();
    let means = problem
        .steps
        .iter()
        .map(|(dynamics, measurement)| {
            f64::from(step(&counter.of(dynamics), &counter.of(measurement)))
        })
        .collect();
    Estimates {
        means,
        calls: counter.calls(),
    }
}

/// The bootstrap filter, systematic resampling after every step.
pub fn bootstrap<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut filter = ParticleFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        filter.predict(dynamics, 1.0, rng);
        // Where all weights are zero the cloud stays as it is.
        let _ = filter.update(measurement);
        let [mean] = filter.mean();
        filter.resample(Scheme::Systematic, rng);
        mean
    })
}

/// The bootstrap filter, its particles drawn together as published before they are weighed.
pub fn gathered<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    refinement: &impl Refinement<1>,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        filter.resample_below(0.5, rng);
        filter.predict(dynamics, 1.0, rng);
        filter.refine(refinement, measurement, &mut memory, rng);
        let _ = filter.update(measurement);
        let [mean] = filter.mean();
        mean
    })
}

/// The bootstrap filter, its particles moved after resampling by a refinement that leaves the posterior invariant.
pub fn moved<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    refinement: &impl Refinement<1>,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        let [column] = filter.particles().columns();
        let before = Before::new(column, filter.particles().log_weights());
        filter.predict(dynamics, 1.0, rng);
        let _ = filter.update(measurement);
        let [mean] = filter.mean();
        filter.resample(Scheme::Systematic, rng);
        let target = before.posterior(dynamics, measurement);
        filter.refine(refinement, &target, &mut memory, rng);
        mean
    })
}

/// Particles that are predicted, and refined instead of weighed and resampled.
pub fn evolved<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    refinement: &impl Refinement<1>,
    target: Target,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        let [column] = filter.particles().columns();
        let before = Before::new(column, filter.particles().log_weights());
        filter.predict(dynamics, 1.0, rng);
        match target {
            Target::Likelihood => filter.refine(refinement, measurement, &mut memory, rng),
            Target::Posterior => {
                let target = before.posterior(dynamics, measurement);
                filter.refine(refinement, &target, &mut memory, rng)
            }
        };
        let [mean] = filter.mean();
        mean
    })
}

/// The unscented particle filter, systematic resampling after every step.
pub fn unscented<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut filter = UnscentedParticleFilter::<1, N>::new();
    filter.initialise(rng, &Covariance::ZERO, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        // Where no proposal can be, the weights stay.
        let _ = filter.step(&Unscented::DEFAULT, dynamics, measurement, 1.0, rng);
        let [mean] = filter.mean();
        filter.resample(Scheme::Systematic, rng);
        mean
    })
}

/// The same, its particles refined instead of resampled.
pub fn unscented_evolved<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    refinement: &impl Refinement<1>,
    target: Target,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut memory = Memory::new();
    let mut filter = UnscentedParticleFilter::<1, N>::new();
    filter.initialise(rng, &Covariance::ZERO, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        let [column] = filter.columns();
        let before = Before::new(column, filter.log_weights());
        let _ = filter.step(&Unscented::DEFAULT, dynamics, measurement, 1.0, rng);
        match target {
            Target::Likelihood => filter.refine(refinement, measurement, &mut memory, rng),
            Target::Posterior => {
                let target = before.posterior(dynamics, measurement);
                filter.refine(refinement, &target, &mut memory, rng)
            }
        };
        let [mean] = filter.mean();
        mean
    })
}

/// The fully adapted auxiliary filter, with a grid of `G` cells.
pub fn auxiliary<const N: usize, const G: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut filter = AuxiliaryFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        let _ = filter.step(dynamics, measurement, 1.0, &mut [0.0; G], rng);
        let [mean] = filter.mean();
        mean
    })
}

/// The tempered point mass filter, with a grid of `G` cells.
pub fn point_mass<const N: usize, const G: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
) -> Estimates {
    let mut filter = PointMassFilter::<1, N>::at([problem.start]);
    walk(problem, |dynamics, measurement| {
        let _ = filter.step(dynamics, measurement, 1.0, &mut [0.0; G]);
        let [mean] = filter.mean();
        mean
    })
}

/// A Markov chain of all particles on the posterior: a greedy refinement brings them there from where they are
/// predicted, then `chain` moves them `rounds` times. The estimate is the mean over the last three quarters of those.
pub fn chain<const N: usize, T: Transition<1>, M: Sensor<1, 1>>(
    problem: &Problem<T, M>,
    greedy: &impl Refinement<1>,
    chain: &impl Refinement<1>,
    rounds: usize,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<1, N>::new();
    filter.initialise(rng, |_| [problem.start]);
    walk(problem, |dynamics, measurement| {
        let [column] = filter.particles().columns();
        let before = Before::new(column, filter.particles().log_weights());
        let target = before.posterior(dynamics, measurement);
        filter.predict(dynamics, 1.0, rng);
        filter.refine(greedy, &target, &mut memory, rng);
        let mut sum = 0.0;
        let burn_in = rounds / 4;
        for round in 0..rounds {
            filter.refine(chain, &target, &mut memory, rng);
            if round >= burn_in {
                sum += filter.mean()[0];
            }
        }
        sum / (rounds - burn_in) as f32
    })
}
