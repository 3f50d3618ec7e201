//! The methods that are compared on a source at rest and bearings along a track.

use foxhunt::{
    aoa::{
        Bearing, Clean, Locator, Observation,
        clean::Config,
        triangulation::{gauss_newton, intersection},
    },
    filter::ParticleFilter,
    math::{sqrt, wrap},
    model::{Likelihood, RandomWalk},
    random::{Xoshiro128PlusPlus, normal, uniform},
    refine::{Acceptance, DifferentialEvolution, Firefly, FishSchool, Lengths, Memory, Refinement},
    resample::Scheme,
};

/// The bearings of one run.
#[derive(Clone, Copy)]
pub struct Bearings<'a, L> {
    /// The bearings, with where they were taken.
    pub observations: &'a [Observation],
    /// The likelihood of each of them.
    pub likelihoods: &'a [L],
    /// What the published filters take the source to move by: variance in square metres per step and axis.
    pub process: f32,
}

/// Where a method takes the source to be.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    /// Metres east and north.
    pub position: [f32; 2],
    /// Of the position, in square metres.
    pub covariance: [[f32; 2]; 2],
}

/// Looks on while a method runs.
pub trait Watch {
    /// The estimate after a bearing, from a method that has one after each.
    fn estimate(&mut self, position: Option<[f32; 2]>);

    /// A locator that moves its particles so often has taken a bearing.
    fn pushed<const N: usize>(&mut self, locator: &Clean<N>, moves: u8);
}

/// A method.
pub trait Method {
    /// Its estimate after the last bearing.
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        watch: &mut impl Watch,
    ) -> Option<Estimate>;
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
pub(crate) const PUBLISHED: &str = "published";
pub(crate) const PUBLISHED_100: &str = "published.n100";
pub(crate) const PUBLISHED_1000: &str = "published.n1000";
pub(crate) const APART: &str = "published.apart";
pub(crate) const FISH: &str = "fish";
pub(crate) const FISH_RELATIVE: &str = "fish.relative";
pub(crate) const FISH_50: &str = "fish.50_iterations";
pub(crate) const FISH_LITERAL: &str = "fish.literal";
pub(crate) const METROPOLIS: &str = "fish.metropolis";
pub(crate) const EVOLUTION: &str = "evolution.metropolis";
pub(crate) const LOCATOR: &str = "locator";
pub(crate) const LOCATOR_100: &str = "locator.n100";
pub(crate) const LOCATOR_4: &str = "locator.4_moves";
pub(crate) const GAUSS_NEWTON: &str = "gauss_newton";
pub(crate) const STANDARD: &str = "standard";
pub(crate) const IMPROVED: &str = "improved";
pub(crate) const RELATIVE: &str = "improved.relative";
pub(crate) const IMPROVED_METROPOLIS: &str = "improved.metropolis";

/// The study of the locator.
pub fn aoa(visit: &mut impl Visit) {
    let plain = Bootstrap::<100>(Start::AnyPair);
    visit.method(
        "particle filter as published, N = 100",
        PUBLISHED_100,
        plain,
    );
    let plain = Bootstrap::<1000>(Start::AnyPair);
    visit.method(
        "particle filter as published, N = 1000",
        PUBLISHED_1000,
        plain,
    );
    visit.method("locator, N = 100", LOCATOR_100, Located::<100>(2));
    visit.method("Gauss-Newton on all bearings", GAUSS_NEWTON, GaussNewton);
}

/// The study of the fish school, with the published number of particles.
pub fn fish<const N: usize>(visit: &mut impl Visit) {
    // Metres, as printed.
    let printed = FishSchool::PUBLISHED;
    // Many short looks around: each iteration is one, and a random step if the place is not better.
    let restless = FishSchool {
        swarm: false,
        tries: 1,
        iterations: 50,
        ..printed
    };
    let relative = FishSchool::DEFAULT;
    // The best length of a random walk in two dimensions, of which a fish swims half on average.
    let metropolis = FishSchool {
        step: 3.4,
        follow: true,
        acceptance: Acceptance::Metropolis,
        ..FishSchool::DEFAULT
    };
    let evolution = DifferentialEvolution {
        crossover: 1.0,
        generations: 3,
        ..DifferentialEvolution::METROPOLIS
    };

    let plain = Bootstrap::<N>(Start::AnyPair);
    visit.method("particle filter as published", PUBLISHED, plain);
    let apart = Bootstrap::<N>(Start::Apart);
    visit.method("particle filter, pairs 20 places apart", APART, apart);
    let fish = Gathered::<N, _>(printed);
    visit.method("fish as published, 1 m and 0.3 m", FISH, fish);
    let relative = Gathered::<N, _>(relative);
    visit.method(
        "fish, lengths relative to the cloud",
        FISH_RELATIVE,
        relative,
    );
    let many = Gathered::<N, _>(restless);
    visit.method("prey only, 50 iterations of one try", FISH_50, many);
    let literal = Gathered::<N, _>(FishSchool {
        diagonal: true,
        ..restless
    });
    visit.method("the same, random step as printed", FISH_LITERAL, literal);
    visit.method("fish, Metropolis", METROPOLIS, Moved::<N, _>(metropolis));
    let evolution = Moved::<N, _>(evolution);
    visit.method("evolution, Metropolis", EVOLUTION, evolution);
    visit.method("locator", LOCATOR, Located::<N>(2));
    visit.method("locator, 4 moves", LOCATOR_4, Located::<N>(4));
    visit.method("Gauss-Newton on all bearings", GAUSS_NEWTON, GaussNewton);
}

/// The study of the fireflies.
pub fn fireflies<const N: usize>(visit: &mut impl Visit) {
    let [standard, improved, _] = published_fireflies();
    let drawn_in = Firefly::DEFAULT;
    let metropolis = Firefly {
        iterations: 3,
        ..Firefly::METROPOLIS
    };

    let plain = Bootstrap::<N>(Start::AnyPair);
    visit.method("particle filter as published", PUBLISHED, plain);
    let apart = Bootstrap::<N>(Start::Apart);
    visit.method("particle filter, pairs 20 places apart", APART, apart);
    visit.method("standard firefly", STANDARD, Gathered::<N, _>(standard));
    visit.method("improved firefly", IMPROVED, Gathered::<N, _>(improved));
    let relative = Gathered::<N, _>(drawn_in);
    visit.method(
        "improved firefly, lengths relative to the cloud",
        RELATIVE,
        relative,
    );
    let metropolis = Moved::<N, _>(metropolis);
    visit.method(
        "improved firefly, Metropolis, 3 moves",
        IMPROVED_METROPOLIS,
        metropolis,
    );
    visit.method("locator", LOCATOR, Located::<N>(2));
    visit.method("Gauss-Newton on all bearings", GAUSS_NEWTON, GaussNewton);
}

/// As published as far as it can be known: gamma, alpha and the least attraction are not printed. The standard form
/// sees far; the improved one is tuned to do least harm.
pub fn published_fireflies() -> [Firefly; 3] {
    let lengths = Lengths::Absolute;
    let standard = Firefly {
        lengths,
        absorption: 0.1,
        ..Firefly::STANDARD
    };
    let improved = Firefly {
        lengths,
        least_attraction: 0.0,
        ..Firefly::DEFAULT
    };
    let five_moves = Firefly {
        least_attraction: 0.05,
        iterations: 5,
        ..improved
    };
    [standard, improved, five_moves]
}

/// The bootstrap filter with more and more particles.
pub fn ladder(visit: &mut impl Visit) {
    visit.method("N = 100", BOOTSTRAP, Bootstrap::<100>(Start::AnyPair));
    visit.method("N = 300", BOOTSTRAP, Bootstrap::<300>(Start::AnyPair));
    visit.method("N = 1000", BOOTSTRAP, Bootstrap::<1000>(Start::AnyPair));
    visit.method("N = 3000", BOOTSTRAP, Bootstrap::<3000>(Start::AnyPair));
    visit.method("N = 10,000", BOOTSTRAP, Bootstrap::<10_000>(Start::AnyPair));
}

/// Two bearings must cross at an angle of at least this sine.
const LEAST_SINE: f32 = 0.02;

/// Where particles start: where two random bearings cross.
///
/// The paper pairs bearings a fixed gap apart in the order of their angles, and does not print the gap; that makes
/// fewer pairs than particles.
#[derive(Clone, Copy)]
pub enum Start {
    /// Any two that are not parallel.
    AnyPair,
    /// Any two that are at least 20 places apart in the order of their angles.
    Apart,
    /// Any two, each with another error of its own: the few pairs of the first few bearings cross at few places, and
    /// particles that do not differ never will.
    Disturbed,
}

impl Start {
    fn draw(self, observations: &[Observation], rng: &mut Xoshiro128PlusPlus) -> [f32; 2] {
        let draw = |rng: &mut Xoshiro128PlusPlus| {
            let [a, b] = [0; 2].map(|_| any(observations, rng));
            match self {
                Self::AnyPair => intersection(a, b, LEAST_SINE),
                Self::Apart if places_between(a, b, observations) < 20 => None,
                Self::Apart => intersection(a, b, LEAST_SINE),
                Self::Disturbed => {
                    let [a, b] = [a, b].map(|observation| disturbed(observation, rng));
                    intersection(&a?, &b?, LEAST_SINE)
                }
            }
        };
        (0..1000).find_map(|_| draw(rng)).unwrap_or_default()
    }
}

fn any<'a>(observations: &'a [Observation], rng: &mut Xoshiro128PlusPlus) -> &'a Observation {
    &observations[(uniform(rng) * observations.len() as f32) as usize]
}

fn disturbed(observation: &Observation, rng: &mut Xoshiro128PlusPlus) -> Option<Observation> {
    let sigma = observation.sigma_rad();
    let angle = observation.bearing().radians() + sigma * normal(rng);
    let bearing = Bearing::from_radians(angle);
    Observation::new(
        observation.time_ms(),
        observation.position(),
        bearing,
        sigma,
    )
    .ok()
}

/// How many places `b` is from `a` in the order of their angles.
fn places_between(a: &Observation, b: &Observation, all: &[Observation]) -> usize {
    let (a, b) = (a.bearing().radians(), b.bearing().radians());
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    let between = |o: &&Observation| (low..high).contains(&o.bearing().radians());
    all.iter().filter(between).count()
}

/// The bootstrap filter of the papers: a random walk of the source, systematic resampling after every bearing. The
/// printed weights count each bearing twice; here it counts once.
#[derive(Clone, Copy)]
pub struct Bootstrap<const N: usize>(pub Start);

impl<const N: usize> Method for Bootstrap<N> {
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        watch: &mut impl Watch,
    ) -> Option<Estimate> {
        bootstrap::<N, L>(bearings, self.0, rng, watch, |_, _, _| {})
    }
}

/// The same, its particles refined as published: by the likelihood of the bearing, before they are weighed by it.
#[derive(Clone, Copy)]
pub struct Gathered<const N: usize, F>(F);

impl<const N: usize, F: Refinement<2>> Method for Gathered<N, F> {
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        watch: &mut impl Watch,
    ) -> Option<Estimate> {
        let mut memory = Memory::EMPTY;
        bootstrap::<N, L>(
            bearings,
            Start::AnyPair,
            rng,
            watch,
            |filter, likelihood, rng| {
                filter.refine(&self.0, likelihood, &mut memory, rng);
            },
        )
    }
}

fn bootstrap<const N: usize, L: Likelihood<2>>(
    bearings: Bearings<'_, L>,
    start: Start,
    rng: &mut Xoshiro128PlusPlus,
    watch: &mut impl Watch,
    mut refine: impl FnMut(&mut ParticleFilter<2, N>, &L, &mut Xoshiro128PlusPlus),
) -> Option<Estimate> {
    let walk = RandomWalk {
        sigma: [sqrt(bearings.process); 2],
    };
    let mut filter = ParticleFilter::<2, N>::new();
    filter.initialise(rng, |rng| start.draw(bearings.observations, rng));
    for (index, likelihood) in bearings.likelihoods.iter().enumerate() {
        if index > 0 {
            filter.resample(Scheme::Systematic, rng);
        }
        filter.predict(&walk, 1.0, rng);
        refine(&mut filter, likelihood, rng);
        // Where all weights are zero the cloud stays as it is: a lost run.
        let _ = filter.update(likelihood);
        watch.estimate(Some(filter.mean()));
    }
    Some(Estimate {
        position: filter.mean(),
        covariance: filter.covariance(),
    })
}

/// A source at rest, all bearings kept: started when the bearings cross, its particles moved after every resampling by a
/// refinement that leaves the posterior of all bearings so far invariant.
#[derive(Clone, Copy)]
pub struct Moved<const N: usize, F>(pub F);

impl<const N: usize, F: Refinement<2>> Method for Moved<N, F> {
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        watch: &mut impl Watch,
    ) -> Option<Estimate> {
        /// The bearings must cross at this angle, in radians, before particles start.
        const CROSSING: f32 = 0.35;
        /// Refinements that bring the first cloud, of a few survivors, to rest.
        const FIRST: usize = 10;
        let mut memory = Memory::EMPTY;
        let mut filter = ParticleFilter::<2, N>::new();
        let mut started = false;
        for (index, latest) in bearings.likelihoods.iter().enumerate() {
            let seen = &bearings.observations[..=index];
            let likelihoods = &bearings.likelihoods[..=index];
            let posterior = |state: &[f32; 2]| -> f32 {
                likelihoods.iter().map(|l| l.log_likelihood(state)).sum()
            };
            if started {
                // A normal likelihood is never zero.
                filter.update(latest).ok()?;
                if filter.effective_sample_size() < 0.5 * N as f32 {
                    filter.resample(Scheme::Systematic, rng);
                    filter.refine(&self.0, &posterior, &mut memory, rng);
                }
            } else if turned(seen) > CROSSING {
                started = true;
                filter.initialise(rng, |rng| Start::Disturbed.draw(seen, rng));
                filter.update(&posterior).ok()?;
                filter.resample(Scheme::Systematic, rng);
                for _ in 0..FIRST {
                    filter.refine(&self.0, &posterior, &mut memory, rng);
                }
            }
            watch.estimate(started.then(|| filter.mean()));
        }
        // The covariance of n samples about their own mean is small by 1 - 1/n, and that mean is off by 1/n of it.
        let n = filter.effective_sample_size();
        let sampling = (1.0 + 1.0 / n) / (1.0 - 1.0 / n);
        Some(Estimate {
            position: filter.mean(),
            covariance: filter.covariance().map(|row| row.map(|v| v * sampling)),
        })
    }
}

/// The largest angle of a bearing to the first.
fn turned(observations: &[Observation]) -> f32 {
    let angle = |o: &Observation| o.bearing().radians();
    observations
        .iter()
        .map(|o| wrap(angle(o) - angle(&observations[0])).abs())
        .fold(0.0, f32::max)
}

/// The library's own, which moves its particles so often after a resampling.
#[derive(Clone, Copy)]
pub struct Located<const N: usize>(pub u8);

impl<const N: usize> Method for Located<N> {
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        watch: &mut impl Watch,
    ) -> Option<Estimate> {
        let config = Config {
            moves: self.0,
            ..Config::DEFAULT
        };
        let mut locator = Locator::<Clean<N>>::new(config).ok()?;
        for observation in bearings.observations {
            let answer = locator.push(observation, rng).ok()?;
            watch.estimate(answer.fix().map(|fix| fix.position));
            watch.pushed(locator.state(), self.0);
        }
        locator.fix().map(|fix| Estimate {
            position: fix.position,
            covariance: fix.covariance.rows(),
        })
    }
}

/// From the middle of some random crossings.
#[derive(Clone, Copy)]
pub struct GaussNewton;

impl Method for GaussNewton {
    fn locate<L: Likelihood<2>>(
        &self,
        bearings: Bearings<'_, L>,
        rng: &mut Xoshiro128PlusPlus,
        _: &mut impl Watch,
    ) -> Option<Estimate> {
        const CROSSINGS: usize = 31;
        let mut columns = [[0.0; CROSSINGS]; 2];
        for k in 0..CROSSINGS {
            let crossing = Start::Apart.draw(bearings.observations, rng);
            for (column, x) in columns.iter_mut().zip(crossing) {
                column[k] = x;
            }
        }
        let middle = columns.map(|mut column| {
            column.sort_unstable_by(f32::total_cmp);
            column[CROSSINGS / 2]
        });
        let (position, covariance) = gauss_newton(bearings.observations, middle)?;
        Some(Estimate {
            position,
            covariance: covariance.rows(),
        })
    }
}
