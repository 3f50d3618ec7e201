//! What a locator that is built round this one needs of it.

use super::RobustLocator;
use super::errors::{Errors, Shares, Tails};
use super::evidence::tempered;
use super::merge::{Sight, agree};
use super::term::{State, Term};
use crate::aoa::Observation;
use crate::math::{exp, ln, sqrt};

impl<const N: usize, const B: usize> RobustLocator<N, B> {
    pub(in crate::aoa) const fn errors(&self) -> &Errors {
        &self.errors
    }

    /// Mean and covariance of the place and of the bias in its prior deviations.
    pub(in crate::aoa) fn moments(&self) -> (State, [State; 3]) {
        (self.filter.mean(), self.filter.covariance())
    }

    /// Forgets all bearings but not the shares of `errors`.
    pub(in crate::aoa) fn restart(&mut self, errors: Errors) {
        self.reset();
        self.errors = errors;
    }

    /// The source is as likely within `range_m` of `centre` as not, whatever the bearings say. The first bearing says
    /// where, so this comes later.
    pub(in crate::aoa) fn believe(&mut self, centre: [f32; 2], range_m: f32) {
        self.evidence.centre_on(centre, range_m);
    }

    /// Takes a bearing of earlier, and does not look at what it says: the next one does.
    pub(in crate::aoa) fn recall(&mut self, observation: Observation, seconds: f32) {
        self.evidence.push(observation, seconds, None, &self.errors);
    }
}

impl super::Settings {
    pub(in crate::aoa) const fn relative_range_error(&self) -> f32 {
        self.common.relative_range_error
    }
}

impl Errors {
    pub(in crate::aoa) const fn shares_now(&self) -> Shares {
        self.shares
    }

    /// In radians.
    pub(in crate::aoa) const fn bias_scale(&self) -> f32 {
        self.bias_deviation
    }
}

/// Odds of a bearing not being wild, of a place and the bias in its prior deviations; `about` is where the source is, by
/// and large.
pub(in crate::aoa) fn odds(
    observation: &Observation,
    errors: &Errors,
    about: &State,
) -> impl Fn(&State) -> f32 {
    let variance = errors.variance(observation, 1.0, Some(about));
    let term = Term::new(observation, errors, variance);
    let scale = errors.bias_deviation;
    move |state| term.read(state, scale * state[2]).odds
}

/// A bearing that counts for no more than it tells beside earlier ones, which come with their ages in seconds.
pub(in crate::aoa) fn independent<'a>(
    observation: &Observation,
    earlier: impl Iterator<Item = (&'a Observation, f32)>,
    errors: &Errors,
) -> Observation {
    let [x, y] = observation.position();
    let new = Sight::new(*observation, 1.0);
    let mut least = f32::INFINITY;
    for (old, seconds) in earlier {
        let (dx, dy) = (old.position()[0] - x, old.position()[1] - y);
        let lengths = errors.correlation.lengths(sqrt(dx * dx + dy * dy), seconds);
        if lengths < least && agree(&Sight::new(*old, 1.0), &new, None, errors) {
            least = lengths;
        }
    }
    tempered(*observation, errors.correlation.worth(least))
}

/// The line of a bearing, as it is seen from a state.
pub(in crate::aoa) struct Line {
    pub(in crate::aoa) error: LineError,
    /// Derivatives of the error by the place and by the bias in its prior deviations.
    pub(in crate::aoa) gradient: State,
}

/// How far off a bearing is, in radians.
pub(in crate::aoa) struct LineError {
    pub(in crate::aoa) angle: f32,
    /// Variance that it has on its own.
    pub(in crate::aoa) variance: f32,
    pub(in crate::aoa) mirrored: bool,
}

impl LineError {
    /// Odds of not being wild of an error of `angle`, if errors have this variance.
    pub(in crate::aoa) fn odds(&self, angle: f32, variance: f32, errors: &Errors) -> f32 {
        let Shares {
            direct,
            mirror,
            wild,
        } = errors.shares;
        let share = if self.mirrored { mirror } else { direct };
        let peak = errors.tails.height() / (sqrt(variance) * wild);
        let square = angle * angle / variance;
        share
            * peak
            * match errors.tails {
                Tails::Normal => exp(-0.5 * square),
                Tails::Student { freedom } => {
                    let freedom = f32::from(freedom);
                    exp(-0.5 * (freedom + 1.0) * ln(1.0 + square / freedom))
                }
            }
    }
}

pub(in crate::aoa) fn read(observation: &Observation, errors: &Errors, state: &State) -> Line {
    let variance = errors.variance(observation, 1.0, Some(state));
    let term = Term::new(observation, errors, variance);
    let reading = term.read(state, errors.bias_deviation * state[2]);
    let [x, y] = term.gradient(state);
    Line {
        error: LineError {
            angle: reading.error,
            variance,
            mirrored: reading.mirrored,
        },
        gradient: [x, y, errors.bias_deviation],
    }
}
