//! The state of a manoeuvring locator.

use heapless::Deque;

use super::cloud::Cloud;
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::independent;
use crate::aoa::track::Stationary;
use crate::aoa::{Answer, Fix, Mixture, Observation};
use crate::persist;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, by_value, value};

/// The latest bearings that are kept: enough for a stop that is noticed after half a minute of one each second.
pub(super) const RECENT: usize = 32;

/// Bearings over which the fraction of outliers is counted: fewer notice a loss sooner, and take more rows of outliers for
/// one.
pub(super) const MEMORY: f32 = 8.0;

/// Whose answer is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// The stationary locator's: where the source is, or that this is not known yet.
    Stationary,
    /// The mean of both explanations.
    Departing,
    /// The cloud's. The stationary locator looks for a place where the source may have stopped.
    Moving,
}

/// For how long the source has been lost: not at all, if there are no bearings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lost {
    pub(super) seconds: f32,
    pub(super) bearings: u32,
}

value!(Lost { seconds, bearings });

impl Lost {
    pub(super) const NOT: Self = Self {
        seconds: 0.0,
        bearings: 0,
    };
}

/// Seconds of so many milliseconds.
pub(super) fn seconds(milliseconds: i32) -> f32 {
    milliseconds as f32 / 1000.0
}

/// Locates one source that may manoeuvre, by a locator `L` for a stationary one.
///
/// It takes 9.6 kB more than that: 17.7 kB around a [`Robust<256, 64>`](crate::aoa::Robust).
///
/// ```
/// use foxhunt::aoa::{Bearing, Locator, Manoeuvring, Observation, Robust, manoeuvring::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = Locator::<Manoeuvring<Robust<256>>>::new(Config::DEFAULT)?;
/// // Driving round a source that is stationary for a minute and then drives north.
/// for second in 0..75 {
///     let angle = 0.04 * second as f32;
///     let [x, y] = [300.0 * angle.cos(), 300.0 * angle.sin()];
///     let north = if second < 60 { 0.0 } else { 10.0 * (second - 60) as f32 };
///     let bearing = Bearing::from_radians((north - y).atan2(-x));
///     locator.push(&Observation::new(1000 * second, [x, y], bearing, 0.04)?, &mut rng)?;
/// }
/// let motion = locator.state().motion().expect("it has moved");
/// assert!(motion.moving > 0.9 && motion.velocity_m_s[1] > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Manoeuvring<L> {
    /// The explanation that it is stationary, if it has a fix.
    pub(super) stationary: L,
    /// Of the bearings, as learned while it was stationary; all zero before.
    pub(super) rates: Mixture,
    /// The explanation that it has moved.
    pub(super) cloud: Cloud,
    /// Probability of the cloud's explanation.
    pub(super) moved: f32,
    pub(super) phase: Phase,
    /// The oldest first.
    pub(super) recent: Deque<Observation, RECENT>,
    /// Fraction of the latest bearings that are outliers.
    pub(super) misfit: f32,
    /// Bearings since the stationary locator started to look for where the source has stopped.
    pub(super) tries: u32,
    pub(super) lost: Lost,
    /// The latest credible fix.
    pub(super) seen: Option<Fix>,
    pub(super) bearings: u32,
    pub(super) answer: Answer,
}

persist!(impl[L: Persist] Manoeuvring<L> as "Manoeuvring"() {
    stationary, rates, cloud, moved, phase, recent, misfit, tries, lost, seen, bearings, answer
});

impl<L: Stationary> Manoeuvring<L> {
    /// Keeps a bearing, and returns it with a sigma by which it counts for no more than it tells beside the earlier ones.
    pub(super) fn remember(&mut self, observation: &Observation, errors: &Errors) -> Observation {
        let earlier =
            (self.recent.iter()).map(|old| (old, seconds(observation.since_ms(old.time_ms()))));
        let fresh = independent(observation, earlier, errors);
        if self.recent.is_full() {
            self.recent.pop_front();
        }
        let _ = self.recent.push_back(*observation);
        fresh
    }

    /// Where the latest bearing was taken.
    pub(super) fn latest_position(&self) -> [f32; 2] {
        (self.recent.back()).map_or([0.0; 2], Observation::position)
    }
}

impl Value for Phase {
    const SIZE: usize = 1;

    fn write(&self, to: &mut Writer<'_>) {
        (*self as u8).write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(match u8::read(from)? {
            0 => Self::Stationary,
            1 => Self::Departing,
            2 => Self::Moving,
            _ => return Err(Error::Malformed),
        })
    }
}

by_value!(Phase);
