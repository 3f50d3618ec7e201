//! The locators that the page offers.

use foxhunt::{
    aoa::{
        Clean, Locate, Locator, Manoeuvring, MultiTarget, Observation, PushError, Robust, clean,
        manoeuvring, presets, robust,
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
    refine::{DifferentialEvolution, Firefly, FishSchool},
};
use serde::Deserialize;

use crate::{
    known,
    messages::{Answer, Taken},
};

/// A locator, and how it moves its particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    /// What it expects of bearings and sources.
    pub kind: Kind,
    /// One of [`PARTICLES`].
    pub particles: usize,
    /// What moves the particles of [`Kind::Clean`]; the others have moves of their own.
    pub refinement: Refinement,
}

/// What a locator expects of bearings and sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// One source at rest, and every bearing points at it, but for its error.
    Clean,
    /// One source at rest; bearings may be outliers, mirrored or biased.
    Robust,
    /// One source that may move, with such bearings.
    Moving,
    /// Up to three sources that may move, with such bearings.
    Several,
}

/// What moves particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Refinement {
    /// The locator itself.
    None,
    /// A school of fish.
    Fish,
    /// A swarm of fireflies.
    Firefly,
    /// Differential evolution.
    Evolution,
}

/// The numbers of particles to choose from.
pub const PARTICLES: [usize; 3] = [100, 256, 1000];

/// A locator of any kind, with its generator.
pub trait Any: Send {
    /// Takes one bearing.
    ///
    /// # Errors
    /// As [`Locate::push`].
    fn push(&mut self, observation: &Observation) -> Result<(), PushError>;

    /// What is known, while the vehicle is `here`.
    fn answer(&self, here: [f32; 2]) -> Answer;

    /// The probability that a bearing is an outlier.
    fn outlier(&self, observation: &Observation) -> Option<f32>;

    /// A bearing as the locator takes it now; `then` as in [`known::taken`].
    fn taken(&self, bearing: (usize, &Observation), then: Option<f32>) -> Taken;

    /// The same state once more.
    fn copied(&self) -> Box<dyn Any>;
}

#[derive(Clone)]
struct Seeded<L: Locate> {
    locator: Locator<L>,
    rng: Xoshiro128PlusPlus,
}

impl<L> Any for Seeded<L>
where
    L: Locate<Config: Send> + Clone + Send + 'static,
{
    fn push(&mut self, observation: &Observation) -> Result<(), PushError> {
        self.locator.push(observation, &mut self.rng).map(drop)
    }

    fn answer(&self, here: [f32; 2]) -> Answer {
        known::answer(self.locator.state(), self.locator.config(), here)
    }

    fn outlier(&self, observation: &Observation) -> Option<f32> {
        known::outlier(observation, self.locator.state(), self.locator.config())
    }

    fn taken(&self, bearing: (usize, &Observation), then: Option<f32>) -> Taken {
        known::taken(bearing, then, self.locator.state(), self.locator.config())
    }

    fn copied(&self) -> Box<dyn Any> {
        Box::new(self.clone())
    }
}

impl Choice {
    /// A locator that knows nothing yet; `None` with a number of particles that is not among [`PARTICLES`].
    pub fn locator(&self, seed: u64) -> Option<Box<dyn Any>> {
        match self.particles {
            100 => self.of_size::<100>(seed),
            256 => self.of_size::<256>(seed),
            1000 => self.of_size::<1000>(seed),
            _ => None,
        }
    }

    fn of_size<const N: usize>(&self, seed: u64) -> Option<Box<dyn Any>> {
        const MOVING: manoeuvring::Config = manoeuvring::Config::new(robust::Config::CITY);
        match self.kind {
            Kind::Clean => self.refined::<N>(seed),
            Kind::Robust => seeded::<Robust<N>>(robust::Config::CITY, seed),
            Kind::Moving => seeded::<Manoeuvring<Robust<N>>>(MOVING, seed),
            Kind::Several => {
                seeded::<MultiTarget<3, Manoeuvring<Robust<N>>, 64>>(presets::CITY, seed)
            }
        }
    }

    fn refined<const N: usize>(&self, seed: u64) -> Option<Box<dyn Any>> {
        use clean::Config;
        match self.refinement {
            Refinement::None => seeded::<Clean<N>>(Config::DEFAULT, seed),
            Refinement::Fish => seeded::<Clean<N, 64, FishSchool>>(
                Config::with_refinement(FishSchool::METROPOLIS),
                seed,
            ),
            Refinement::Firefly => {
                seeded::<Clean<N, 64, Firefly>>(Config::with_refinement(Firefly::METROPOLIS), seed)
            }
            Refinement::Evolution => seeded::<Clean<N, 64, DifferentialEvolution>>(
                Config::with_refinement(DifferentialEvolution::METROPOLIS),
                seed,
            ),
        }
    }
}

fn seeded<L>(config: L::Config, seed: u64) -> Option<Box<dyn Any>>
where
    L: Locate<Config: Send> + Clone + Send + 'static,
{
    Some(Box::new(Seeded {
        locator: Locator::<L>::new(config).ok()?,
        rng: Xoshiro128PlusPlus::seed_from_u64(seed),
    }))
}
