//! How one bearing looks to a locator that is built round this one.

use super::errors::{Errors, Tails};
use super::evidence::{Lines, tempered};
use super::term::{State, Term};
use crate::aoa::core::{Comparison, Entry};
use crate::aoa::{Mixture, Observation};
use crate::math::{exp, ln, sqrt};

/// A bearing that counts for no more than it tells beside earlier ones, which come with their ages in seconds.
pub(in crate::aoa) fn independent<'a>(
    observation: &Observation,
    earlier: impl Iterator<Item = (&'a Observation, f32)>,
    errors: &Errors,
) -> Observation {
    let [x, y] = observation.position();
    let new = Entry::new(*observation, 1.0);
    let lines = Lines {
        source: None,
        errors,
    };
    let mut least = f32::INFINITY;
    for (old, seconds) in earlier {
        let (dx, dy) = (old.position()[0] - x, old.position()[1] - y);
        let lengths = errors.correlation.lengths(sqrt(dx * dx + dy * dy), seconds);
        if lengths < least && lines.is_similar(&Entry::new(*old, 1.0), &new) {
            least = lengths;
        }
    }
    tempered(*observation, errors.correlation.worth(least))
}

/// The line of a bearing, as it is seen from a state.
pub(in crate::aoa) struct Line {
    pub(in crate::aoa) error: LineError,
    /// Derivatives of the error by the place and by the bias in its prior sigmas.
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
    /// Odds of not being an outlier of an error of `angle`, if errors have this variance.
    pub(in crate::aoa) fn odds(&self, angle: f32, variance: f32, errors: &Errors) -> f32 {
        let Mixture {
            direct,
            mirrored,
            outlier,
        } = errors.rates;
        let rate = if self.mirrored { mirrored } else { direct };
        let peak = errors.tails.height() / (sqrt(variance) * outlier);
        let square = angle * angle / variance;
        rate * peak
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
    let variance = errors.variance(observation, 1.0, Some([state[0], state[1]]));
    let term = Term::new(observation, errors, variance);
    let reading = term.read(state, errors.bias_sigma_rad * state[2]);
    let [x, y] = term.gradient(state);
    Line {
        error: LineError {
            angle: reading.error,
            variance,
            mirrored: reading.mirrored,
        },
        gradient: [x, y, errors.bias_sigma_rad],
    }
}
