//! How one bearing looks to a locator that is built round this one.

use core::f32::consts::TAU;

use super::errors::Errors;
use super::evidence::{Lines, tempered};
use super::term::{State, Term};
use crate::aoa::core::{Comparison, Entry, square_of_distance};
use crate::aoa::{Mixture, Observation};
use crate::math::{exp, sqrt};

/// A bearing that counts for no more than it tells beside earlier ones, which come with their ages in seconds.
pub(in crate::aoa) fn independent<'a>(
    observation: &Observation,
    earlier: impl Iterator<Item = (&'a Observation, f32)>,
    errors: &Errors,
) -> Observation {
    let new = Entry::new(*observation, 1.0);
    let lines = Lines {
        source: None,
        errors,
    };
    let mut least = f32::INFINITY;
    for (old, seconds) in earlier {
        let distance = sqrt(square_of_distance(old.position(), new.position()));
        let lengths = errors.correlation.lengths(distance, seconds);
        if lengths < least && lines.is_similar(&Entry::new(*old, 1.0), &new) {
            least = lengths;
        }
    }
    tempered(*observation, errors.correlation.worth(least))
}

/// The line of a bearing, as it is seen from a state.
pub(in crate::aoa) struct Line {
    /// How far off the bearing is, in radians.
    pub(in crate::aoa) error: f32,
    /// Variance that the error has on its own.
    pub(in crate::aoa) variance: f32,
    pub(in crate::aoa) mirrored: bool,
    /// Derivatives of the error by the place and by the bias in its prior sigmas.
    pub(in crate::aoa) gradient: State,
}

impl Line {
    /// Odds of not being an outlier if it is off by `error` and such errors have this variance.
    pub(in crate::aoa) fn odds(&self, error: f32, variance: f32, errors: &Errors) -> f32 {
        let Mixture {
            direct,
            mirrored,
            outlier,
        } = errors.rates;
        let rate = if self.mirrored { mirrored } else { direct };
        let peak = sqrt(TAU) / (sqrt(variance) * outlier);
        rate * peak * exp(-0.5 * (error * error / variance))
    }
}

pub(in crate::aoa) fn read(observation: &Observation, errors: &Errors, state: &State) -> Line {
    let variance = errors.variance(observation, 1.0, Some([state[0], state[1]]));
    let term = Term::new(observation, errors, variance);
    let reading = term.read(state, errors.bias_sigma_rad * state[2]);
    let [x, y] = term.gradient(state);
    Line {
        error: reading.error,
        variance,
        mirrored: reading.mirrored,
        gradient: [x, y, errors.bias_sigma_rad],
    }
}
