//! The probability of every point, and its summary in a few numbers.

use super::{Lattice, RadioMap, ReadingError};
use crate::estimate::Symmetric2;
use crate::math::exp_of_weight;

/// The probability of each of up to `P` points, given a scan; see [`super`] for an example.
///
/// Takes 6 P + 8 bytes.
#[derive(Debug, Clone)]
pub struct Posterior<const P: usize> {
    costs: [u16; P],
    weights: [f32; P],
    points: usize,
}

/// Where a scan was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Match {
    /// Number of the most probable point.
    pub point: usize,
    /// The most probable point, in metres.
    pub position: [f32; 2],
    /// The mean over the posterior, in metres.
    pub mean: [f32; 2],
    /// Natural logarithm of the likelihood of the scan at the most probable point, before tempering: how well the
    /// scan fits there.
    pub log_likelihood: f32,
    /// Readings that were used; the others were out of range.
    pub used: usize,
}

/// The cost of a point that was not surveyed.
pub(super) const NOWHERE: u16 = u16::MAX;

/// What costs mean: log-likelihoods are `used * top - step * cost` before they are tempered.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    /// Natural logarithm of the largest density of a reading.
    top: f32,
    /// How much every step of the cost takes off it.
    pub step: f32,
    /// Of e to the power of minus a whole number of steps, tempered: it is the product of an entry of either.
    low: [f32; 64],
    high: [f32; 64],
}

impl Scale {
    pub fn new(top: f32, step: f32, tempering: f32) -> Self {
        let powers = |step: f32| {
            let mut table = [0.0; 64];
            for (i, entry) in table.iter_mut().enumerate() {
                *entry = exp_of_weight(-step * i as f32);
            }
            table
        };
        let tempered = step * tempering;
        let (low, mut high) = (powers(tempered), powers(64.0 * tempered));
        high[63] = 0.0;
        Self {
            top,
            step,
            low,
            high,
        }
    }

    /// e to the power of minus `cost` steps, tempered; zero from 4032 steps on.
    #[inline(always)]
    fn at(&self, cost: i32) -> f32 {
        self.low[(cost & 63) as usize] * self.high[(cost >> 6).clamp(0, 63) as usize]
    }
}

impl<const P: usize> Posterior<P> {
    /// Of no points yet, in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(P <= Lattice::MAX_POINTS, "at most 65,536 points");
        Self {
            costs: [0; P],
            weights: [0.0; P],
            points: 0,
        }
    };

    /// The probabilities of the points, which sum to one; empty before the first scan.
    pub fn weights(&self) -> &[f32] {
        self.weights.get(..self.points).unwrap_or_default()
    }

    /// The covariance of the posterior about its mean, in square metres: of the last scan, so `lattice` must be that of
    /// its map.
    pub fn covariance(&self, lattice: &Lattice) -> Symmetric2 {
        let weighted = |of: &dyn Fn([f32; 2]) -> f32| {
            let mut sum = 0.0;
            for (point, weight) in self.weights().iter().enumerate() {
                sum += weight * of(lattice.cell(point).map(|number| number as f32));
            }
            sum
        };
        let mean = [weighted(&|[x, _]| x), weighted(&|[_, y]| y)];
        let moment = |a: usize, b: usize| {
            let product = |cell: [f32; 2]| (cell[a] - mean[a]) * (cell[b] - mean[b]);
            weighted(&product) * (lattice.spacing() * lattice.spacing())
        };
        let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
        Symmetric2 { xx, xy, yy }
    }

    /// Room for the costs of so many points.
    pub(super) fn costs_mut(&mut self, points: usize) -> Option<&mut [u16]> {
        self.costs.get_mut(..points)
    }

    /// Leaves out the points that were not surveyed, and finds the one of least cost.
    fn least_cost(&mut self, map: &RadioMap<'_>) -> Option<(usize, u16)> {
        let costs = self.costs.get_mut(..map.lattice().points())?;
        if !map.is_complete() {
            for (eight, bits) in costs.chunks_mut(8).zip(map.possible()) {
                for (bit, cost) in eight.iter_mut().enumerate() {
                    if bits >> bit & 1 == 0 {
                        *cost = NOWHERE;
                    }
                }
            }
        }
        // Cost above, number below: one comparison for both.
        let mut least = u32::MAX;
        for (number, cost) in costs.iter().enumerate() {
            least = least.min(u32::from(*cost) << 16 | number as u32);
        }
        let cost = (least >> 16) as u16;
        (cost != NOWHERE).then_some(((least & 0xffff) as usize, cost))
    }

    /// Computes the probabilities from the costs of so many readings: takes their mean about the best point in steps of
    /// the lattice, and divides them by their sum.
    pub(super) fn of_costs(
        &mut self,
        map: &RadioMap<'_>,
        scale: &Scale,
        used: usize,
    ) -> Result<Match, ReadingError> {
        let (point, least) = self.least_cost(map).ok_or(ReadingError::Survey)?;
        let lattice = map.lattice();
        self.points = lattice.points();
        let [column, row] = lattice.cell(point).map(|number| number as f32);
        let mut weights = self.weights.get_mut(..self.points).unwrap_or_default();
        let mut costs = self.costs.get(..self.points).unwrap_or_default();
        let (mut sum, mut sum_x, mut sum_y) = (0.0, 0.0, 0.0);
        let mut y = -row;
        while let (Some((these_weights, weights_left)), Some((these_costs, costs_left))) = (
            weights.split_at_mut_checked(lattice.columns()),
            costs.split_at_checked(lattice.columns()),
        ) {
            if these_weights.is_empty() {
                break;
            }
            (weights, costs) = (weights_left, costs_left);
            let (mut of_row, mut x) = (0.0, -column);
            for (weight, cost) in these_weights.iter_mut().zip(these_costs) {
                *weight = scale.at(i32::from(*cost) - i32::from(least));
                of_row += *weight;
                sum_x += *weight * x;
                x += 1.0;
            }
            sum += of_row;
            sum_y += of_row * y;
            y += 1.0;
        }
        let inverse = 1.0 / sum;
        for weight in self.weights.get_mut(..self.points).unwrap_or_default() {
            *weight *= inverse;
        }
        Ok(Match {
            point,
            position: lattice.place([column, row]),
            mean: lattice.place([column + sum_x * inverse, row + sum_y * inverse]),
            log_likelihood: scale.top * used as f32 - scale.step * f32::from(least),
            used,
        })
    }
}
