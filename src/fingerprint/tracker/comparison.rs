//! A scan compared with the map at a place.

use super::Config;
use super::memory::{Memory, Prior};
use super::offset::OffsetBelief;
use super::pending::Level;
use crate::fingerprint::{RadioMap, map::LOWEST_MEAN_DBM};
use crate::math::ln;

/// A place between points of the lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    /// The point before it, along both axes.
    first: usize,
    /// From there, in 256ths of a step.
    along: u32,
    across: u32,
}

impl Spot {
    /// A place on a map of one row or column, in steps; none beyond the map.
    #[inline(always)]
    pub fn on_line(steps: f32, points: usize) -> Option<Self> {
        let (first, along) = before(steps, points)?;
        Some(Self {
            first,
            along,
            across: 0,
        })
    }

    /// A place in the plane, in steps; none beyond the map.
    #[inline(always)]
    pub fn in_plane([x, y]: [f32; 2], columns: usize, rows: usize) -> Option<Self> {
        let (column, along) = before(x, columns)?;
        let (row, across) = before(y, rows)?;
        Some(Self {
            first: row * columns + column,
            along,
            across,
        })
    }

    /// The point nearest to it.
    #[inline(always)]
    pub fn nearest(&self, columns: usize) -> usize {
        let row = if self.across >= 128 { columns } else { 0 };
        self.first + row + usize::from(self.along >= 128)
    }

    /// Interpolates the means of a beacon, in halves of a dB, and says which sigma it has, in quarters.
    #[inline(always)]
    fn look_up<const PLANE: bool>(&self, row: &[[u8; 2]], columns: usize) -> Option<(f32, u8)> {
        let [[sigma, a], [_, b]] = *row.get(self.first..)?.first_chunk()?;
        let mix = |a: u8, b: u8| u32::from(a) * (256 - self.along) + u32::from(b) * self.along;
        let near = mix(a, b);
        if !PLANE {
            return Some((near as f32 * (1.0 / 256.0), sigma));
        }
        let [[_, c], [_, d]] = *row.get(self.first + columns..)?.first_chunk()?;
        let sum = near * (256 - self.across) + mix(c, d) * self.across;
        Some((sum as f32 * (1.0 / 65_536.0), sigma))
    }
}

/// The last point at or before a place, so many `steps` from the first of `points` in a line, and 256ths of a step
/// beyond it; none beyond the line, or for NaN.
#[inline(always)]
fn before(steps: f32, points: usize) -> Option<(usize, u32)> {
    let last = points.saturating_sub(1);
    if !(steps >= 0.0 && steps <= last as f32) {
        return None;
    }
    let first = (steps as usize).min(last.saturating_sub(1));
    Some((first, ((steps - first as f32) * 256.0) as u32))
}

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
                    noise: packet / f32::from(level.packets),
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
            belief: *belief,
            log_none,
            log_some,
            mean: 2.0 * belief.mean_db,
            variance: 4.0 * belief.variance,
            gate: config.gate_sigmas * config.gate_sigmas,
            mismatch: 4.0 * config.mismatch_sigma_db * config.mismatch_sigma_db,
        }
    }

    /// At a place, of a tag that was at another when it heard what is remembered.
    #[inline(always)]
    pub fn at<const PLANE: bool>(&self, spot: &Spot, past: &Spot) -> Found {
        let mut sums = Sums::EMPTY;
        for reading in &self.readings {
            let Some((mean, sigma)) = spot.look_up::<PLANE>(reading.row, self.columns) else {
                continue;
            };
            let mut difference = reading.level - mean;
            if reading.weight > 0.0
                && let Some((mean, _)) = past.look_up::<PLANE>(reading.row, self.columns)
            {
                difference += reading.weight * mean;
            }
            let error = error_variance(sigma) + self.mismatch;
            let variance = error * reading.unknown + reading.noise;
            sums.add(difference, 1.0 - reading.weight, variance, self);
        }
        sums.conclude(self)
    }
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

    /// Adds a reading that differs so much from what is expected, to which an offset adds in proportion to `slope`.
    #[inline(always)]
    fn add<const B: usize>(
        &mut self,
        difference: f32,
        slope: f32,
        variance: f32,
        terms: &Comparison<'_, B>,
    ) {
        let precision = 1.0 / variance;
        let least = |a: f32, b: f32| if a < b { a } else { b };
        self.cost += least(difference * difference * precision, terms.gate);
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
            } else {
                self.cost_with += terms.gate;
            }
        }
        self.product *= precision;
        if self.product < 1e-25 {
            let logarithm = ln(self.product);
            self.cost -= logarithm;
            self.cost_with -= logarithm;
            self.product = 1.0;
        }
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
            log_likelihood: if with_prior > without_prior {
                with_prior
            } else {
                without_prior
            },
            precision: 4.0 * precision,
            shift: 0.5 * gain * weighted,
            probability: terms.belief.probability_given(with - without),
        }
    }
}
