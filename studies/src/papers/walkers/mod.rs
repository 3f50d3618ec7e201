//! Somebody who walks among fixed arrays, each of which has a bias of its own: simulated, beside a converged reference, and
//! measured, beside least squares with a Kalman filter.

use anyhow::Result;
use foxhunt::{
    aoa::{Answer, Locator, Manoeuvring, Observation, PushError, Robust, manoeuvring::Config},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::figures::Figure;
use foxhunt_simulation::Sight;

use super::study::Study;

mod baseline;
mod measured;
mod simulated;

/// Seconds from one score to the next, and until the first.
const EVERY_S: f64 = 1.0;
const FIRST_S: f64 = 5.0;

/// Runs the simulated and the measured walks.
///
/// # Errors
/// When measured data cannot be read.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut figures = simulated::run(study.runs.unwrap_or(1000), study.seed)?;
    if let Some(data) = study.data("xplr", "walks") {
        figures.extend(measured::run(&data, study.seed)?);
    }
    Ok(figures)
}

/// Components of the locator unless it has others, and as many as a computer has room and time for.
const COMPONENTS: usize = 128;
const MANY: usize = 1024;

/// The locator of walkers among four stations.
struct Follower<const N: usize> {
    locator: Box<Locator<Manoeuvring<Robust<256>, 4, N>>>,
    rng: Xoshiro128PlusPlus,
}

impl<const N: usize> Follower<N> {
    fn new(config: Config, seed: u64) -> Result<Self> {
        Ok(Self {
            locator: Box::new(Locator::new(config)?),
            rng: Xoshiro128PlusPlus::seed_from_u64(seed),
        })
    }

    /// Takes a reading of a station, unless it is the second of a millisecond.
    fn push(&mut self, (station, sight): &(u8, Sight)) -> Result<()> {
        let observation = Observation::try_from(*sight)?.from_station(*station);
        match self.locator.push(&observation, &mut self.rng) {
            Err(PushError::Duplicate) | Ok(_) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    fn answer(&self) -> Answer {
        self.locator.answer()
    }
}
