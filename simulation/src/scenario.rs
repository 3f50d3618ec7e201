//! A vehicle that drives past sources and takes bearings of them.

use alloc::vec::Vec;
use core::fmt;

use rand::{Rng, RngExt};

use crate::{
    Sight,
    faults::{Faults, Kind},
    path::Path,
    random::{generator, normal},
    sight::{direction, wrap},
};

/// The most readings of a scenario.
pub const MAX_READINGS: usize = 2_000;

/// What is simulated. The same scenario gives the same readings on every platform.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Scenario {
    /// The seed of all errors.
    pub seed: u64,
    /// The way of the vehicle; the scenario ends where it ends.
    pub vehicle: Way,
    /// The ways of the sources; one of a single corner is at rest.
    pub sources: Vec<Way>,
    /// Seconds from one reading to the next. Each is of one source, which is drawn.
    pub interval_s: f64,
    /// Standard deviation of a bearing, in radians.
    pub sigma_rad: f64,
    /// Rate of bearings that are uniform on the circle.
    pub outlier_rate: f64,
    /// Rate of bearings that are turned by half a circle.
    pub mirrored_rate: f64,
    /// The common error of all bearings that are not outliers, in radians counter-clockwise.
    pub bias_rad: f64,
}

/// A line at a constant speed.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Way {
    /// In metres east and north.
    pub corners: Vec<[f64; 2]>,
    /// In metres a second.
    pub speed_m_s: f64,
    /// When it starts, in seconds.
    pub start_s: f64,
}

/// One bearing, and what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// What a locator gets.
    pub sight: Sight,
    /// Direction of travel, in radians counter-clockwise from east.
    pub heading: f64,
    /// The number of the source. An outlier has one, too.
    pub source: usize,
    /// What the bearing says of it.
    pub kind: Kind,
}

/// What a scenario cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The vehicle has no corners, or one of them, its speed or its start is not a number in range.
    Vehicle,
    /// There is no source, or one is out of range as a vehicle may be.
    Source,
    /// The interval is below 10 ms, or there would be more than [`MAX_READINGS`].
    Interval,
    /// The standard deviation is not above zero.
    Sigma,
    /// A rate is outside 0 to 1, or they add up to more.
    Rates,
    /// The bias is not a number.
    Bias,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vehicle => "the vehicle needs a track, a speed above zero and a start",
            Self::Source => "a source needs a place, and a speed above zero if it moves",
            Self::Interval => "the interval is below 10 ms, or there are more than 2,000 readings",
            Self::Sigma => "the standard deviation is not above zero",
            Self::Rates => "the rates of outliers and mirrored bearings are outside 0 to 1",
            Self::Bias => "the bias is not a number",
        })
    }
}

impl core::error::Error for ScenarioError {}

impl Scenario {
    /// All readings in the order of time.
    ///
    /// # Errors
    /// Names what is out of range.
    pub fn readings(&self) -> Result<Vec<Reading>, ScenarioError> {
        self.check()?;
        let vehicle = self.vehicle.path();
        let sources: Vec<Path> = self.sources.iter().map(Way::path).collect();
        let [start, end] = vehicle.times().ok_or(ScenarioError::Vehicle)?;
        let count = ((end - start) / self.interval_s) as usize + 1;
        if count > MAX_READINGS {
            return Err(ScenarioError::Interval);
        }
        let mut rng = generator(self.seed, 0);
        let mut heading = 0.0;
        let mut readings = Vec::with_capacity(count);
        for index in 0..count {
            let time = start + index as f64 * self.interval_s;
            let here = vehicle.held(time).ok_or(ScenarioError::Vehicle)?;
            let next = vehicle.held(time + 1.0).ok_or(ScenarioError::Vehicle)?;
            if next != here {
                heading = direction(here, next);
            }
            let source = rng.random_range(0..sources.len());
            let place = sources[source].held(time).ok_or(ScenarioError::Source)?;
            readings.push(self.reading(time, here, heading, (source, place), &mut rng));
        }
        Ok(readings)
    }

    /// Where each source is, at a time in seconds.
    pub fn places(&self, seconds: f64) -> impl Iterator<Item = [f64; 2]> {
        let at = move |way: &Way| way.path().held(seconds);
        self.sources.iter().filter_map(at)
    }

    fn reading(
        &self,
        time: f64,
        here: [f64; 2],
        heading: f64,
        (source, place): (usize, [f64; 2]),
        rng: &mut impl Rng,
    ) -> Reading {
        let faults = Faults {
            outlier_rate: self.outlier_rate,
            mirrored_rate: self.mirrored_rate,
            bias_sigma: 0.0,
        };
        let error = self.sigma_rad * normal(rng);
        let mut sight = Sight {
            time_ms: libm::round(1e3 * time) as u32,
            position: here,
            bearing: wrap(direction(here, place) + error),
            sigma: self.sigma_rad,
        };
        let kind = faults.spoil_one(&mut sight, self.bias_rad, rng);
        Reading {
            sight,
            heading,
            source,
            kind,
        }
    }

    fn check(&self) -> Result<(), ScenarioError> {
        let is_rate = |rate: f64| (0.0..=1.0).contains(&rate);
        let requirements = [
            (self.vehicle.is_valid(), ScenarioError::Vehicle),
            (!self.sources.is_empty(), ScenarioError::Source),
            (
                self.sources.iter().all(Way::is_valid),
                ScenarioError::Source,
            ),
            (
                self.interval_s >= 0.01 && self.interval_s.is_finite(),
                ScenarioError::Interval,
            ),
            (
                self.sigma_rad > 0.0 && self.sigma_rad.is_finite(),
                ScenarioError::Sigma,
            ),
            (
                is_rate(self.outlier_rate)
                    && is_rate(self.mirrored_rate)
                    && is_rate(self.outlier_rate + self.mirrored_rate),
                ScenarioError::Rates,
            ),
            (self.bias_rad.is_finite(), ScenarioError::Bias),
        ];
        let failed = requirements.iter().find(|(holds, _)| !holds);
        failed.map_or(Ok(()), |(_, error)| Err(*error))
    }
}

impl Way {
    /// The corners with their times.
    pub fn path(&self) -> Path {
        Path::along(&self.corners, self.speed_m_s, self.start_s)
    }

    /// Whether it has corners, and a start and a speed in range.
    pub fn is_valid(&self) -> bool {
        let is_place = |corner: &[f64; 2]| corner.iter().all(|metres| metres.is_finite());
        let moves = self.corners.len() > 1;
        !self.corners.is_empty()
            && self.corners.iter().all(is_place)
            && self.start_s >= 0.0
            && self.start_s.is_finite()
            && self.speed_m_s.is_finite()
            && (self.speed_m_s > 0.0 || !moves)
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    fn scenario() -> Scenario {
        Scenario {
            seed: 1,
            vehicle: Way {
                corners: vec![[0.0, 0.0], [1_000.0, 0.0], [1_000.0, 1_000.0]],
                speed_m_s: 10.0,
                start_s: 0.0,
            },
            sources: vec![Way {
                corners: vec![[300.0, 700.0]],
                speed_m_s: 0.0,
                start_s: 0.0,
            }],
            interval_s: 2.0,
            sigma_rad: 0.03,
            outlier_rate: 0.0,
            mirrored_rate: 0.0,
            bias_rad: 0.0,
        }
    }

    #[test]
    fn readings_are_along_the_way_and_point_at_the_source() {
        let readings = scenario().readings().unwrap();
        assert_eq!(readings.len(), 101);
        assert_eq!(readings[75].sight.position, [1_000.0, 500.0]);
        assert_eq!(readings[75].sight.time_ms, 150_000);
        for reading in &readings {
            assert_eq!(reading.kind, Kind::Direct);
            // Below five sigmas, as all but one of a million are.
            assert!(reading.sight.residual([300.0, 700.0]).abs() < 0.15);
        }
        let headings: Vec<f64> = readings.iter().map(|reading| reading.heading).collect();
        assert_eq!(headings[0], 0.0);
        assert!((headings[100] - core::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }

    #[test]
    fn outliers_are_marked_and_the_bias_is_in_the_others() {
        let scenario = Scenario {
            outlier_rate: 0.3,
            bias_rad: 0.2,
            sigma_rad: 1e-6,
            ..scenario()
        };
        let readings = scenario.readings().unwrap();
        let outliers = readings.iter().filter(|r| r.kind == Kind::Outlier).count();
        assert!((15..46).contains(&outliers), "{outliers}");
        for reading in readings.iter().filter(|r| r.kind == Kind::Direct) {
            assert!((reading.sight.residual([300.0, 700.0]) - 0.2).abs() < 1e-5);
        }
    }

    #[test]
    fn a_source_that_moves_is_where_it_is() {
        let mut scenario = scenario();
        scenario.sigma_rad = 1e-6;
        scenario.sources[0] = Way {
            corners: vec![[0.0, 500.0], [600.0, 500.0]],
            speed_m_s: 5.0,
            start_s: 20.0,
        };
        assert!(scenario.places(10.0).eq([[0.0, 500.0]]));
        assert!(scenario.places(60.0).eq([[200.0, 500.0]]));
        assert!(scenario.places(190.0).eq([[600.0, 500.0]]));
        let readings = scenario.readings().unwrap();
        assert!(readings[30].sight.residual([200.0, 500.0]).abs() < 1e-5);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let with = |change: fn(&mut Scenario)| {
            let mut scenario = scenario();
            change(&mut scenario);
            scenario.readings().unwrap_err()
        };
        assert_eq!(with(|s| s.vehicle.corners.clear()), ScenarioError::Vehicle);
        assert_eq!(with(|s| s.vehicle.speed_m_s = 0.0), ScenarioError::Vehicle);
        assert_eq!(with(|s| s.sources.clear()), ScenarioError::Source);
        assert_eq!(with(|s| s.interval_s = 0.05), ScenarioError::Interval);
        assert_eq!(with(|s| s.interval_s = f64::NAN), ScenarioError::Interval);
        assert_eq!(with(|s| s.sigma_rad = 0.0), ScenarioError::Sigma);
        assert_eq!(with(|s| s.mirrored_rate = 1.1), ScenarioError::Rates);
        assert_eq!(with(|s| s.bias_rad = f64::INFINITY), ScenarioError::Bias);
    }
}
