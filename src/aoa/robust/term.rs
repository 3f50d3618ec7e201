//! The likelihood of one bearing that may be direct, mirrored or an outlier, with the common bias.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use super::errors::Errors;
use crate::aoa::core::{BLOCK, Block, Entry};
use crate::aoa::{Mixture, Observation};
use crate::math::{atan_coarse, exp_of_weight, ln, sin_cos, sqrt, wrap};

/// Metres east and north, and the bias of all bearings in its prior sigmas.
pub(super) type State = [f32; 3];

/// Odds of a bearing not being an outlier, which are its likelihood but for a factor and a summand that no place changes:
/// that is `outlier / (2 pi) (1 + odds)`.
///
/// The direct and the mirrored peak are half a circle apart, so only the nearer counts: the bearing is a line, on either
/// side of which another rate applies, and the odds are one exponential.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    position: [f32; 2],
    sin: f32,
    cos: f32,
    /// -1 / (2 sigma^2).
    curvature: f32,
    /// Logarithm of the odds of no error, in front of the receiver and behind it.
    direct: f32,
    mirrored: f32,
}

/// Keeps the ratio finite for a particle that sits on the receiver.
const TINY_M: f32 = 1e-7;

/// What one bearing says of a state.
pub(super) struct Reading {
    /// Expected less measured direction of the line, bias included, in radians.
    pub(super) error: f32,
    pub(super) mirrored: bool,
    pub(super) odds: f32,
    /// What it counts for, beside others, in 1 / rad^2: 1 / sigma^2 if it is sure not to be an outlier.
    pub(super) information: f32,
}

impl Reading {
    /// Counts the bearing by what it probably is; returns the part of the weight that is no outlier.
    pub(super) fn count(&self, counts: &mut Mixture, weight: f32) -> f32 {
        let fitted = weight * self.odds / (1.0 + self.odds);
        counts.outlier += weight - fitted;
        if self.mirrored {
            counts.mirrored += fitted;
        } else {
            counts.direct += fitted;
        }
        fitted
    }
}

impl Term {
    /// Of an error with this variance, in square radians.
    pub(super) fn new(observation: &Observation, errors: &Errors, variance: f32) -> Self {
        let (sin, cos) = sin_cos(observation.bearing().radians());
        let rates = errors.rates;
        let peak = sqrt(TAU) / (sqrt(variance) * rates.outlier);
        Self {
            position: observation.position(),
            sin,
            cos,
            curvature: -0.5 / variance,
            direct: ln(peak * rates.direct),
            mirrored: ln(peak * rates.mirrored),
        }
    }

    /// Of a bearing in the buffer, on a source thought to be at a place.
    pub(super) fn of(entry: &Entry, errors: &Errors, source: Option<[f32; 2]>) -> Self {
        let variance = errors.variance(&entry.observation, entry.worth, source);
        Self::new(&entry.observation, errors, variance).with_probability(entry.probability)
    }

    /// The same of a bearing that has alternatives: of those that lie apart, 1 + a + b is nearly (1 + a) (1 + b).
    pub(super) fn with_probability(mut self, probability: f32) -> Self {
        if probability < 1.0 {
            let log = ln(probability);
            self.direct += log;
            self.mirrored += log;
        }
        self
    }

    /// Error of the line and which of its sides the state is on, given its bias in radians. Exact up to half a turn,
    /// beyond which a large bias may push an error: the line's other side is as far then.
    #[inline(always)]
    fn fold(&self, [x, y]: [f32; 2], bias: f32) -> (f32, bool) {
        let (dx, dy) = (x - self.position[0], y - self.position[1]);
        let along = dx * self.cos + dy * self.sin;
        let across = dy * self.cos - dx * self.sin;
        let (a, b) = (along.abs() + TINY_M, across.abs());
        let angle = FRAC_PI_4 + atan_coarse((b - a) / (b + a));
        let sign = (along.to_bits() ^ across.to_bits()) & 0x8000_0000;
        let error = f32::from_bits(angle.to_bits() ^ sign) + bias;
        (error, along < 0.0)
    }

    #[inline(always)]
    fn odds(&self, error: f32, mirrored: bool) -> f32 {
        let level = if mirrored { self.mirrored } else { self.direct };
        // At most some 1e7, for sigmas and rates of a thousandth; next to none are none.
        exp_of_weight(level + self.curvature * (error * error))
    }

    /// Multiplies each product by one plus the odds at a state.
    #[inline(always)]
    pub(super) fn multiply(
        &self,
        [x, y, _]: &Block<3>,
        biases: &[f32; BLOCK],
        products: &mut [f32; BLOCK],
    ) {
        for (product, ((x, y), bias)) in products.iter_mut().zip(x.iter().zip(y).zip(biases)) {
            let (error, mirrored) = self.fold([*x, *y], *bias);
            *product *= 1.0 + self.odds(error, mirrored);
        }
    }

    /// Up to a constant.
    #[inline(never)]
    pub(super) fn log_likelihood(&self, &[x, y, _]: &State, bias: f32) -> f32 {
        let (error, mirrored) = self.fold([x, y], bias);
        ln(1.0 + self.reading(error, mirrored).odds)
    }

    #[inline(never)]
    pub(super) fn read(&self, &[x, y, _]: &State, bias: f32) -> Reading {
        let (error, mirrored) = self.fold([x, y], bias);
        self.reading(error, mirrored)
    }

    /// For a source so far away that its direction is the same from everywhere.
    pub(super) fn read_far(&self, bearing: f32, direction: f32) -> Reading {
        let turn = wrap(direction - bearing);
        self.reading(fold_angle(turn), turn.abs() > FRAC_PI_2)
    }

    #[inline(never)]
    fn reading(&self, error: f32, mirrored: bool) -> Reading {
        let odds = self.odds(error, mirrored);
        Reading {
            error,
            mirrored,
            odds,
            information: -2.0 * self.curvature * odds / (1.0 + odds),
        }
    }

    /// Derivative of the error by the position, in radians a metre.
    pub(super) fn gradient(&self, &[x, y, _]: &State) -> [f32; 2] {
        /// Closer to the receiver, in square metres, the direction turns with every step.
        const NEAREST: f32 = 1e-6;
        let (dx, dy) = (x - self.position[0], y - self.position[1]);
        let square = dx * dx + dy * dy + NEAREST;
        [-dy / square, dx / square]
    }
}

/// The direction of a line, in (-pi/2, pi/2], from any angle within a circle.
pub(super) fn fold_angle(angle: f32) -> f32 {
    if angle > FRAC_PI_2 {
        angle - PI
    } else if angle <= -FRAC_PI_2 {
        angle + PI
    } else {
        angle
    }
}
