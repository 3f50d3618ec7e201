//! A simulated drive past sources, and a locator that is told of it bearing by bearing.

use foxhunt::aoa::{Bearing, Observation};
use foxhunt_simulation::{
    faults::Kind,
    scenario::{Reading, Scenario},
};
use serde::{Deserialize, Serialize};

use crate::{
    locators::{Any, Choice},
    messages::{Answer, Taken},
};

/// What is simulated, and what locates.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {
    /// The drive. Its seed is that of the locator, too.
    pub scenario: Scenario,
    /// The locator.
    pub locator: Choice,
}

/// A drive that can be gone through to and fro.
pub struct Hunt {
    scenario: Scenario,
    readings: Vec<Reading>,
    observations: Vec<Observation>,
    /// The probability of each bearing so far that it was an outlier when it was taken.
    outliers: Vec<Option<f32>>,
    /// The locator after every so many bearings, from none on.
    kept: Vec<Box<dyn Any>>,
    locator: Box<dyn Any>,
    position: usize,
}

/// The state after some bearings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// How many bearings were taken.
    pub position: usize,
    /// How many there are.
    pub count: usize,
    /// Seconds since the beginning.
    pub time_s: f64,
    /// Where the vehicle is, east and north.
    pub vehicle: [f64; 2],
    /// Its direction of travel.
    pub heading_deg: f32,
    /// Where the sources are, east and north.
    pub truth: Vec<[f64; 2]>,
    /// All bearings so far.
    pub bearings: Vec<Known>,
    /// What the locator knows.
    pub answer: Answer,
}

/// A bearing, and what it truly is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Known {
    /// As it was taken.
    #[serde(flatten)]
    pub taken: Taken,
    /// Whether it truly is an outlier.
    pub is_outlier: bool,
    /// Whether it truly is mirrored.
    pub is_mirrored: bool,
}

/// Bearings from one copy of the locator to the next: more copies take memory, fewer make going back slower.
const EVERY: usize = 16;

impl Hunt {
    /// At the beginning, before the first bearing.
    ///
    /// # Errors
    /// What is out of range, in plain words.
    pub fn new(options: Options) -> Result<Self, String> {
        let Options { scenario, locator } = options;
        let readings = scenario.readings().map_err(|error| error.to_string())?;
        let observations = readings.iter().map(observation).collect::<Result<_, _>>()?;
        let locator = locator
            .locator(scenario.seed)
            .ok_or("there is no locator with so many particles")?;
        Ok(Self {
            scenario,
            readings,
            observations,
            outliers: Vec::new(),
            kept: vec![locator.copied()],
            locator,
            position: 0,
        })
    }

    /// How many bearings there are.
    pub fn count(&self) -> usize {
        self.observations.len()
    }

    /// Goes to where so many bearings were taken, as far as there are.
    pub fn seek(&mut self, position: usize) {
        let position = position.min(self.count());
        if position < self.position {
            let from = (position / EVERY).min(self.kept.len() - 1);
            self.locator = self.kept[from].copied();
            self.position = from * EVERY;
        }
        while self.position < position {
            // A bearing that a locator does not take leaves it as it was.
            let observation = &self.observations[self.position];
            let _ = self.locator.push(observation);
            self.position += 1;
            if self.position > self.outliers.len() {
                self.outliers.push(self.locator.outlier(observation));
            }
            if self.position == self.kept.len() * EVERY {
                self.kept.push(self.locator.copied());
            }
        }
    }

    /// What is known there.
    pub fn state(&self) -> State {
        let last = self.position.saturating_sub(1);
        let reading = self.readings[last];
        let here = self.observations[last].position();
        let time_s = f64::from(reading.sight.time_ms) / 1e3;
        let bearings = self.observations.iter().zip(&self.readings).enumerate();
        State {
            position: self.position,
            count: self.count(),
            time_s,
            vehicle: reading.sight.position,
            heading_deg: Bearing::from_radians(reading.heading as f32).compass_degrees(),
            truth: self.scenario.places(time_s).collect(),
            bearings: bearings
                .take(self.position)
                .map(|(id, (observation, reading))| Known {
                    taken: self.locator.taken((id, observation), self.outliers[id]),
                    is_outlier: reading.kind == Kind::Outlier,
                    is_mirrored: reading.kind == Kind::Mirrored,
                })
                .collect(),
            answer: self.locator.answer(here),
        }
    }
}

fn observation(reading: &Reading) -> Result<Observation, String> {
    let heading = Bearing::from_radians(reading.heading as f32);
    Observation::try_from(reading.sight)
        .map(|observation| observation.with_heading(heading))
        .map_err(|error| error.to_string())
}
