//! A site survey: at known places, many readings from every beacon.

use alloc::vec::Vec;

/// The samples of a survey.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// Where the samples were taken, in metres.
    pub places: Vec<[f64; 2]>,
    /// The readings in dBm, by place and beacon; a beacon that was not heard there has none.
    pub samples: Vec<Vec<Vec<f64>>>,
}

/// Mean and variance of the readings of one beacon at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Mean, in dBm.
    pub mean: f64,
    /// Unbiased variance, in dB^2.
    pub variance: f64,
    /// The number of readings.
    pub count: usize,
}

impl Survey {
    /// Mean and variance of `beacon` at the place of that index; `None` with fewer than two readings.
    pub fn level(&self, place: usize, beacon: usize) -> Option<Level> {
        let samples = self.samples.get(place)?.get(beacon)?;
        if samples.len() < 2 {
            return None;
        }
        let count = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let squares = samples.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>();
        Some(Level {
            mean,
            variance: squares / (count - 1.0),
            count: samples.len(),
        })
    }

    /// The number of beacons.
    pub fn beacons(&self) -> usize {
        self.samples.iter().map(Vec::len).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    #[test]
    fn levels_are_those_of_the_samples() {
        let survey = Survey {
            places: vec![[0.0, 0.0]],
            samples: vec![vec![vec![-60.0, -64.0, -62.0], vec![-70.0]]],
        };
        let level = survey.level(0, 0).unwrap();
        assert_eq!((level.mean, level.variance, level.count), (-62.0, 4.0, 3));
        assert_eq!(survey.level(0, 1), None);
        assert_eq!(survey.level(1, 0), None);
        assert_eq!(survey.beacons(), 2);
    }
}
