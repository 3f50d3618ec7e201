//! A locator for a source that is stationary, manoeuvres and is stationary again.
//!
//! [`Manoeuvring`] holds two explanations of the bearings and the probability of each. One is that the source is still where
//! it was: a stationary locator, whose posterior is that of all bearings since. The other is that it has moved: a cloud of
//! normal distributions over positions and velocities, whose newest were stationary until the latest bearing, and some of
//! which have stopped. Their probabilities follow from how well each of them predicted every bearing: a jump Markov system
//! (Ristic, Arulampalam and Gordon 2004, section 1.4), of which one regime is not filtered but known exactly.
//!
//! * The source moves once that is likelier than not; the answer then is the mean of both explanations, until that of
//!   a stationary source has next to no probability.
//! * While the source moves, the stationary locator restarts again and again about where it is, and finds a place only if
//!   it has stopped: that is the explanation that it is stationary then, which is weighed as before.
//! * A source that no bearing fits for long is lost: the cloud is spread on the rays of new bearings, ever farther from where
//!   the source was last seen; after that, everything starts again with the latest bearings.
//!
//! Bearings alone say little of how far away a moving source is: its fix is as wide as it must be, and none if that is too
//! wide. Of simulated chases by a vehicle of 10 to 15 m/s, with bearings of 2 to 3 degrees every second, one in ten an
//! outlier, the ellipses of 95 % hold a stationary source in 96 %, a moving one in 94 %, and in the first 15 s after its
//! departure in 62 %, which until it has been noticed cannot be otherwise; this takes some 4 s in the median, and half a
//! minute that it has stopped and where.
//!
//! Time is what tells a stationary source from a moving one: where all bearings have the same time, nothing ever moves. A
//! bearing that is older than the latest goes to the stationary explanation only, for as long as that takes it.

mod cloud;
mod component;
mod conclusions;
mod config;
mod drive;
mod explanations;
mod lost;
mod phases;

use heapless::Deque;

use super::robust::Errors;
use super::robust::outside::independent;
use super::track::{Stationary, Track};
use super::{Answer, Fix, Mixture, Observation, PushError};
use crate::persist;
use crate::random::Rng;
use crate::snapshot::Persist;
use cloud::Cloud;
pub use config::Config;
use drive::Drive;
use lost::Lost;
use phases::{Phase, seconds};

/// The latest bearings that are kept: enough for a stop that is noticed after half a minute of one each second.
const RECENT: usize = 32;

/// Locates one source that may manoeuvre, by a locator `L` for a stationary one.
///
/// It takes 9.6 kB more than that: 17.7 kB around a [`Robust<256, 64>`](super::Robust).
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
    stationary: L,
    /// Of the bearings, as learned while it was stationary; all zero before.
    rates: Mixture,
    /// The explanation that it has moved.
    cloud: Cloud,
    /// Probability of the cloud's explanation.
    moved: f32,
    phase: Phase,
    /// The oldest first.
    recent: Deque<Observation, RECENT>,
    /// Fraction of the latest bearings that are outliers.
    misfit: f32,
    /// Bearings since the stationary locator started to look for where the source has stopped.
    tries: u32,
    lost: Lost,
    /// The latest credible fix.
    seen: Option<Fix>,
    bearings: u32,
    answer: Answer,
}

persist!(impl[L: Persist] Manoeuvring<L> as "Manoeuvring"() {
    stationary, rates, cloud, moved, phase, recent, misfit, tries, lost, seen, bearings, answer
});

impl<L: Stationary> Manoeuvring<L> {
    /// Takes one bearing. The stationary locator comes first: it may refuse it.
    fn take<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Config<L::Config>,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let elapsed_ms =
            (self.stationary.latest()).map_or(0, |latest| observation.since_ms(latest.time_ms()));
        let (place, had_fix) = (self.stationary.moments(), self.stationary.fix().is_some());
        self.stationary.push(observation, &config.track, rng)?;
        self.bearings = self.bearings.saturating_add(1);
        if elapsed_ms >= 0 {
            let errors = self.errors(config);
            let fresh = self.remember(observation, &errors);
            if had_fix || self.cloud.is_alive() {
                let drive = Drive::new(config, seconds(elapsed_ms));
                self.let_time_pass(&drive, &place, rng);
                self.weigh(&fresh, &place, &errors);
                self.search(&fresh, &drive, config, rng);
            }
        }
        self.update_phase(config);
        self.answer = self.conclude(config);
        if let Answer::Fix(fix) = self.answer
            && self.lost.bearings == 0
        {
            self.seen = Some(fix);
        }
        Ok(self.answer)
    }

    /// Keeps a bearing, and returns it with a sigma by which it counts for no more than it tells beside the earlier ones.
    fn remember(&mut self, observation: &Observation, errors: &Errors) -> Observation {
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
    fn latest_position(&self) -> [f32; 2] {
        (self.recent.back()).map_or([0.0; 2], Observation::position)
    }
}

#[cfg(test)]
mod tests;
