//! What sources have in common that are heard by one array: the scale of its errors, and its bias.

use super::term::{BIASES, SCALE, State};
use crate::math::sqrt;
use crate::snapshot::value;

/// What other sources' bearings say of the scale of the errors and of the bias, in prior sigmas. All bits are zero where they
/// say nothing.
#[derive(Debug, Clone, Copy)]
pub struct Shared {
    scale: Normal,
    bias: Normal,
}

/// A normal likelihood of one number: its precision, and its mean times that.
#[derive(Debug, Clone, Copy)]
struct Normal {
    sum: f32,
    precision: f32,
}

value!(Shared { scale, bias });
value!(Normal { sum, precision });

impl Normal {
    const NOTHING: Self = Self {
        sum: 0.0,
        precision: 0.0,
    };

    /// What has been said beside others and a prior that draws to zero, if all together make this mean and variance.
    fn of(mean: f32, variance: f32, others: &Self, prior_precision: f32) -> Self {
        let precision = 1.0 / variance - prior_precision - others.precision;
        if precision > 0.0 && precision.is_finite() {
            Self {
                sum: mean / variance - others.sum,
                precision,
            }
        } else {
            Self::NOTHING
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            precision: self.precision + other.precision,
        }
    }

    fn log_likelihood(self, z: f32) -> f32 {
        z * (self.sum - 0.5 * self.precision * z)
    }
}

impl Shared {
    pub(in crate::aoa) const NOTHING: Self = Self {
        scale: Normal::NOTHING,
        bias: Normal::NOTHING,
    };

    /// What the bearings of one source have said, if states have this mean and covariance with what those of others say.
    pub(super) fn of<const D: usize>(
        mean: &State<D>,
        covariance: &[State<D>; D],
        others: &Self,
    ) -> Self {
        // A normal density of this precision draws as strongly to zero as the prior of the scale does there.
        let hyperbolic = 1.0 / sqrt(1.0 + mean[SCALE] * mean[SCALE]);
        let [scale, bias] = [covariance[SCALE][SCALE], covariance[BIASES][BIASES]];
        Self {
            scale: Normal::of(mean[SCALE], scale, &others.scale, hyperbolic),
            bias: Normal::of(mean[BIASES], bias, &others.bias, 1.0),
        }
    }

    /// What several sources' bearings say together.
    pub(in crate::aoa) fn together(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::NOTHING, |sum, one| sum.plus(&one))
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            scale: self.scale.plus(other.scale),
            bias: self.bias.plus(other.bias),
        }
    }

    /// Of a state, up to a constant.
    pub(super) fn log_likelihood<const D: usize>(&self, state: &State<D>) -> f32 {
        self.scale.log_likelihood(state[SCALE]) + self.bias.log_likelihood(state[BIASES])
    }

    /// Adds its gradient and its information.
    pub(super) fn add<const D: usize>(
        &self,
        state: &State<D>,
        gradient: &mut State<D>,
        information: &mut State<D>,
    ) {
        let Self { scale, bias } = self;
        gradient[SCALE] += scale.sum - scale.precision * state[SCALE];
        gradient[BIASES] += bias.sum - bias.precision * state[BIASES];
        information[SCALE] += scale.precision;
        information[BIASES] += bias.precision;
    }
}
