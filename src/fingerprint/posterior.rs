//! The probability of every point, and what is said of it in a few numbers.

use core::fmt;

use super::{Lattice, RadioMap};
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
pub struct Match {
    /// Number of the most probable point.
    pub point: usize,
    /// The most probable point, in metres.
    pub position: [f32; 2],
    /// The mean over the posterior, in metres.
    pub mean: [f32; 2],
    /// The covariance of the posterior, in square metres.
    pub covariance: [[f32; 2]; 2],
    /// Natural logarithm of the likelihood of the scan at the most probable point, before tempering: how well the
    /// scan fits where it fits best. For [`super::Neighbours`], minus the squared distance in dB^2.
    pub log_likelihood: f32,
    /// Readings that were used; the others were out of range.
    pub used: usize,
}

/// Why a scan was not matched. The posterior is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MatchError {
    /// The map has no beacon of that number.
    Beacon,
    /// The scan has no reading that a receiver can report.
    Scan,
    /// The map has more points than the posterior.
    Points,
    /// No point was surveyed.
    Survey,
}

impl fmt::Display for MatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Beacon => "a reading of a beacon that the map has not",
            Self::Scan => "no reading within the range of a receiver",
            Self::Points => "the map has more points than the posterior",
            Self::Survey => "no point was surveyed",
        })
    }
}

impl core::error::Error for MatchError {}

/// The cost of a point that was not surveyed.
pub(super) const NOWHERE: u16 = u16::MAX;

/// e to the power of minus a whole number of steps, as the product of two entries.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Exponentials {
    low: [f32; 64],
    high: [f32; 64],
}

impl Exponentials {
    /// Of steps of so many nats.
    pub fn new(step: f32) -> Self {
        let powers = |step: f32| {
            let mut table = [0.0; 64];
            for (i, entry) in table.iter_mut().enumerate() {
                *entry = exp_of_weight(-step * i as f32);
            }
            table
        };
        let (low, mut high) = (powers(step), powers(64.0 * step));
        high[63] = 0.0;
        Self { low, high }
    }

    /// e^(-step cost); zero from 4032 steps on.
    #[inline(always)]
    fn at(&self, cost: i32) -> f32 {
        self.low[(cost & 63) as usize] * self.high[(cost >> 6).clamp(0, 63) as usize]
    }
}

impl<const P: usize> Posterior<P> {
    /// Of no points yet.
    pub const fn new() -> Self {
        const { assert!(P <= Lattice::MAX_POINTS, "at most 65,536 points") };
        Self {
            costs: [0; P],
            weights: [0.0; P],
            points: 0,
        }
    }

    /// The probabilities of the points, which sum to one; empty before the first scan.
    pub fn weights(&self) -> &[f32] {
        self.weights.get(..self.points).unwrap_or_default()
    }

    /// Room for the costs of so many points.
    pub(super) fn costs_mut(&mut self, points: usize) -> Option<&mut [u16]> {
        self.costs.get_mut(..points)
    }

    /// Room for the log-likelihoods, or weights on any scale, of so many points.
    pub(super) fn log_likelihoods_mut(&mut self, points: usize) -> Option<&mut [f32]> {
        self.weights.get_mut(..points)
    }

    /// Leaves out the points that were not surveyed, and finds the one of least cost.
    fn least_cost(&mut self, map: &RadioMap<'_>) -> Option<(usize, u16)> {
        let costs = self.costs.get_mut(..map.lattice().points())?;
        let blocks = costs.chunks_mut(8).zip(map.surveyed());
        for (eight, bits) in blocks.filter(|(_, bits)| **bits != 0xff) {
            for (bit, cost) in eight.iter_mut().enumerate() {
                if bits >> bit & 1 == 0 {
                    *cost = NOWHERE;
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

    /// The probabilities from the costs, each step of which takes off as much as `exponentials` say.
    pub(super) fn of_costs(
        &mut self,
        map: &RadioMap<'_>,
        exponentials: &Exponentials,
    ) -> Option<(Located, u16)> {
        let lattice = map.lattice();
        let (point, least) = self.least_cost(map)?;
        let points = lattice.points();
        let costs = self.costs.get(..points)?;
        let weights = self.weights.get_mut(..points)?;
        let mut sum = 0.0;
        for (weight, cost) in weights.iter_mut().zip(costs) {
            *weight = exponentials.at(i32::from(*cost) - i32::from(least));
            sum += *weight;
        }
        self.points = points;
        Some((self.located(lattice, point, sum), least))
    }

    /// The probabilities from log-likelihoods, which stand in the weights; those that are minus infinity or NaN are
    /// none.
    pub(super) fn of_log_likelihoods(
        &mut self,
        lattice: &Lattice,
        tempering: f32,
    ) -> Option<(Located, f32)> {
        let points = lattice.points();
        let weights = self.weights.get_mut(..points)?;
        let mut best = (0, f32::NEG_INFINITY);
        for (point, log_likelihood) in weights.iter().enumerate() {
            if *log_likelihood > best.1 {
                best = (point, *log_likelihood);
            }
        }
        let (point, largest) = best;
        let mut sum = 0.0;
        for weight in weights {
            *weight = exp_of_weight(tempering * (*weight - largest));
            sum += *weight;
        }
        self.points = points;
        Some((self.located(lattice, point, sum), largest))
    }

    /// The probabilities from weights on any scale, which stand in their place.
    pub(super) fn of_weights(&mut self, lattice: &Lattice, point: usize) -> Option<Located> {
        let weights = self.weights.get(..lattice.points())?;
        let sum = weights.iter().sum();
        self.points = lattice.points();
        Some(self.located(lattice, point, sum))
    }

    /// Divides by the sum, and takes the moments about the best point, in steps of the lattice.
    fn located(&mut self, lattice: &Lattice, point: usize, sum: f32) -> Located {
        let scale = 1.0 / sum;
        let [column, row] = lattice.cell(point);
        let mut rest = self.weights.get_mut(..lattice.points()).unwrap_or_default();
        let (first_x, mut y) = (-(column as f32), -(row as f32));
        let mut sums = [0.0f32; 5];
        let [sx, sy, sxx, sxy, syy] = &mut sums;
        while let Some((this, others)) = rest.split_at_mut_checked(lattice.columns()) {
            if this.is_empty() {
                break;
            }
            rest = others;
            let mut x = first_x;
            let (mut w0, mut w1, mut w2) = (0.0, 0.0, 0.0);
            for weight in this {
                *weight *= scale;
                let wx = *weight * x;
                w0 += *weight;
                w1 += wx;
                w2 += wx * x;
                x += 1.0;
            }
            *sx += w1;
            *sy += w0 * y;
            *sxx += w2;
            *sxy += w1 * y;
            *syy += w0 * y * y;
            y += 1.0;
        }
        let square = lattice.spacing() * lattice.spacing();
        let variance = |second: f32, first: f32| {
            let variance = second - first * first;
            if variance > 0.0 {
                variance * square
            } else {
                0.0
            }
        };
        let xy = (*sxy - *sx * *sy) * square;
        Located {
            point,
            position: lattice.place([column as f32, row as f32]),
            mean: lattice.place([column as f32 + *sx, row as f32 + *sy]),
            covariance: [[variance(*sxx, *sx), xy], [xy, variance(*syy, *sy)]],
        }
    }
}

impl<const P: usize> Default for Posterior<P> {
    fn default() -> Self {
        Self::new()
    }
}

/// A [`Match`] without its likelihood.
pub(super) struct Located {
    point: usize,
    position: [f32; 2],
    mean: [f32; 2],
    covariance: [[f32; 2]; 2],
}

impl Located {
    pub fn with(self, log_likelihood: f32, used: usize) -> Match {
        Match {
            point: self.point,
            position: self.position,
            mean: self.mean,
            covariance: self.covariance,
            log_likelihood,
            used,
        }
    }
}
