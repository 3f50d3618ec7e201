//! What the tests of the locators have in common.

use core::ops::Deref;

use super::{Alternative, Answer, Bearing, Locate, Locator, Observation, robust};
use crate::random::Rng;
pub(crate) use foxhunt_problems::bearings::Track;

/// What is believed of an array that is mounted straight.
pub(crate) const STRAIGHT: robust::Config = robust::Config {
    errors: robust::Errors {
        bias_sigma_rad: 0.0,
        ..robust::Errors::DEFAULT
    },
    ..robust::Config::DEFAULT
};

/// A locator that takes one bearing a second, whatever time the bearings state.
#[derive(Debug, Clone)]
pub(crate) struct Clocked<L: Locate> {
    locator: Locator<L>,
    time_ms: u32,
}

impl<L: Locate> Clocked<L> {
    pub(crate) fn new(config: L::Config) -> Self {
        Self {
            locator: Locator::new(config).unwrap(),
            time_ms: 0,
        }
    }

    pub(crate) fn push<R: Rng>(&mut self, observation: Observation, rng: &mut R) -> Answer {
        self.push_after(1000, observation, rng)
    }

    /// Takes a bearing so many milliseconds after the one before.
    pub(crate) fn push_after<R: Rng>(
        &mut self,
        ms: u32,
        observation: Observation,
        rng: &mut R,
    ) -> Answer {
        self.time_ms += ms;
        let observation = at(self.time_ms, &observation);
        self.locator.push(&observation, rng).unwrap()
    }

    /// Takes a reading of several bearings.
    pub(crate) fn push_reading<R: Rng>(
        &mut self,
        alternatives: &[Alternative],
        rng: &mut R,
    ) -> Answer {
        self.time_ms += 1000;
        let mut reading = heapless::Vec::<Alternative, 8>::new();
        for alternative in alternatives {
            let observation = at(self.time_ms, alternative.observation());
            let clocked = Alternative::new(observation, alternative.probability());
            reading.push(clocked.unwrap()).unwrap();
        }
        self.locator.push_alternatives(&reading, rng).unwrap()
    }

    pub(crate) fn reset(&mut self) {
        self.locator.reset();
    }
}

impl<L: Locate> Deref for Clocked<L> {
    type Target = Locator<L>;

    fn deref(&self) -> &Locator<L> {
        &self.locator
    }
}

/// The same bearing, taken at another time.
pub(crate) fn at(time_ms: u32, observation: &Observation) -> Observation {
    let (bearing, sigma) = (observation.bearing(), observation.sigma_rad());
    Observation::new(time_ms, observation.position(), bearing, sigma)
        .unwrap()
        .from_station(observation.station())
        .with_heading(observation.heading())
}

/// The bearings of one run on a track. `foxhunt-problems` depends on the library, not on the one under test, so that its
/// observations are of another type.
pub(crate) fn simulate<R: Rng>(track: Track, rng: &mut R) -> impl Iterator<Item = Observation> {
    track.simulate(rng).map(|seen| {
        let bearing = Bearing::from_radians(seen.bearing().radians());
        Observation::new(seen.time_ms(), seen.position(), bearing, seen.sigma_rad()).unwrap()
    })
}

/// Whether all bytes of a state are zero, where unused ones count as zero.
pub(crate) fn is_zero<T>(value: fn(&mut core::mem::MaybeUninit<T>)) -> bool {
    let mut place = core::mem::MaybeUninit::<T>::zeroed();
    value(&mut place);
    let start = place.as_ptr().cast::<u8>();
    // SAFETY: all bytes were set to zero, and then some of them were written.
    #[allow(unsafe_code)]
    (0..size_of::<T>()).all(|i| unsafe { start.add(i).read_volatile() } == 0)
}
