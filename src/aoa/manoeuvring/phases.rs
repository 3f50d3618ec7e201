//! When the source is said to move, to have stopped, and to be lost for good.

use super::config::Config;
use super::explanations::stationary_there;
use super::state::{Lost, Manoeuvring, Phase, seconds};
use crate::aoa::track::{Stationary, Track};
use crate::math::sqrt;

/// Probability of having moved from which on the answer says so: lower notices a departure sooner, with more false alarms.
const MOVED: f32 = 0.5;

/// Probability of having moved below which the answer takes it back: the gap to `MOVED` keeps answers from flickering.
const NOT_MOVED: f32 = 0.2;

/// Probability below which the explanation that the source is stationary is given up: lower keeps the locator longer from
/// looking for the next stop.
const GIVEN_UP: f32 = 1e-3;

/// Prior probability that a source has stopped where the stationary locator finds a place: higher reports stops sooner,
/// with more false ones.
const STOPPED: f32 = 0.005;

/// Probability of having stopped from which on the stationary locator takes the bearings since then: lower finds stops
/// with fewer new bearings, and takes more that are from before.
const PROBABLY_STOPPED: f32 = 0.3;

/// Bearings after which the stationary locator starts again if it has found no place: fewer drop bearings on a stop,
/// more keep those from before it.
const BEARINGS_TO_STOP: u32 = 30;

/// Bearings on a lost source after which everything starts again: fewer give up sources that would be found again.
const BEARINGS_TO_START_OVER: u32 = 40;

/// The latest bearings that everything starts again with: fewer take longer to a fix, more are from before the loss.
const BEARINGS_KEPT: usize = 12;

impl<L: Stationary> Manoeuvring<L> {
    /// Whether the explanation that the source is stationary has a probability.
    pub(super) fn may_be_stationary(&self) -> bool {
        self.phase != Phase::Moving
    }

    /// Goes from one phase to another.
    pub(super) fn update_phase(&mut self, config: &Config<L::Config>) {
        if self.lost.bearings > BEARINGS_TO_START_OVER {
            return self.start_over(config);
        }
        let has_fix = self.stationary.fix().is_some();
        if self.phase == Phase::Moving {
            self.tries += 1;
            if has_fix {
                self.phase = Phase::Departing;
                self.moved = 1.0 - STOPPED;
            } else if self.tries > BEARINGS_TO_STOP {
                self.look_for_a_stop(config);
            }
        }
        if !self.may_be_stationary() {
            return;
        }
        if has_fix && self.cloud.is_alive() {
            // Components that have stopped there are the same explanation.
            let place = stationary_there(&self.stationary.moments());
            self.moved *= 1.0 - self.cloud.remove(|component| component.is_at(&place));
        }
        if !self.cloud.is_alive() {
            self.moved = 0.0;
        }
        if 1.0 - self.moved < GIVEN_UP {
            self.phase = Phase::Moving;
            self.look_for_a_stop(config);
        } else if self.moved > MOVED {
            self.phase = Phase::Departing;
        } else if self.moved < NOT_MOVED {
            self.phase = Phase::Stationary;
            self.rates = self.stationary.errors(&config.track).rates;
        }
    }

    /// Restarts the stationary locator about where the source is now.
    fn look_for_a_stop(&mut self, config: &Config<L::Config>) {
        self.moved = 1.0;
        self.tries = 0;
        let (position, covariance) = self.cloud.position();
        let sigma = sqrt(covariance.largest_eigenvalue());
        let range_m = 3.0 * sigma + 10.0 * config.speed_m_s;
        let range_m = if range_m < 1e6 { range_m } else { 1e6 };
        let stopped = self.cloud.stopped();
        // Not those from before it stopped, as far as can be told; the latest in any case.
        let since = if stopped.probability < PROBABLY_STOPPED {
            0.0
        } else {
            stopped.seconds - sqrt(stopped.variance)
        };
        self.stationary.restart(self.errors(config).rates);
        if let Some(latest) = self.recent.back() {
            for old in &self.recent {
                let age = seconds(latest.since_ms(old.time_ms()));
                if age == 0.0 || age < since {
                    self.stationary.recall(old, &config.track);
                }
            }
        }
        self.stationary.centre_prior(position, range_m);
    }

    /// Starts again with the latest bearings alone.
    fn start_over(&mut self, config: &Config<L::Config>) {
        let rates = self.errors(config).rates;
        self.cloud.clear();
        self.moved = 0.0;
        self.phase = Phase::Stationary;
        self.misfit = 0.0;
        self.lost = Lost::NOT;
        self.seen = None;
        self.stationary.restart(rates);
        let skipped = self.recent.len().saturating_sub(BEARINGS_KEPT);
        for old in self.recent.iter().skip(skipped) {
            self.stationary.recall(old, &config.track);
        }
    }
}
