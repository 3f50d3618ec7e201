//! What all bearings and the priors say of a state.

use super::term::{State, Term};
use crate::aoa::core::{BLOCK, Block, Target, square_of_distance};
use crate::math::ln;

/// Where a source may be before any bearing: a density of 1 / (1 + r^2 / R^2)^2 about the first receiver.
///
/// Flat within R, half of it there, and proper: a posterior under which every bearing may be outlier has an infinite mass
/// at infinity without.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub(super) centre: [f32; 2],
    /// 1 / R^2
    pub(super) inverse_square: f32,
}

impl Region {
    /// One plus the square of the distance in ranges.
    fn spread(&self, &[x, y, _]: &State) -> f32 {
        1.0 + square_of_distance([x, y], self.centre) * self.inverse_square
    }

    /// Of place and bias, up to a constant.
    pub(super) fn log_density(&self, state: &State) -> f32 {
        -2.0 * ln(self.spread(state)) - 0.5 * state[2] * state[2]
    }

    /// Pull to the centre: that of a normal density which draws as strongly here, in 1 / m^2.
    pub(super) fn information(&self, state: &State) -> f32 {
        4.0 * self.inverse_square / self.spread(state)
    }
}

/// The posterior of some bearings.
#[derive(Clone, Copy)]
pub(super) struct Density<'a> {
    pub(super) terms: &'a [Term],
    pub(super) region: Region,
    /// In radians.
    pub(super) bias_sigma_rad: f32,
}

/// As many odds as can be multiplied without overflow before the logarithm is taken.
const PRODUCTS: usize = 3;

impl Density<'_> {
    /// Log-density up to a constant.
    #[inline(never)]
    pub(super) fn log_density(&self, state: &State) -> f32 {
        let bias = self.bias_sigma_rad * state[2];
        let one = |term: &Term| term.log_likelihood(state, bias);
        self.terms.iter().map(one).sum::<f32>() + self.region.log_density(state)
    }
}

impl Target<3> for Density<'_> {
    #[inline(never)]
    fn log_densities(&self, states: &Block<3>) -> [f32; BLOCK] {
        let biases = states[2].map(|bias| self.bias_sigma_rad * bias);
        let mut sums = core::array::from_fn(|i| {
            let [x, y, bias] = states.each_ref().map(|column| column[i]);
            self.region.log_density(&[x, y, bias])
        });
        for terms in self.terms.chunks(PRODUCTS) {
            let mut products = [1.0; BLOCK];
            for term in terms {
                term.multiply(states, &biases, &mut products);
            }
            for (sum, product) in sums.iter_mut().zip(products) {
                *sum += ln(product);
            }
        }
        sums
    }
}
