//! Matching by normal densities.

use core::f32::consts::TAU;

use super::map::LOWEST_MEAN_DBM;
use super::posterior::Scale;
use super::{Config, RadioMap, Reading};
use crate::math::{exp, ln, sqrt};

/// What readings cost by the mean and the sigma of their beacon at a point.
///
/// The likelihood of a reading is the larger one of the normal density, with the sigma of the map and the inflation of
/// the configuration, and of the uniform density of the outliers: nearly their sum (max-mixture of Olson and Agarwal,
/// 2013), computed in whole numbers. Its logarithm has steps of a 255th of the largest loss, 0.03 to 0.07, and for
/// the largest sigmas an error of a hundredth.
#[derive(Debug, Clone)]
pub(super) struct Gaussian {
    /// By the code of the sigma, see [`entry`].
    costs: [u32; 64],
    /// In dB^2, added to the variance of the map.
    inflation: f32,
    pub scale: Scale,
}

/// The largest cost of a reading, that of an outlier.
const FLOOR: i32 = 255;

impl Gaussian {
    pub fn new(config: &Config) -> Self {
        let inflation = config.inflation_sigma_db * config.inflation_sigma_db;
        let variance = |code: usize| {
            let sigma = 0.25 * code as f32;
            sigma * sigma + inflation
        };
        let log_density = |code| ln(config.inlier_rate()) - 0.5 * ln(TAU * variance(code));
        let top = log_density(1);
        let step = (top - config.log_floor()) / FLOOR as f32;
        // Where the map has no mean, every reading is an outlier.
        let mut costs = [entry(4096.0 * FLOOR as f32, 0.0); 64];
        for (code, cost) in costs.iter_mut().enumerate().skip(1) {
            // A squared half of a dB is a quarter of a dB^2, and half of that over the variance counts.
            let per_square = 4096.0 * 0.25 * 0.5 / (variance(code) * step);
            *cost = entry(4096.0 * (top - log_density(code)) / step, per_square);
        }
        Self {
            costs,
            inflation,
            scale: Scale::new(top, step, config.tempering),
        }
    }

    /// Sets the costs of all points to those of the readings.
    pub fn set<'a>(
        &self,
        map: &RadioMap<'_>,
        readings: impl Iterator<Item = &'a Reading>,
        costs: &mut [u16],
    ) {
        let mut rows = readings.map(|reading| {
            let strength = 2.0 * (reading.rssi_dbm - LOWEST_MEAN_DBM) + 0.5;
            let row = map.moments_row(reading.beacon.into());
            (strength as i32, row.unwrap_or_default())
        });
        // Four rows at once to begin with, the others one by one.
        let mut first = [(0, [].as_slice()); 4];
        let mut filled = 0;
        for (place, row) in first.iter_mut().zip(rows.by_ref()) {
            *place = row;
            filled += 1;
        }
        if filled == 4 {
            self.set_four(&first, costs);
        } else {
            costs.fill(0);
            for row in first.into_iter().take(filled) {
                self.add_one(row, costs);
            }
        }
        for row in rows {
            self.add_one(row, costs);
        }
    }

    fn add_one(&self, (strength, row): Row<'_>, costs: &mut [u16]) {
        for (sum, pair) in costs.iter_mut().zip(row) {
            *sum += self.cost(strength, *pair) as u16;
        }
    }

    /// Four readings in one pass, which keeps the sums in registers; they replace what was there.
    #[inline(never)]
    fn set_four(&self, [a, b, c, d]: &[Row<'_>; 4], costs: &mut [u16]) {
        let rows = a.1.iter().zip(b.1).zip(c.1).zip(d.1);
        for (sum, (((pair_a, pair_b), pair_c), pair_d)) in costs.iter_mut().zip(rows) {
            let total = self.cost(a.0, *pair_a) + self.cost(b.0, *pair_b);
            *sum = (total + self.cost(c.0, *pair_c) + self.cost(d.0, *pair_d)) as u16;
        }
    }

    /// Adds the cost of the absence of a beacon.
    pub fn add_missing(&self, map: &RadioMap<'_>, beacon: usize, costs: &mut [u16]) {
        let (Some(row), Some(beacon)) = (map.moments_row(beacon), map.beacon(beacon)) else {
            return;
        };
        for (sum, [sigma, mean]) in costs.iter_mut().zip(row) {
            let heard = if *sigma == 0 {
                0.0
            } else {
                let sigma = 0.25 * f32::from(*sigma);
                let variance = sigma * sigma + self.inflation;
                let above = 0.5 * f32::from(*mean) + LOWEST_MEAN_DBM - beacon.sensitivity_dbm;
                // The normal distribution function, to 0.01.
                1.0 / (1.0 + exp(-1.702 * above / sqrt(variance)))
            };
            let cost = -ln(1.0 - beacon.detection * heard) / self.scale.step + 0.5;
            // The conversion saturates, also where the absence is impossible.
            *sum += (cost as u16).min(FLOOR as u16);
        }
    }

    /// The cost by the distance and by the entry of the sigma, in nine instructions of a Cortex-M4.
    #[inline(always)]
    fn cost(&self, strength: i32, pair: [u8; 2]) -> i32 {
        let pair = u16::from_le_bytes(pair);
        // No strength is larger; this tells the compiler that short factors make the first product.
        let distance = (strength & 0x1ff) - i32::from(pair >> 8);
        let cost = self.costs[usize::from(pair & 63)];
        let slope = distance * i32::from(cost as i16);
        let none = (cost >> 12) as i32;
        (slope.wrapping_mul(distance).wrapping_add(none) >> 12).clamp(0, FLOOR)
    }
}

/// The entry for a cost at distance zero and a cost per squared half of a dB, both in 4096ths.
fn entry(none: f32, per_square: f32) -> u32 {
    // With distances of up to 296 halves of a dB, what [`Gaussian::cost`] computes stays within 31 bits.
    let per_square = ((per_square + 0.5) as u32).min(24_000);
    // In steps of 16, with half a cost more, so that the result is rounded. A shift by 12 leaves 16ths of this, and of
    // the other half no more than 4.
    let none = ((none + 2048.0) * (1.0 / 16.0)) as u32;
    none << 16 | per_square
}

/// A strength in halves of a dB above the lowest mean, and the sigmas and means of its beacon.
type Row<'a> = (i32, &'a [[u8; 2]]);
