//! What sources have in common that are heard by one array: the scale of its errors, and its bias.

use super::term::{BIASES, SCALE, State};
use crate::math::sqrt;
use crate::snapshot::value;

/// What other sources' bearings say of the scale of the errors and of the bias, as normal likelihoods: of their means, in
/// prior sigmas, times the precisions, and of the precisions. All bits are zero where they say nothing.
#[derive(Debug, Clone, Copy)]
pub struct Shared {
    sums: [f32; 2],
    precisions: [f32; 2],
}

value!(Shared { sums, precisions });

/// Where in a state they are.
const PLACES: [usize; 2] = [SCALE, BIASES];

impl Shared {
    pub(in crate::aoa) const NOTHING: Self = Self {
        sums: [0.0; 2],
        precisions: [0.0; 2],
    };

    /// What the bearings of one source have said, if states have this mean and covariance with what those of others say.
    pub(super) fn of<const D: usize>(
        mean: &State<D>,
        covariance: &[State<D>; D],
        others: &Self,
    ) -> Self {
        let mut own = Self::NOTHING;
        for (i, place) in PLACES.into_iter().enumerate() {
            let (mean, variance) = (mean[place], covariance[place][place]);
            let precision = 1.0 / variance - prior_precision(place, mean) - others.precisions[i];
            if precision > 0.0 && precision.is_finite() {
                own.precisions[i] = precision;
                own.sums[i] = mean / variance - others.sums[i];
            }
        }
        own
    }

    pub(in crate::aoa) fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f32; 2], b: [f32; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            sums: sum(self.sums, other.sums),
            precisions: sum(self.precisions, other.precisions),
        }
    }

    /// Of a state, up to a constant.
    pub(super) fn log_likelihood<const D: usize>(&self, state: &State<D>) -> f32 {
        let [a, b] = [0, 1].map(|i| {
            let z = state[PLACES[i]];
            z * (self.sums[i] - 0.5 * self.precisions[i] * z)
        });
        a + b
    }

    /// Adds its gradient and its information.
    pub(super) fn add<const D: usize>(
        &self,
        state: &State<D>,
        gradient: &mut State<D>,
        information: &mut State<D>,
    ) {
        for (i, place) in PLACES.into_iter().enumerate() {
            gradient[place] += self.sums[i] - self.precisions[i] * state[place];
            information[place] += self.precisions[i];
        }
    }
}

/// That of a normal density which draws as strongly to zero as the prior does.
fn prior_precision(place: usize, z: f32) -> f32 {
    if place == SCALE {
        1.0 / sqrt(1.0 + z * z)
    } else {
        1.0
    }
}
