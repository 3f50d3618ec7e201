//! Matching by normal densities.

use core::f32::consts::TAU;

use super::{
    Encoding, MAX_READINGS, MapError, Match, MatchError, Matcher, Missing, Posterior, RadioMap,
    Reading, Settings, check, map::LOWEST_MEAN_DBM, missing, posterior::Exponentials,
};
use crate::math::{exp, ln, sqrt};

/// Compares scans with the mean and the deviation of every beacon at every point.
///
/// The likelihood of a reading is the larger one of the normal density, with the deviation of the map and the inflation
/// of the settings, and of the uniform density of the outliers: nearly their sum (max-mixture of Olson and Agarwal,
/// 2013), and all of it is done in whole numbers. Its logarithm has steps of a 255th of the largest loss,
/// 0.03 to 0.05.
///
/// Takes 800 bytes.
#[derive(Debug, Clone)]
pub struct GaussianMatcher<'a> {
    map: RadioMap<'a>,
    settings: Settings,
    /// By deviation: the cost of a squared distance of 1/4 dB^2, in 4096ths, and above it the cost at no distance.
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
        let mut costs = [(FLOOR as u32) << 16; 64];
        for (code, cost) in costs.iter_mut().enumerate().skip(1) {
            let distance = 4096.0 * 0.25 * 0.5 / (variance(code) * step);
            let none = (top - log_density(code)) / step;
            *cost = ((none + 0.5) as u32) << 16 | ((distance + 0.5) as u32).min(MOST_PER_SQUARE);
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

    /// Four readings in one pass, because the sum is kept in a register.
    fn add_four(&self, [a, b, c, d]: [Row<'_>; 4], costs: &mut [u16]) {
        let rows = a.1.iter().zip(b.1).zip(c.1).zip(d.1);
        for (sum, (((pair_a, pair_b), pair_c), pair_d)) in costs.iter_mut().zip(rows) {
            let [a, b, c, d] = [(a, pair_a), (b, pair_b), (c, pair_c), (d, pair_d)]
                .map(|((strength, _), pair)| self.cost(strength, *pair) as u16);
            *sum += a + b + c + d;
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

    #[inline(always)]
    fn cost(&self, strength: i32, pair: [u8; 2]) -> i32 {
        let pair = u16::from_le_bytes(pair);
        let distance = strength - i32::from(pair >> 8);
        let square = distance.wrapping_mul(distance) as u32;
        let cost = self.costs[usize::from(pair & 63)];
        let far = square.wrapping_mul(cost & 0xffff) >> 12;
        (far as i32 + (cost >> 16) as i32).clamp(0, FLOOR)
    }
}

/// A strength in halves of a dB above the lowest mean, and the deviations and means of its beacon.
type Row<'a> = (i32, &'a [[u8; 2]]);

impl Matcher for GaussianMatcher<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, MatchError> {
        let used = check::<P>(&self.map, scan, &self.settings)?;
        let costs = posterior
            .costs_mut(self.map.lattice().points())
            .ok_or(MatchError::Points)?;
        costs.fill(0);
        let mut rows = scan
            .iter()
            .filter(|reading| self.settings.accepts(reading.rssi_dbm))
            .map(|reading| self.row(reading));
        // No more than the sums can hold.
        for _ in 0..MAX_READINGS / 4 {
            let four = [rows.next(), rows.next(), rows.next(), rows.next()];
            if let [Some(a), Some(b), Some(c), Some(d)] = four {
                self.add_four([a, b, c, d], costs);
                continue;
            }
            for row in four.into_iter().flatten() {
                self.add_one(row, costs);
            }
            break;
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

/// With distances of up to 296 halves of a dB, the product with their squares stays within 32 bits.
const MOST_PER_SQUARE: u32 = 48_000;
