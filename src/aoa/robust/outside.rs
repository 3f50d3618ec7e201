//! How one bearing looks to a locator that is built round this one.

use core::f32::consts::TAU;

use super::errors::Errors;
use super::evidence::Lines;
use super::term::{PLAIN, Term};
use crate::aoa::core::{Comparison, Entry, square_of_distance};
use crate::aoa::{Mixture, Observation};
use crate::math::{exp, smaller, sqrt};

/// A bearing that counts for no more than it tells beside earlier ones, which come with their ages in seconds, on a source at
/// a range.
pub(in crate::aoa) fn independent<'a>(
    observation: &Observation,
    earlier: impl Iterator<Item = (&'a Observation, f32)>,
    errors: &Errors,
    range_m: f32,
) -> Observation {
    let new = Entry::new(*observation, 1.0);
    let lines = Lines {
        source: None,
        extent_m: 0.0,
        errors: *errors,
        of_several: false,
    };
    let mut least = f32::INFINITY;
    for (old, seconds) in earlier {
        let distance = sqrt(square_of_distance(old.position(), new.position()));
        let lengths =
            distance / errors.correlation.length_m(range_m) + seconds / errors.correlation.time_s;
        if lengths < least && lines.is_similar(&Entry::new(*old, 1.0), &new) {
            least = lengths;
        }
    }
    tempered(*observation, errors.correlation.worth(least))
}

/// A bearing that comes `seconds` after the latest of its place, with the sigma of all of its error on a source thought to be
/// at a place: so large that it counts for no more than it tells beside that one.
pub(in crate::aoa) fn successive(
    observation: &Observation,
    seconds: f32,
    errors: &Errors,
    source: [f32; 2],
) -> Observation {
    let sigma = sqrt(errors.variance(observation, Some(source)));
    let worth = errors
        .correlation
        .worth(seconds / errors.correlation.time_s);
    tempered(within(*observation, sigma), worth)
}

/// The line of a bearing, as it is seen from a state.
pub(in crate::aoa) struct Line {
    /// How far off the bearing is, in radians.
    pub(in crate::aoa) error: f32,
    /// Variance that the error has on its own.
    pub(in crate::aoa) variance: f32,
    pub(in crate::aoa) mirrored: bool,
    /// Derivatives of the error by the place and by the bias in its prior sigmas.
    pub(in crate::aoa) gradient: [f32; 3],
}

impl Line {
    /// The variance of the error if place and bias have this covariance.
    pub(in crate::aoa) fn variance_with(&self, covariance: &[[f32; 3]; 3]) -> f32 {
        let mut variance = self.variance;
        for (row, a) in covariance.iter().zip(&self.gradient) {
            for (entry, b) in row.iter().zip(&self.gradient) {
                variance += a * b * entry;
            }
        }
        variance
    }

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

/// The line of a bearing seen from a place, with a common bias in its prior sigmas.
pub(in crate::aoa) fn read(
    observation: &Observation,
    errors: &Errors,
    &[x, y, bias]: &[f32; 3],
) -> Line {
    let variance = errors.variance(observation, Some([x, y]));
    let term = Term::<PLAIN>::new(observation, &errors.rates, variance);
    let state = [x, y, 0.0, 0.0];
    let line = term.line(&state);
    let [gx, gy] = term.gradient(&state);
    Line {
        error: line.error + errors.bias_sigma_rad * bias,
        variance,
        mirrored: line.mirrored,
        gradient: [gx, gy, errors.bias_sigma_rad],
    }
}

/// A bearing that counts for `worth` of its information.
fn tempered(observation: Observation, worth: f32) -> Observation {
    within(observation, observation.sigma_rad() / sqrt(worth))
}

/// A bearing of that sigma, if that is none too large.
fn within(observation: Observation, sigma: f32) -> Observation {
    let most = Observation::MAX_SIGMA_RAD;
    observation.with_sigma(smaller(sigma, most))
}
