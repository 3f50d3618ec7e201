//! A bearing in the buffer, which may stand for several.

use crate::aoa::gauss_newton::linearise;
use crate::aoa::{Bearing, Observation};
use crate::math::{atan2, sqrt, wrap};
use crate::snapshot::value;

/// One bearing, or the mean of several of one station.
#[derive(Debug, Clone, Copy)]
pub(in crate::aoa) struct Entry {
    /// The bearing, with the time of the last reading.
    pub(in crate::aoa) observation: Observation,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(in crate::aoa) probability: f32,
    /// How many readings it is the mean of,
    pub(in crate::aoa) readings: f32,
    /// and how many independent ones these are worth.
    pub(in crate::aoa) worth: f32,
    /// When the first of them was taken.
    pub(in crate::aoa) first_ms: u32,
}

value!(Entry {
    observation,
    probability,
    readings,
    worth,
    first_ms,
});

/// How the bearings of a locator compare.
pub(in crate::aoa) trait Comparison {
    /// Where the source is thought to be, if anywhere.
    fn source(&self) -> Option<[f32; 2]>;

    /// The angle from one bearing to the other, of those that are the same but for whole turns.
    fn fold(&self, a: &Entry, b: &Entry, angle: f32) -> f32;

    /// Whether two bearings may well be of the same direction.
    fn is_similar(&self, a: &Entry, b: &Entry) -> bool;

    /// Whether `a` is kept rather than `b`, which contradicts it.
    fn prefers(&self, a: &Entry, b: &Entry) -> bool;
}

impl AsRef<Observation> for Entry {
    fn as_ref(&self) -> &Observation {
        &self.observation
    }
}

impl Entry {
    pub(in crate::aoa) const fn new(observation: Observation, probability: f32) -> Self {
        Self {
            observation,
            probability,
            readings: 1.0,
            worth: 1.0,
            first_ms: observation.time_ms(),
        }
    }

    pub(in crate::aoa) fn position(&self) -> [f32; 2] {
        self.observation.position()
    }

    /// Whether it may be one of several bearings of a reading, which exclude each other.
    pub(in crate::aoa) fn is_one_of_several(&self) -> bool {
        self.probability < 1.0
    }

    /// Whether both may be of one reading, whose bearings meet where they were taken.
    pub(in crate::aoa) fn excludes(&self, other: &Self) -> bool {
        let both = self.is_one_of_several() && other.is_one_of_several();
        both && self.position() == other.position()
    }

    /// Bearings of different stations are never merged.
    pub(in crate::aoa) fn is_of_station_of(&self, other: &Self) -> bool {
        self.observation.station() == other.observation.station()
    }

    /// Whether a reading of this station and time is known to be in it.
    pub(in crate::aoa) fn holds(&self, reading: &Observation) -> bool {
        let last = &self.observation;
        last.station() == reading.station()
            && (last.time_ms() == reading.time_ms() || self.first_ms == reading.time_ms())
    }

    /// Seconds between a time and the span of the readings.
    pub(in crate::aoa) fn seconds_from(&self, time_ms: u32) -> f32 {
        let to_last = self.observation.since_ms(time_ms);
        let span = self.observation.since_ms(self.first_ms);
        let ms = if to_last < 0 {
            -to_last
        } else {
            to_last.saturating_sub(span).max(0)
        };
        1e-3 * ms as f32
    }

    /// Takes one more reading of the same place into the mean, in which every reading counts alike: it adds `worth`
    /// independent readings to what the mean is worth, which is exact for errors of an autoregression of first order.
    pub(in crate::aoa) fn join(&mut self, new: &Self, worth: f32, comparison: &impl Comparison) {
        // What one reading of the mean would tell on its own.
        let each = self.observation.information() / self.worth;
        let (n, fresh) = (self.readings, new.observation.information());
        let mean = (n * each + fresh) / (n + 1.0);
        let part = fresh / (n * each + fresh);
        self.blend(new, part, mean * (self.worth + worth), comparison);
        self.worth += worth;
    }

    /// Takes another in, each counting by its information.
    pub(in crate::aoa) fn average(&mut self, other: &Self, comparison: &impl Comparison) {
        let [a, b] = [self.observation, other.observation].map(|o| o.information());
        self.blend(other, b / (a + b), a + b, comparison);
        self.worth += other.worth;
    }

    /// Becomes the bearing that is `part` of the way to `other` and worth `information`.
    ///
    /// The error that it has at the source is the average of theirs; far sources see the two under equal angles.
    fn blend(&mut self, other: &Self, part: f32, information: f32, comparison: &impl Comparison) {
        let (a, b) = (&self.observation, &other.observation);
        let mix = |a: f32, b: f32| a + part * (b - a);
        let (from, to) = (a.position(), b.position());
        let position = [mix(from[0], to[0]), mix(from[1], to[1])];
        let [ea, eb] = [self, other].map(|entry| entry.angle(comparison.source()));
        let turn = comparison.fold(self, other, wrap(eb - ea));
        // A mirrored one only of two mirrored ones.
        let error = if comparison.source().is_none() || ea.abs() <= eb.abs() {
            ea + part * turn
        } else {
            eb - (1.0 - part) * turn
        };
        let direction = comparison
            .source()
            .map_or(0.0, |[x, y]| atan2(y - position[1], x - position[0]));
        let sigma = 1.0 / sqrt(information);
        let least = Observation::MIN_SIGMA_RAD;
        let sigma = if sigma > least { sigma } else { least };
        let time_ms = (if b.since_ms(a.time_ms()) > 0 { b } else { a }).time_ms();
        let bearing = Bearing::from_radians(direction + error);
        // What lies between two observations is one.
        if let Ok(mean) = Observation::new(time_ms, position, bearing, sigma) {
            let part = other.readings / (self.readings + other.readings);
            self.probability += part * (other.probability - self.probability);
            self.readings += other.readings;
            if mean.since_ms(other.first_ms) > mean.since_ms(self.first_ms) {
                self.first_ms = other.first_ms;
            }
            self.observation = mean.from_station(a.station());
        }
    }

    /// Error of the bearing at the source; the bearing itself if it is not known where that is.
    fn angle(&self, source: Option<[f32; 2]>) -> f32 {
        match source {
            Some(source) => linearise(&self.observation, source).residual,
            None => self.observation.bearing().radians(),
        }
    }

    /// The angle from this bearing to another, as errors at the source if that is known.
    pub(in crate::aoa) fn turn(&self, other: &Self, comparison: &impl Comparison) -> f32 {
        let [a, b] = [self, other].map(|entry| entry.angle(comparison.source()));
        comparison.fold(self, other, wrap(b - a))
    }
}
