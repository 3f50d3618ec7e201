//! The locators: of a stream of mixed readings, and of those of each source by themselves.

use anyhow::Result;
use foxhunt::{
    aoa::{Fix, Locate, MultiTarget, Observation, Robust, multi, robust},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::channel::Reading;

/// More tracks than there are sources: a user does not know how many there are.
pub const TRACKS: usize = 6;
type Several = MultiTarget<TRACKS, Robust<256>, 128>;
type One = Robust<256>;

/// What a user has who says nothing.
pub const DEFAULT: multi::Config = multi::Config::DEFAULT;
/// Told what is true of these arrays: they have no bias.
pub const UNBIASED: multi::Config = {
    let mut config = DEFAULT;
    config.track.errors.bias_sigma_rad = 0.0;
    config
};
const ONE: robust::Config = robust::Config::DEFAULT;

/// What the locator of several sources says.
pub struct Found {
    /// The fixes at the end.
    pub fixes: Vec<Fix>,
    /// The most that there ever were at once.
    pub most: usize,
}

/// The sources of a stream of readings, of which it is not told whose they are.
pub fn several(readings: &[Reading], config: &multi::Config, seed: u64) -> Result<Found> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(Several::EMPTY);
    let sources = |locator: &Several| (0..).map_while(|index| locator.source(index)).count();
    let mut most = 0;
    for reading in readings {
        locator.push(&reading.sight.try_into()?, config, &mut rng)?;
        most = most.max(sources(&locator));
    }
    let fixes = (0..).map_while(|index| Some(locator.source(index)?.fix));
    Ok(Found {
        fixes: fixes.collect(),
        most,
    })
}

/// The fix of each source by a locator that gets its readings alone.
pub fn told(readings: &[Reading], sources: usize, seed: u64) -> Result<Vec<Option<Fix>>> {
    let one = |source: usize| {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed ^ source as u64);
        let mut locator = Box::new(One::EMPTY);
        for reading in readings.iter().filter(|reading| reading.source == source) {
            let observation: Observation = reading.sight.try_into()?;
            locator.push(&observation, &ONE, &mut rng)?;
        }
        Ok(locator.fix())
    };
    (0..sources).map(one).collect()
}
