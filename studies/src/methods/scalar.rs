//! The methods that are compared on models of one dimension.

use foxhunt::{
    filter::ParticleFilter,
    kalman::{Covariance, Unscented},
    model::Likelihood,
    proposal::{
        AuxiliaryFilter, PointMassFilter, Posterior, Sensor, Transition, UnscentedParticleFilter,
    },
    random::Xoshiro128PlusPlus,
    refine::{Acceptance, DifferentialEvolution, Firefly, Memory, Refinement},
    resample::Scheme,
};

use super::bearings::published_fireflies;

/// A method.
pub trait Method {
    /// Starts in a known state, and after each step, of which it is told how the state comes there and what is
    /// measured, shows its estimate: the mean, and the cloud with its log-weights.
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        show: impl FnMut(f32, &[f32], &[f32]),
    );
}

/// Takes methods one after the other, each with what it is called in tables and in the names of figures.
pub trait Visit {
    /// Takes a method.
    fn method(
        &mut self,
        label: &'static str,
        key: &'static str,
        method: impl Method + Copy + Send + Sync + 'static,
    );
}

pub(crate) const BOOTSTRAP: &str = "bootstrap";
pub(crate) const BOOTSTRAP_1000: &str = "bootstrap.n1000";
pub(crate) const STANDARD: &str = "standard";
pub(crate) const IMPROVED: &str = "improved";
pub(crate) const IMPROVED_5: &str = "improved.5_moves";
pub(crate) const IMPROVED_METROPOLIS: &str = "improved.metropolis";
pub(crate) const PF: &str = "pf";
pub(crate) const PF_200: &str = "pf.n200";
pub(crate) const PFDE: &str = "pfde";
pub(crate) const PFDE_LIKELIHOOD: &str = "pfde.likelihood";
pub(crate) const UPF: &str = "upf";
pub(crate) const UPFDE: &str = "upfde";
pub(crate) const UPFDE_LIKELIHOOD: &str = "upfde.likelihood";
pub(crate) const EVOLUTION: &str = "evolution.metropolis";
pub(crate) const AUXILIARY: &str = "auxiliary";
pub(crate) const POINT_MASS: &str = "point_mass";

/// The study of the fireflies: 50 particles.
pub fn growth(visit: &mut impl Visit) {
    const N: usize = 50;
    let [standard, improved, five_moves] = published_fireflies();
    let metropolis = Firefly {
        iterations: 5,
        acceptance: Acceptance::Metropolis,
        ..Firefly::DEFAULT
    };

    visit.method("particle filter", BOOTSTRAP, Bootstrap::<N>);
    visit.method(
        "particle filter, N = 1000",
        BOOTSTRAP_1000,
        Bootstrap::<1000>,
    );
    visit.method("standard firefly", STANDARD, Gathered::<N, _>(standard));
    visit.method("improved firefly", IMPROVED, Gathered::<N, _>(improved));
    visit.method(
        "improved firefly, 5 moves",
        IMPROVED_5,
        Gathered::<N, _>(five_moves),
    );
    let metropolis = Moved::<N, _>(metropolis);
    visit.method(
        "improved firefly, Metropolis, 5 moves",
        IMPROVED_METROPOLIS,
        metropolis,
    );
    visit.method("adapted auxiliary filter", AUXILIARY, Auxiliary::<N, 64>);
    visit.method("tempered point mass", POINT_MASS, PointMass::<N, 256>);
}

/// The study of differential evolution: 10 particles.
pub fn gamma(visit: &mut impl Visit) {
    const N: usize = 10;
    let greedy = DifferentialEvolution::DEFAULT;
    let chain = DifferentialEvolution {
        generations: 2,
        ..DifferentialEvolution::METROPOLIS
    };
    let posterior = Evolved::<N, _>(greedy, Target::Posterior);
    let likelihood = Evolved::<N, _>(greedy, Target::Likelihood);

    visit.method("PF", PF, Bootstrap::<N>);
    visit.method("PF, N = 200", PF_200, Bootstrap::<200>);
    visit.method("PFDE", PFDE, posterior);
    visit.method("PFDE, fitness likelihood", PFDE_LIKELIHOOD, likelihood);
    visit.method("UPF", UPF, Proposed::<N>);
    let posterior = ProposedEvolved::<N, _>(greedy, Target::Posterior);
    visit.method("UPFDE", UPFDE, posterior);
    let likelihood = ProposedEvolved::<N, _>(greedy, Target::Likelihood);
    visit.method("UPFDE, fitness likelihood", UPFDE_LIKELIHOOD, likelihood);
    visit.method("adapted auxiliary filter", AUXILIARY, Auxiliary::<N, 32>);
    visit.method("tempered point mass", POINT_MASS, PointMass::<N, 64>);
    let chain = Chain::<N, _> {
        greedy,
        chain,
        rounds: 40,
    };
    visit.method("evolution, Metropolis", EVOLUTION, chain);
}

/// The bootstrap filter with more and more particles.
pub fn ladder(visit: &mut impl Visit) {
    visit.method("N = 10", BOOTSTRAP, Bootstrap::<10>);
    visit.method("N = 50", BOOTSTRAP, Bootstrap::<50>);
    visit.method("N = 200", BOOTSTRAP, Bootstrap::<200>);
    visit.method("N = 1000", BOOTSTRAP, Bootstrap::<1000>);
    visit.method("N = 5000", BOOTSTRAP, Bootstrap::<5000>);
    visit.method("N = 20,000", BOOTSTRAP, Bootstrap::<20_000>);
}

/// A cloud, kept while the next one is made.
struct Before<const N: usize> {
    column: [f32; N],
    log_weights: [f32; N],
}

impl<const N: usize> Before<N> {
    fn of(filter: &ParticleFilter<1, N>) -> Self {
        let mut before = Self {
            column: [0.0; N],
            log_weights: [0.0; N],
        };
        let [column] = filter.particles().columns();
        before.column.copy_from_slice(column);
        before.log_weights.copy_from_slice(filter.log_weights());
        before
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

fn filter_at<const N: usize>(start: f32, rng: &mut Xoshiro128PlusPlus) -> ParticleFilter<1, N> {
    let mut filter = ParticleFilter::new();
    filter.initialise(rng, |_| [start]);
    filter
}

fn show_cloud<const N: usize>(
    filter: &ParticleFilter<1, N>,
    mut show: impl FnMut(f32, &[f32], &[f32]),
) {
    let ([mean], [column]) = (filter.mean(), filter.particles().columns());
    show(mean, column, filter.log_weights());
}

/// The bootstrap filter, systematic resampling after every step.
#[derive(Clone, Copy)]
pub struct Bootstrap<const N: usize>;

impl<const N: usize> Method for Bootstrap<N> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut filter = filter_at::<N>(start, rng);
        for (dynamics, measurement) in steps {
            filter.predict(&dynamics, 1.0, rng);
            // Where all weights are zero the cloud stays as it is.
            let _ = filter.update(&measurement);
            show_cloud(&filter, &mut show);
            filter.resample(Scheme::Systematic, rng);
        }
    }
}

/// The bootstrap filter, its particles drawn together as published before they are weighed.
#[derive(Clone, Copy)]
pub struct Gathered<const N: usize, F>(F);

impl<const N: usize, F: Refinement<1>> Method for Gathered<N, F> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut memory = Memory::EMPTY;
        let mut filter = filter_at::<N>(start, rng);
        for (dynamics, measurement) in steps {
            filter.resample_below(0.5, rng);
            filter.predict(&dynamics, 1.0, rng);
            filter.refine(&self.0, &measurement, &mut memory, rng);
            let _ = filter.update(&measurement);
            show_cloud(&filter, &mut show);
        }
    }
}

/// The bootstrap filter, its particles moved after resampling by a refinement that leaves the posterior invariant.
#[derive(Clone, Copy)]
pub struct Moved<const N: usize, F>(F);

impl<const N: usize, F: Refinement<1>> Method for Moved<N, F> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut memory = Memory::EMPTY;
        let mut filter = filter_at::<N>(start, rng);
        for (dynamics, measurement) in steps {
            let before = Before::of(&filter);
            filter.predict(&dynamics, 1.0, rng);
            let _ = filter.update(&measurement);
            show_cloud(&filter, &mut show);
            filter.resample(Scheme::Systematic, rng);
            let posterior = before.posterior(&dynamics, &measurement);
            filter.refine(&self.0, &posterior, &mut memory, rng);
        }
    }
}

/// What evolution aims at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The likelihood of the measurement alone.
    Likelihood,
    /// The posterior, by the cloud of the step before.
    Posterior,
}

/// Particles that are predicted, and evolve instead of being weighed and resampled.
#[derive(Clone, Copy)]
pub struct Evolved<const N: usize, F>(F, Target);

impl<const N: usize, F: Refinement<1>> Method for Evolved<N, F> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut memory = Memory::EMPTY;
        let mut filter = filter_at::<N>(start, rng);
        for (dynamics, measurement) in steps {
            let before = Before::of(&filter);
            let posterior = before.posterior(&dynamics, &measurement);
            filter.predict(&dynamics, 1.0, rng);
            match self.1 {
                Target::Likelihood => filter.refine(&self.0, &measurement, &mut memory, rng),
                Target::Posterior => filter.refine(&self.0, &posterior, &mut memory, rng),
            };
            show_cloud(&filter, &mut show);
        }
    }
}

/// The unscented particle filter, systematic resampling after every step.
#[derive(Clone, Copy)]
pub struct Proposed<const N: usize>;

impl<const N: usize> Method for Proposed<N> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut filter = UnscentedParticleFilter::<1, N>::EMPTY;
        filter.initialise(rng, &Covariance::ZERO, |_| [start]);
        for (dynamics, measurement) in steps {
            // Where no proposal can be, the weights stay.
            let _ = filter.step(&Unscented::DEFAULT, &dynamics, &measurement, 1.0, rng);
            show_cloud(filter.cloud(), &mut show);
            filter.resample(Scheme::Systematic, rng);
        }
    }
}

/// The same, its particles evolving instead of being resampled.
#[derive(Clone, Copy)]
pub struct ProposedEvolved<const N: usize, F>(F, Target);

impl<const N: usize, F: Refinement<1>> Method for ProposedEvolved<N, F> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut memory = Memory::EMPTY;
        let mut filter = UnscentedParticleFilter::<1, N>::EMPTY;
        filter.initialise(rng, &Covariance::ZERO, |_| [start]);
        for (dynamics, measurement) in steps {
            let before = Before::of(filter.cloud());
            let posterior = before.posterior(&dynamics, &measurement);
            let _ = filter.step(&Unscented::DEFAULT, &dynamics, &measurement, 1.0, rng);
            match self.1 {
                Target::Likelihood => filter.refine(&self.0, &measurement, &mut memory, rng),
                Target::Posterior => filter.refine(&self.0, &posterior, &mut memory, rng),
            };
            show_cloud(filter.cloud(), &mut show);
        }
    }
}

/// The fully adapted auxiliary filter, with a grid of `G` cells.
#[derive(Clone, Copy)]
pub struct Auxiliary<const N: usize, const G: usize>;

impl<const N: usize, const G: usize> Method for Auxiliary<N, G> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut filter = AuxiliaryFilter::<1, N>::EMPTY;
        filter.initialise(rng, |_| [start]);
        for (dynamics, measurement) in steps {
            let _ = filter.step(&dynamics, &measurement, 1.0, &mut [0.0; G], rng);
            let ([mean], [column]) = (filter.mean(), filter.particles().columns());
            show(mean, column, filter.log_weights());
        }
    }
}

/// The tempered point mass filter, with a grid of `G` cells.
#[derive(Clone, Copy)]
pub struct PointMass<const N: usize, const G: usize>;

impl<const N: usize, const G: usize> Method for PointMass<N, G> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        _: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut filter = PointMassFilter::<1, N>::EMPTY;
        filter.initialise_at([start]);
        for (dynamics, measurement) in steps {
            let _ = filter.step(&dynamics, &measurement, 1.0, &mut [0.0; G]);
            let ([mean], [column]) = (filter.mean(), filter.columns());
            show(mean, column, filter.log_weights());
        }
    }
}

/// A Markov chain of all particles on the posterior: a greedy refinement brings them there from where they are
/// predicted, then `chain` moves them `rounds` times. The estimate is the mean over the last three quarters of those.
#[derive(Clone, Copy)]
pub struct Chain<const N: usize, F> {
    greedy: F,
    chain: F,
    rounds: u16,
}

impl<const N: usize, F: Refinement<1>> Method for Chain<N, F> {
    fn track<T: Transition<1>, M: Sensor<1, 1>>(
        &self,
        start: f32,
        steps: impl Iterator<Item = (T, M)>,
        rng: &mut Xoshiro128PlusPlus,
        mut show: impl FnMut(f32, &[f32], &[f32]),
    ) {
        let mut memory = Memory::EMPTY;
        let mut filter = filter_at::<N>(start, rng);
        for (dynamics, measurement) in steps {
            let before = Before::of(&filter);
            let posterior = before.posterior(&dynamics, &measurement);
            filter.predict(&dynamics, 1.0, rng);
            filter.refine(&self.greedy, &posterior, &mut memory, rng);
            let mut sum = 0.0;
            let burn_in = self.rounds / 4;
            for round in 0..self.rounds {
                filter.refine(&self.chain, &posterior, &mut memory, rng);
                if round >= burn_in {
                    sum += filter.mean()[0];
                }
            }
            let [column] = filter.particles().columns();
            let mean = sum / f32::from(self.rounds - burn_in);
            show(mean, column, filter.log_weights());
        }
    }
}
