//! A scan compared with the map at a place.

use super::Config;
use super::memory::{Memory, Prior};
use super::offset::OffsetBelief;
use super::pending::Level;
use crate::fingerprint::{RadioMap, map::LOWEST_MEAN_DBM};
use crate::math::{larger, ln};
use core::f32::consts::SQRT_2;

/// A beacon of a scan, ready to be compared. Levels are in halves of a dB above the lowest, as the means of the map.
#[derive(Debug, Clone, Copy)]
struct Reading<'a> {
    row: &'a [[u8; 2]],
    /// Less what is remembered.
    level: f32,
    /// How much of the map's mean at the place before counts against that at this one.
    weight: f32,
    /// The factor of the variance of the map's error.
    unknown: f32,
    /// The variance of the mean of its packets.
    noise: f32,
}

/// A scan, ready to be compared with the map.
#[derive(Debug, Clone)]
pub(super) struct Comparison<'a, const B: usize> {
    readings: heapless::Vec<Reading<'a>, B>,
    columns: usize,
    tempering: f32,
    is_estimated: bool,
    /// Whether there is an offset, more probably than not.
    has_offset: bool,
    /// Of the offset.
    belief: OffsetBelief,
    log_none: f32,
    log_some: f32,
    mean: f32,
    variance: f32,
    /// The largest cost of a reading, doubled as all costs.
    gate: f32,
    /// Of the map's error, besides what the map states.
    mismatch: f32,
}

/// What a scan says of a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub log_likelihood: f32,
    /// How much the scan adds to the precision of the offset, per dB^2.
    pub precision: f32,
    /// The correction of the mean of the offset, if the tag has one.
    pub shift: f32,
    /// The probability that the tag has an offset.
    pub probability: f32,
}

impl Found {
    pub const NOWHERE: Self = Self {
        log_likelihood: f32::NEG_INFINITY,
        precision: 0.0,
        shift: 0.0,
        probability: 0.0,
    };
}

/// The variance of a packet about the mean at its place, in squared halves of a dB.
pub(super) fn packet_variance(map: &RadioMap<'_>) -> f32 {
    let noise = 2.0 * map.noise_db();
    noise * noise
}

/// The variance of the error of a mean, in squared halves of a dB, by the code of its sigma. Where a beacon was not heard,
/// the mean is that of the weakest reading, and not known well.
#[inline(always)]
pub(super) fn error_variance(sigma: u8) -> f32 {
    let sigma = f32::from(if sigma == 0 { 63 } else { sigma });
    0.25 * sigma * sigma
}

impl<'a, const B: usize> Comparison<'a, B> {
    /// The other beacons of a scan of twelve, for which the tempering is stated.
    const OTHERS: f32 = 11.0;

    /// Of a scan, by what is remembered of the error of the map, if anything is.
    #[inline(never)]
    pub fn new(
        map: &RadioMap<'a>,
        config: &Config,
        belief: &OffsetBelief,
        memory: Option<&Memory<B>>,
        scan: &[Level; B],
    ) -> Self {
        let packet = packet_variance(map);
        let [log_none, log_some] = belief.log_probabilities();
        let mut readings = heapless::Vec::new();
        for (beacon, level) in scan.iter().enumerate() {
            if let (Some(row), 1..) = (map.moments_row(beacon), level.packets) {
                let prior = memory.map_or(Prior::NONE, |memory| memory.prior(beacon));
                let above = |level_dbm: f32| 2.0 * (level_dbm - LOWEST_MEAN_DBM);
                // There are no more than levels.
                let _ = readings.push(Reading {
                    row,
                    level: above(level.mean_dbm) - prior.weight * above(prior.level_dbm),
                    weight: prior.weight,
                    unknown: prior.unknown,
                    noise: packet / f32::from(level.packets) + 4.0 * level.doubt_db2,
                });
            }
        }
        // As of errors of which each shares a part with every other: fewer have less in common.
        let tempering = config.tempering;
        let others = readings.len().saturating_sub(1) as f32;
        let common = (1.0 - tempering) * (1.0 / Self::OTHERS) * others;
        Self {
            readings,
            columns: map.lattice().columns(),
            tempering: tempering / (tempering + common),
            is_estimated: belief.is_estimated(),
            has_offset: belief.is_estimated() && belief.probability() > 0.5,
            belief: *belief,
            log_none,
            log_some,
            mean: 2.0 * belief.mean_db,
            variance: 4.0 * belief.variance,
            gate: config.gate_sigmas * config.gate_sigmas,
            mismatch: 4.0 * config.mismatch_sigma_db * config.mismatch_sigma_db,
        }
    }
}

/// Where a tag was that is at a point now.
///
/// What is remembered fades exponentially, so its mean over the way of a tag is an integral with an exponential weight: by
/// Gauss-Laguerre quadrature of two points (Abramowitz and Stegun, 25.4.45), at a recent and at an old age.
#[derive(Debug, Clone, Copy)]
pub(super) struct Past {
    /// At the recent age: a point, and the fractions of a step beyond it.
    pub first: usize,
    pub fractions: [f32; 2],
    /// The point nearest to where it was at the old age, which weighs little.
    pub old: usize,
}

impl Past {
    /// The ages, relative to the mean age of what is remembered.
    pub const RECENT: f32 = 2.0 - SQRT_2;
    pub const OLD: f32 = 2.0 + SQRT_2;
    /// The weight of each age.
    const OF_RECENT: f32 = 0.25 * Self::OLD;
    const OF_OLD: f32 = 0.25 * Self::RECENT;
}

/// By how much the log-likelihood grows with every step that a tag moved further since what is remembered, along each axis.
pub(super) type Slope = [f32; 2];

impl<const B: usize> Comparison<'_, B> {
    /// At a point, of a tag that was elsewhere when it heard what is remembered.
    #[inline(always)]
    pub fn at_point<const PLANE: bool>(&self, point: usize, past: &Past) -> (Found, Slope) {
        let mut sums = Sums::EMPTY;
        let mut slope = [0.0; 2];
        let [s, t] = past.fractions;
        for reading in &self.readings {
            let row = reading.row;
            let (Some([sigma, mean]), Some([_, old]), Some([a, b])) =
                (row.get(point), row.get(past.old), pair(row, past.first))
            else {
                continue;
            };
            let (mut recent, mut gradient) = (a + s * (b - a), [b - a, 0.0]);
            if PLANE {
                let Some([c, d]) = pair(row, past.first + self.columns) else {
                    continue;
                };
                let across = c + s * (d - c) - recent;
                recent += t * across;
                gradient = [gradient[0] + t * ((d - c) - gradient[0]), across];
            }
            let there = Past::OF_RECENT * recent + Past::OF_OLD * f32::from(*old);
            let difference = reading.level - f32::from(*mean) + reading.weight * there;
            let error = error_variance(*sigma) + self.mismatch;
            let variance = error * reading.unknown + reading.noise;
            let weighted = sums.add(difference, 1.0 - reading.weight, variance, self);
            let weighted = reading.weight * weighted;
            slope[0] += weighted * gradient[0];
            if PLANE {
                slope[1] += weighted * gradient[1];
            }
        }
        (sums.conclude(self), slope.map(|sum| self.tempering * sum))
    }

    /// At a point, if nothing is remembered: the log-likelihood.
    #[inline(always)]
    pub fn anew_at(&self, point: usize) -> Found {
        let mut sums = Sums::EMPTY;
        for reading in &self.readings {
            let Some([sigma, mean]) = reading.row.get(point) else {
                continue;
            };
            let variance = error_variance(*sigma) + (self.mismatch + reading.noise);
            sums.add(reading.level - f32::from(*mean), 1.0, variance, self);
        }
        sums.conclude(self)
    }
}

/// The means of a beacon at a point and at the next one.
#[inline(always)]
fn pair(row: &[[u8; 2]], first: usize) -> Option<[f32; 2]> {
    let [[_, a], [_, b]] = *row.get(first..)?.first_chunk()?;
    Some([f32::from(a), f32::from(b)])
}

/// Sums over the beacons of a scan at one place, in halves of a dB.
#[derive(Clone, Copy)]
struct Sums {
    /// Without an offset.
    cost: f32,
    /// With the mean of the offset.
    cost_with: f32,
    /// Over the readings within the gate of the offset: precisions, and differences weighted by them.
    precision: f32,
    weighted: f32,
    /// Product of all precisions; its logarithm is taken when it gets small.
    product: f32,
}

impl Sums {
    const EMPTY: Self = Self {
        cost: 0.0,
        cost_with: 0.0,
        precision: 0.0,
        weighted: 0.0,
        product: 1.0,
    };

    /// Adds a reading that differs so much from what is expected, to which an offset adds in proportion to `slope`. Returns
    /// the difference, weighted by its precision, by the more probable hypothesis of both; nothing beyond its gate.
    #[inline(always)]
    fn add<const B: usize>(
        &mut self,
        difference: f32,
        slope: f32,
        variance: f32,
        terms: &Comparison<'_, B>,
    ) -> f32 {
        let precision = 1.0 / variance;
        let weighted = difference * precision;
        let cost = difference * weighted;
        let is_within = cost < terms.gate;
        self.cost += if is_within { cost } else { terms.gate };
        let mut said = if is_within { weighted } else { 0.0 };
        if terms.is_estimated {
            let difference = difference - slope * terms.mean;
            let weighted = difference * precision;
            let cost = difference * weighted;
            let informed = slope * slope * precision;
            // An offset that is not known well leaves room for larger differences.
            if cost < terms.gate * (1.0 + terms.variance * informed) {
                self.cost_with += cost;
                self.precision += informed;
                self.weighted += slope * weighted;
                if terms.has_offset {
                    said = weighted;
                }
            } else {
                self.cost_with += terms.gate;
                if terms.has_offset {
                    said = 0.0;
                }
            }
        }
        self.product *= precision;
        if self.product < 1e-25 {
            let logarithm = ln(self.product);
            self.cost -= logarithm;
            self.cost_with -= logarithm;
            self.product = 1.0;
        }
        said
    }

    #[inline(always)]
    fn conclude<const B: usize>(self, terms: &Comparison<'_, B>) -> Found {
        let tempering = terms.tempering;
        let logarithm = ln(self.product);
        let half = 0.5 * tempering;
        let without = half * (logarithm - self.cost);
        if !terms.is_estimated {
            return Found {
                log_likelihood: without,
                precision: 0.0,
                shift: 0.0,
                probability: 0.0,
            };
        }
        let precision = tempering * self.precision;
        let weighted = tempering * self.weighted;
        let known = 1.0 + terms.variance * precision;
        let gain = terms.variance / known;
        let with =
            half * (logarithm - self.cost_with) + 0.5 * (gain * weighted * weighted - ln(known));
        // The sum of both is at most ln 2 above the larger.
        let (without_prior, with_prior) = (without + terms.log_none, with + terms.log_some);
        Found {
            log_likelihood: larger(with_prior, without_prior),
            precision: 4.0 * precision,
            shift: 0.5 * gain * weighted,
            probability: terms.belief.probability_given(with - without),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many that the product of their precisions would be no number.
    #[test]
    fn many_readings_cost_the_sum_of_what_each_costs() {
        const READINGS: u8 = 100;
        const VARIANCE: f32 = 64.0;
        let terms = Comparison::<1> {
            readings: heapless::Vec::new(),
            columns: 0,
            tempering: 1.0,
            is_estimated: true,
            has_offset: false,
            belief: OffsetBelief::EMPTY,
            log_none: 0.0,
            log_some: 0.0,
            mean: 2.0,
            variance: 1.0,
            gate: 16.0,
            mismatch: 0.0,
        };
        let mut sums = Sums::EMPTY;
        for _ in 0..READINGS {
            // Expected but for the offset.
            sums.add(2.0, 1.0, VARIANCE, &terms);
        }
        let with = f32::from(READINGS) * VARIANCE.ln();
        let without = with + f32::from(READINGS) * 4.0 / VARIANCE;
        for (cost, expected) in [(sums.cost_with, with), (sums.cost, without)] {
            let cost = cost - sums.product.ln();
            assert!((cost / expected - 1.0).abs() < 1e-4, "{cost} {expected}");
        }
    }
}
