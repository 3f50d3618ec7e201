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
//! Fixed stations that surround a source are another matter: [`Manoeuvring<L, K>`](Manoeuvring) knows the biases of `K` of them
//! in every normal distribution, jointly with the place, and learns them while the source moves. From the first fix on its cloud
//! is the only explanation, of a source at rest, too.
//!
//! Bearings alone say little of how far away a moving source is: its fix is as wide as it must be, and none if that is too
//! wide. Of simulated chases by a vehicle of 10 to 15 m/s, with bearings of 2 to 3 degrees every second, one in ten an
//! outlier, the ellipses of 95 % hold a stationary source in 95 %, a moving one in 94 %, and in 60 % during the first 15 s
//! after a departure, because the departure is not yet noticed. The median delay is 4 s for a departure and 32 s for a stop
//! and its place.
//!
//! Time is what tells a stationary source from a moving one: where all bearings have the same time, nothing ever moves. A
//! bearing that is older than the latest goes to the stationary explanation only, for as long as that takes it.

mod biases;
mod branches;
mod component;
mod conclusions;
mod config;
mod drive;
mod explanations;
mod moved;
mod stations;
mod track;

use heapless::Deque;

use super::core::square_of_distance;
use super::robust::outside::independent;
use super::robust::{Errors, Learned};
use super::track::{Reading, Stationary, Track, reading_of};
use super::words::Belief;
use super::{
    Advice, Alternative, Answer, Bias, Fix, Hypothesis, Locate, Mixture, Observation, PushError,
    Retract, Retracted, SigmaScale, Source,
};
use crate::ConfigError;
use crate::math::sqrt;
use crate::persist;
use crate::random::Rng;
use crate::snapshot::{Persist, by_value, value, value_as};
pub use config::Config;
pub(super) use config::check_around;
use drive::Drive;
use moved::Moved;

/// The latest bearings that are kept: enough for a stop that is noticed after half a minute of one each second.
const RECENT: usize = 32;

/// Bearings over which the fraction of outliers is counted: fewer notice a loss sooner, and mistake more rows of outliers
/// for a loss.
const MEMORY: f32 = 8.0;

/// The explanation that gives the answer.
///
/// | from | to | when |
/// |---|---|---|
/// | `Stationary` | `Departing` | `moved` > `MOVED` |
/// | `Departing` | `Stationary` | `moved` < `NOT_MOVED` |
/// | `Stationary`, `Departing` | `Moving` | 1 - `moved` < `GIVEN_UP` |
/// | `Moving` | `Departing` | the stationary locator has found a place |
/// | any | `Stationary` | the source has been lost for more than `BEARINGS_TO_START_OVER` bearings |
///
/// `Moving` implies that the cloud is alive, which [`Manoeuvring::weigh`] needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// The stationary locator's: where the source is, or that this is not known yet.
    Stationary,
    /// The mean of both explanations.
    Departing,
    /// The cloud's. The stationary locator looks for a place where the source may have stopped.
    Moving,
}

/// Time for which the source has been lost. It is not lost if there are no bearings.
#[derive(Debug, Clone, Copy)]
struct Lost {
    seconds: f32,
    bearings: u32,
}

value!(Lost { seconds, bearings });

impl Lost {
    const NO: Self = Self {
        seconds: 0.0,
        bearings: 0,
    };
}

/// Seconds of so many milliseconds.
fn seconds(milliseconds: i32) -> f32 {
    milliseconds as f32 / 1000.0
}

/// Locates one source that may manoeuvre, by a locator `L` for a stationary one; with `K` fixed stations, each of which has a
/// bias of its own, of the standard deviation [`stop_sigma_rad`](Errors::stop_sigma_rad), or with none.
///
/// `N` is the number of normal distributions that follow the source once it has moved. Each takes 68 bytes, with four stations
/// 212, and every bearing then takes time in proportion to `N`. The 128 of the default are enough for a vehicle. Among stations,
/// a computer may take 1,024, as in `Manoeuvring<Robust<256>, 4, 1024>`: errors are 2 % less, for eight times the memory and the
/// time. A chip that is short of either may take 64: errors are 1 % more.
///
/// With 128 and no station, it takes 9.6 kB more than that: 19.6 kB around a [`Robust<256, 64>`](crate::aoa::Robust).
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
pub struct Manoeuvring<L, const K: usize = 0, const N: usize = 128> {
    /// The explanation that it is stationary, if it has a fix.
    stationary: L,
    /// What was learned of the errors of bearings while the source was stationary.
    learned: Learned,
    /// The explanation that it has moved.
    cloud: Moved<K, N>,
    /// Probability of the cloud's explanation.
    moved: f32,
    phase: Phase,
    /// The oldest first.
    recent: Deque<Observation, RECENT>,
    /// Fraction of the latest bearings that are outliers.
    outlier_fraction: f32,
    /// Bearings since the stationary locator started to look for where the source has stopped.
    tries: u32,
    lost: Lost,
    /// The latest credible fix.
    seen: Option<Fix>,
    bearings: u32,
    answer: Answer,
}

persist!(impl[L: Persist, const K: usize, const N: usize] Manoeuvring<L, K, N> as "Manoeuvring"(K) {
    stationary, learned, cloud, moved, phase, recent, outlier_fraction, tries, lost, seen, bearings, answer
});

impl<L: Stationary, const K: usize, const N: usize> Locate for Manoeuvring<L, K, N> {
    type Config = Config<L::Config>;

    const ALTERNATIVES: bool = L::ALTERNATIVES;

    const EMPTY: Self = Self {
        stationary: L::EMPTY,
        learned: Learned::NOTHING,
        cloud: Moved::EMPTY,
        moved: 0.0,
        phase: Phase::Stationary,
        recent: Deque::new(),
        outlier_fraction: 0.0,
        tries: 0,
        lost: Lost::NO,
        seen: None,
        bearings: 0,
        answer: Answer::NOTHING,
    };

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(&config.stationary)?;
        config.check_own()
    }

    /// Costs a push of the stationary locator and a step of a Kalman filter of each of `N` normal distributions; among stations,
    /// once, 2 `K` steps of each when they start, and then one without the push. The stationary locator comes first: it may
    /// refuse the bearing.
    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.push_alternatives(&[(*observation).into()], config, rng)
    }

    /// Takes up to four of the bearings: those after them are left out while the source moves.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let best = Alternative::most_probable(alternatives).ok_or(PushError::Empty)?;
        if K > 0 && self.cloud.is_alive() {
            self.follow(best, alternatives, config, rng)?;
            self.bearings = self.bearings.saturating_add(1);
        } else {
            self.weigh_explanations(best, alternatives, config, rng)?;
        }
        self.answer = self.conclude(config);
        if let Answer::Fix(fix) = self.answer
            && self.lost.bearings == 0
        {
            self.seen = Some(fix);
        }
        Ok(self.answer)
    }

    /// Of a stationary source; of one that has departed nothing can be taken back.
    fn retract<R: Rng + ?Sized>(
        &mut self,
        what: &Retract,
        config: &Self::Config,
        rng: &mut R,
    ) -> Retracted {
        if self.phase != Phase::Stationary {
            return Retracted::NOTHING;
        }
        let retracted = self.stationary.retract(what, &config.stationary, rng);
        self.answer = self.conclude(config);
        retracted
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {
        self.stationary.reset();
        self.learned = Learned::NOTHING;
        self.cloud.clear();
        self.moved = 0.0;
        self.phase = Phase::Stationary;
        self.recent.clear();
        (self.outlier_fraction, self.tries, self.lost, self.seen) = (0.0, 0, Lost::NO, None);
        (self.bearings, self.answer) = (0, Answer::NOTHING);
    }

    fn source(&self, index: usize) -> Option<Source> {
        let fix = self.answer.fix().filter(|_| index == 0)?;
        Some(Source {
            identity: 0,
            probability: 1.0,
            fix,
            motion: self.motion(),
        })
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        if self.phase == Phase::Stationary {
            self.stationary.hypothesis(index)
        } else {
            self.hypotheses().nth(index)
        }
    }

    fn bias(&self, config: &Self::Config) -> Option<Bias> {
        self.answer.fix()?;
        if self.phase == Phase::Stationary {
            return self.stationary.bias(&config.stationary);
        }
        if let Some(bias) = (self.recent.back()).and_then(|latest| self.cloud.bias_of(latest)) {
            return Some(bias);
        }
        let (bias, scale) = (self.cloud.bias, self.errors(config).bias_sigma_rad);
        Some(Bias {
            mean_rad: scale * bias.mean,
            sigma_rad: scale * sqrt(bias.variance),
        })
    }

    fn rates(&self, config: &Self::Config) -> Option<Mixture> {
        Some(self.errors(config).rates)
    }

    fn sigma_scale(&self, config: &Self::Config) -> Option<SigmaScale> {
        let known = self.stationary.sigma_scale(&config.stationary)?;
        Some(if self.learned.sigma_scale.mean > 0.0 {
            self.learned.sigma_scale
        } else {
            known
        })
    }

    fn advice(&self, config: &Self::Config) -> Option<Advice> {
        if self.phase == Phase::Stationary {
            return self.stationary.advice(&config.stationary);
        }
        let latest = self.recent.back()?;
        Belief::of_hypotheses(
            self.hypotheses(),
            latest,
            L::beliefs(&config.stationary).range_m,
        )
        .advice(latest, self.answer.missing_angle())
    }

    fn classify(&self, observation: &Observation, config: &Self::Config) -> Option<Mixture> {
        let stationary = |track: &L| track.classify(observation, &config.stationary);
        if self.phase == Phase::Stationary {
            return stationary(&self.stationary);
        }
        self.answer.fix()?;
        let errors = self.errors_beside_biases(config);
        let mut mixture = self.cloud.classify(observation, &errors);
        if self.phase == Phase::Departing
            && let Some(other) = stationary(&self.stationary)
        {
            let p = 1.0 - self.moved;
            mixture.direct += p * (other.direct - mixture.direct);
            mixture.mirrored += p * (other.mirrored - mixture.mirrored);
            mixture.outlier += p * (other.outlier - mixture.outlier);
        }
        Some(mixture)
    }

    /// The particles while the source is stationary. A moving source has none, but its [`hypothesis`](Locate::hypothesis)
    /// is that of the fix.
    fn cloud(&self, index: usize) -> Option<crate::aoa::Cloud<'_>> {
        if self.phase == Phase::Stationary {
            self.stationary.cloud(index)
        } else {
            None
        }
    }
}

impl<L: Stationary, const K: usize, const N: usize> Manoeuvring<L, K, N> {
    /// Takes the bearings of a reading into both explanations.
    fn weigh_explanations<R: Rng + ?Sized>(
        &mut self,
        best: &Observation,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
        rng: &mut R,
    ) -> Result<(), PushError> {
        let elapsed_ms =
            (self.stationary.latest()).map_or(0, |latest| best.since_ms(latest.time_ms()));
        let (place, had_fix) = (self.stationary.moments(), self.stationary.fix().is_some());
        (self.stationary).push_alternatives(alternatives, &config.stationary, rng)?;
        self.bearings = self.bearings.saturating_add(1);
        if elapsed_ms >= 0 {
            let errors = self.errors(config);
            let fresh = self.remember(best, alternatives, &errors);
            if K > 0 {
                if self.may_follow() {
                    self.start_to_follow(config, rng);
                }
            } else if had_fix || self.cloud.is_alive() {
                let drive = Drive::new(config, seconds(elapsed_ms));
                self.let_time_pass(&drive, &place, rng);
                self.weigh(&fresh, &place, &errors);
                self.search(best, &drive, config, rng);
            }
        }
        if K == 0 {
            self.update_phase(config);
        }
        Ok(())
    }

    /// Keeps the most probable bearing, and returns all with sigmas by which they count for no more than they tell beside the
    /// earlier ones.
    fn remember(
        &mut self,
        best: &Observation,
        alternatives: &[Alternative],
        errors: &Errors,
    ) -> Reading {
        let range_m = (self.answer.fix()).map_or(0.0, |fix| {
            sqrt(square_of_distance(fix.position, best.position()))
        });
        let fresh = reading_of(alternatives, |alternative| {
            let one = alternative.observation();
            let earlier =
                (self.recent.iter()).map(|old| (old, seconds(one.since_ms(old.time_ms()))));
            alternative.with_observation(independent(one, earlier, errors, range_m))
        });
        self.keep(best);
        fresh
    }

    fn keep(&mut self, observation: &Observation) {
        if self.recent.is_full() {
            self.recent.pop_front();
        }
        let _ = self.recent.push_back(*observation);
    }

    /// Where the latest bearing was taken.
    fn latest_position(&self) -> [f32; 2] {
        (self.recent.back()).map_or([0.0; 2], Observation::position)
    }
}

value_as!(Phase as u8:
    |phase| *phase as u8,
    |code| [Self::Stationary, Self::Departing, Self::Moving].get(usize::from(code)).copied(),
);

by_value!(Phase);

#[cfg(test)]
mod tests;
