//! What a tag remembers of the error of the map.
//!
//! The error of a map is a field: readings near each other have nearly the same. A reading near those before it hence tells
//! less than the first, and says more about how far the tag has moved than about where it is. Along the way of a tag the error
//! of each beacon is a process that is forgotten by distance, and by time, because people and doors move; its Kalman
//! filter is linear in the levels, so that what differs from particle to particle is only where the particle was.

use super::Config;
use super::pending::Level;
use crate::fingerprint::map::LOWEST_MEAN_DBM;
use crate::math::exp;
use crate::persist;

const LEVEL: f32 = 256.0;
const FRACTION: f32 = 255.0;

/// What is known of the error of a beacon before a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prior {
    /// The mean level of the readings before, in dBm.
    pub level_dbm: f32,
    /// How much of their mean difference from the map is expected of the next.
    pub weight: f32,
    /// The fraction of the variance of the error that is not known.
    pub unknown: f32,
}

impl Prior {
    /// Nothing.
    pub const NONE: Self = Self {
        level_dbm: 0.0,
        weight: 0.0,
        unknown: 1.0,
    };
}

/// The readings of all beacons that still tell of the error of the map where the tag is.
#[derive(Debug, Clone)]
pub(super) struct Memory<const B: usize> {
    /// By beacon, their weighted mean level, in 256ths of a dB above the lowest.
    levels: [u16; B],
    /// The sum of their weights, in 255ths: how much of the level's mean is taken for the error. It is also taken for the
    /// fraction of the variance of the error that they explain, which is right at one place, and a little much along a way.
    weights: [u8; B],
    /// How long ago they were, in seconds: the weighted mean.
    pub age_s: f32,
}

impl<const B: usize> Memory<B> {
    /// In bits that are all zero.
    pub const EMPTY: Self = Self {
        levels: [0; B],
        weights: [0; B],
        age_s: 0.0,
    };

    /// What is known of the error of a beacon.
    #[inline(always)]
    pub fn prior(&self, beacon: usize) -> Prior {
        match (self.levels.get(beacon), self.weights.get(beacon)) {
            (Some(level), Some(weight)) => {
                let weight = f32::from(*weight) * (1.0 / FRACTION);
                Prior {
                    level_dbm: f32::from(*level) * (1.0 / LEVEL) + LOWEST_MEAN_DBM,
                    weight,
                    unknown: 1.0 - weight,
                }
            }
            _ => Prior::NONE,
        }
    }

    /// Lets `dt` seconds pass, in which the tag moves by `moved_m`, on a map with an error of this length.
    #[inline(never)]
    pub fn fade(&mut self, dt: f32, moved_m: f32, length_m: f32, config: &Config) {
        // Without a length, readings are independent.
        let kept = if length_m > 0.0 {
            exp(-moved_m / length_m - dt / config.error_memory_s)
        } else {
            0.0
        };
        self.age_s += dt;
        for weight in &mut self.weights {
            // The conversion saturates.
            *weight = (f32::from(*weight) * kept + 0.5) as u8;
        }
    }

    /// Takes in a scan. For each beacon `noise` says how large the variance of its mean level is, relative to that of the
    /// error of the map; none leaves it out.
    #[inline(never)]
    pub fn learn(&mut self, scan: &[Level; B], noise: impl Fn(usize, &Level) -> Option<f32>) {
        let (mut old, mut new) = (0.0, 0.0);
        for (beacon, level) in scan.iter().enumerate() {
            if level.packets == 0 {
                continue;
            }
            let Prior {
                level_dbm,
                weight,
                unknown,
            } = self.prior(beacon);
            let Some(noise) = noise(beacon, level) else {
                continue;
            };
            let gain = unknown / (unknown + noise);
            let before = (1.0 - gain) * weight;
            let sum = before + gain;
            old += before;
            new += gain;
            let mean = level_dbm + gain / sum * (level.mean_dbm - level_dbm);
            if let (Some(level), Some(weight)) =
                (self.levels.get_mut(beacon), self.weights.get_mut(beacon))
            {
                *level = ((mean - LOWEST_MEAN_DBM) * LEVEL + 0.5) as u16;
                *weight = (sum * FRACTION + 0.5) as u8;
            }
        }
        if old + new > 0.0 {
            self.age_s *= old / (old + new);
        }
    }
}

persist!(impl[const B: usize] Memory<B> as "Memory"(B) { levels, weights, age_s });

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(mean_dbm: f32) -> [Level; 1] {
        [Level {
            mean_dbm,
            packets: 1,
            doubt_db2: 0.0,
        }]
    }

    #[test]
    fn at_one_place_the_error_gets_known_as_by_a_mean() {
        let mut memory = Memory::<1>::EMPTY;
        for n in 1..=20u8 {
            memory.learn(&heard(-60.0), |_, _| Some(1.0));
            let prior = memory.prior(0);
            let mean = f32::from(n) / (f32::from(n) + 1.0);
            assert!((prior.weight - mean).abs() < 0.02, "{n} {prior:?}");
            assert!((prior.unknown - 1.0 / (f32::from(n) + 1.0)).abs() < 0.02);
            assert_eq!(prior.level_dbm, -60.0);
        }
    }

    #[test]
    fn what_is_far_away_is_forgotten() {
        let mut memory = Memory::<1>::EMPTY;
        memory.learn(&heard(-60.0), |_, _| Some(0.0));
        memory.fade(0.1, 2.0, 2.0, &Config::DEFAULT);
        let prior = memory.prior(0);
        assert!((prior.weight - 0.36).abs() < 0.01, "{prior:?}");
        assert!((prior.unknown - 0.64).abs() < 0.01);
        memory.fade(0.1, 0.0, 0.0, &Config::DEFAULT);
        assert_eq!(memory.prior(0).weight, 0.0);
        assert_eq!(memory.prior(0).unknown, 1.0);
    }

    /// Half was known, of which exp(-0.4) is left after 2 s: 0.335. Of the 0.6 that a scan leaves known, it is 0.201.
    #[test]
    fn what_is_remembered_ages_until_something_is_learned() {
        let mut memory = Memory::<1>::EMPTY;
        memory.learn(&heard(-60.0), |_, _| Some(1.0));
        let config = Config {
            error_memory_s: 5.0,
            ..Config::DEFAULT
        };
        memory.fade(2.0, 0.0, 2.0, &config);
        assert_eq!(memory.age_s, 2.0);
        memory.learn(&heard(-60.0), |_, _| None);
        assert_eq!(memory.age_s, 2.0);
        memory.learn(&heard(-60.0), |_, _| Some(1.0));
        assert!((memory.age_s - 2.0 * 0.335).abs() < 0.01, "{memory:?}");
        let mut nothing = Memory::<1>::EMPTY;
        nothing.learn(&heard(-60.0), |_, _| None);
        assert_eq!(nothing.age_s, 0.0);
    }
}
