//! Matching by normal densities.

use core::f32::consts::TAU;

use super::{
    Encoding, MapError, Match, MatchError, Matcher, Missing, Posterior, RadioMap, Reading,
    Settings, check, for_each_accepted, map::LOWEST_MEAN_DBM, missing, posterior::Exponentials,
};
use crate::math::{exp, ln, sqrt};

/// Compares scans with the mean and the deviation of every beacon at every point.
///
/// The likelihood of a reading is the larger one of the normal density, with the deviation of the map and the inflation
/// of the settings, and of the uniform density of the outliers: nearly their sum (max-mixture of Olson and Agarwal,
/// 2013), and all of it is done in whole numbers. Its logarithm has steps of a 255th of the largest loss, 0.03
/// to 0.07, and for the widest deviations an error of a hundredth.
///
/// Takes some 880 bytes.
#[derive(Debug, Clone)]
pub struct GaussianMatcher<'a> {
    map: RadioMap<'a>,
    settings: Settings,
    /// By deviation, see [`entry`].
    costs: [u32; 64],
    /// Natural logarithm of the largest density.
    top: f32,
    /// What every step of the cost takes off it.
    step: f32,
    exponentials: Exponentials,
}

/// The largest cost of a reading, that of an outlier.
const FLOOR: i32 = 255;

impl<'a> GaussianMatcher<'a> {
    /// Of a map of [`Encoding::Moments`].
    ///
    /// # Errors
    /// [`MapError::Encoding`] for another.
    pub fn new(map: RadioMap<'a>, settings: &Settings) -> Result<Self, MapError> {
        if map.encoding() != Encoding::Moments {
            return Err(MapError::Encoding);
        }
        let variance = |code: usize| {
            let deviation = 0.25 * code as f32;
            deviation * deviation + settings.inflation_variance()
        };
        let log_density = |code| ln(settings.inliers()) - 0.5 * ln(TAU * variance(code));
        let top = log_density(1);
        let step = (top - settings.log_floor()) / FLOOR as f32;
        // Where the map has nothing, only outliers come from.
        let mut costs = [entry(4096.0 * FLOOR as f32, 0.0); 64];
        for (code, cost) in costs.iter_mut().enumerate().skip(1) {
            // A squared half of a dB is a quarter of a dB^2, and half of that over the variance counts.
            let per_square = 4096.0 * 0.25 * 0.5 / (variance(code) * step);
            *cost = entry(4096.0 * (top - log_density(code)) / step, per_square);
        }
        Ok(Self {
            map,
            settings: *settings,
            costs,
            top,
            step,
            exponentials: Exponentials::new(step * settings.tempering()),
        })
    }

    /// What a reading is compared with.
    fn row(&self, reading: &Reading) -> Row<'a> {
        let strength = 2.0 * (reading.rssi_dbm - LOWEST_MEAN_DBM) + 0.5;
        let row = self.map.moments_row(reading.beacon.into());
        (strength as i32, row.unwrap_or_default().as_chunks().0)
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

    /// Adds what the absence of a beacon costs.
    fn add_missing(&self, beacon: usize, costs: &mut [u16]) {
        let (Some(row), Some(beacon)) = (self.map.moments_row(beacon), self.map.beacon(beacon))
        else {
            return;
        };
        for (sum, [deviation, mean]) in costs.iter_mut().zip(row.as_chunks().0) {
            let heard = if *deviation == 0 {
                0.0
            } else {
                let deviation = 0.25 * f32::from(*deviation);
                let variance = deviation * deviation + self.settings.inflation_variance();
                let above = 0.5 * f32::from(*mean) + LOWEST_MEAN_DBM - beacon.sensitivity_dbm;
                // Very nearly the normal distribution.
                1.0 / (1.0 + exp(-1.702 * above / sqrt(variance)))
            };
            let cost = -ln(1.0 - beacon.detection * heard) / self.step + 0.5;
            // Saturates, also where the absence is impossible.
            *sum += (cost as u16).min(FLOOR as u16);
        }
    }

    /// From the distance, and the deviation's entry in the table, in nine instructions of a Cortex-M4.
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

/// What stands in the table for a cost at no distance, and one for each squared half of a dB, both in 4096ths.
fn entry(none: f32, per_square: f32) -> u32 {
    // With distances of up to 296 halves of a dB, what [`GaussianMatcher::cost`] computes stays within 31 bits.
    let per_square = ((per_square + 0.5) as u32).min(24_000);
    // In steps of 16, with half a cost more, so that the result is rounded. A shift by 12 leaves 16ths of this, and of
    // the other half no more than 4.
    let none = ((none + 2048.0) * (1.0 / 16.0)) as u32;
    none << 16 | per_square
}

/// A strength in halves of a dB above the lowest mean, and the deviations and means of its beacon.
type Row<'a> = (i32, &'a [[u8; 2]]);

impl Matcher for GaussianMatcher<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, MatchError> {
        check::<P>(&self.map, scan)?;
        let costs = posterior
            .costs_mut(self.map.lattice().points())
            .ok_or(MatchError::Points)?;
        // Four rows at once to begin with, the others one by one.
        let mut first = [(0, [].as_slice()); 4];
        let mut filled = 0;
        let used = for_each_accepted(scan, &self.settings, |reading| {
            let row = self.row(reading);
            match first.get_mut(filled) {
                Some(place) => {
                    *place = row;
                    filled += 1;
                    if filled == 4 {
                        self.set_four(&first, costs);
                    }
                }
                None => self.add_one(row, costs),
            }
        })?;
        if filled < 4 {
            costs.fill(0);
            for row in first.into_iter().take(filled) {
                self.add_one(row, costs);
            }
        }
        if self.settings.missing() == Missing::Modelled {
            for beacon in missing(&self.map, scan, &self.settings) {
                self.add_missing(beacon, costs);
            }
        }
        let (located, cost) = posterior
            .of_costs(&self.map, &self.exponentials)
            .ok_or(MatchError::Survey)?;
        let log_likelihood = self.top * used as f32 - self.step * f32::from(cost);
        Ok(located.with(log_likelihood, used))
    }
}
