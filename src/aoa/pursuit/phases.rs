//! When the source is said to move, to have stopped, and to be lost for good.

use super::Pursuit;
use super::component::matrix;
use super::recent::Old;
use crate::aoa::locator::Answer;
use crate::estimate::largest_variance;
use crate::math::sqrt;

/// What the answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// The locator's: where the source is parked, or that this is not known yet.
    Parked,
    /// The mean of both explanations.
    Departing,
    /// The cloud's. The locator looks for a place where the source may have stopped since it was started.
    Driving,
}

/// How likely it must be that the source has moved for the answer to say so, and how unlikely to take it back.
const MOVED: f32 = 0.5;
const NOT_MOVED: f32 = 0.2;
/// The locator's explanation is given up below this probability.
const GIVEN_UP: f32 = 1e-3;
/// Probability that a source has stopped where the locator has found a place.
const STOPPED: f32 = 0.005;
/// Share of what is at rest from which on the locator takes the bearings since.
const PROBABLY_STOPPED: f32 = 0.3;
/// Without one the locator starts afresh after so many bearings.
const TRIED: u32 = 30;
/// So many bearings after it was lost, everything starts again.
const PATIENCE: u32 = 40;
/// With so many of the latest bearings.
const RECALLED: usize = 12;

impl<const N: usize, const B: usize> Pursuit<N, B> {
    pub(super) fn forget(&mut self) {
        self.cloud.clear();
        self.parked = 1.0;
        self.phase = Phase::Parked;
        self.fitted = 1.0;
        self.lost = None;
    }

    /// Whether the locator's explanation has a probability.
    pub(super) fn may_be_parked(&self) -> bool {
        matches!(self.phase, Phase::Parked | Phase::Departing)
    }

    /// Goes from one phase to another.
    pub(super) fn decide(&mut self) {
        if self.lost.is_some_and(|lost| lost.bearings > PATIENCE) {
            return self.start_again();
        }
        let has_fix = matches!(self.locator.answer(), Answer::Fix(_));
        if self.phase == Phase::Driving {
            self.tried += 1;
            if has_fix {
                self.phase = Phase::Departing;
                self.parked = STOPPED;
            } else if self.tried > TRIED {
                self.look_for_a_stop();
            }
        }
        if !self.may_be_parked() {
            return;
        }
        if has_fix && self.cloud.is_alive() {
            // What has stopped there is the same explanation.
            let place = self.parked_there();
            let share = self.cloud.give_up(|component| component.is_at(&place));
            self.parked += share * (1.0 - self.parked);
        }
        if !self.cloud.is_alive() {
            self.parked = 1.0;
        }
        let moved = 1.0 - self.parked;
        if self.parked < GIVEN_UP {
            self.phase = Phase::Driving;
            self.look_for_a_stop();
        } else if moved > MOVED {
            self.phase = Phase::Departing;
        } else if moved < NOT_MOVED {
            self.phase = Phase::Parked;
            self.errors = *self.locator.errors();
        }
    }

    /// Starts the locator afresh, about where the source is now.
    fn look_for_a_stop(&mut self) {
        self.parked = 0.0;
        self.tried = 0;
        let (place, spread) = self.cloud.place();
        let spread = sqrt(largest_variance(&matrix(spread)));
        let range_m = 3.0 * spread + 10.0 * self.settings.habits.speed;
        let range_m = if range_m < 1e6 { range_m } else { 1e6 };
        let at_rest = self.cloud.at_rest();
        // Not those from before it stopped, as far as can be told; the latest in any case.
        let since = if at_rest.share < PROBABLY_STOPPED {
            0.0
        } else {
            at_rest.seconds - sqrt(at_rest.variance)
        };
        self.locator.restart(self.errors);
        let later = |old: &&Old| old.age_s == 0.0 || old.age_s < since;
        for old in self.recent.iter().filter(later) {
            self.locator.recall(old.observation, old.seconds);
        }
        self.locator.believe(place, range_m);
    }

    /// With the latest bearings alone.
    fn start_again(&mut self) {
        self.forget();
        self.seen = None;
        self.locator.restart(self.errors);
        let skipped = self.recent.iter().count().saturating_sub(RECALLED);
        for Old {
            observation,
            seconds,
            ..
        } in self.recent.iter().skip(skipped)
        {
            self.locator.recall(*observation, *seconds);
        }
    }
}
