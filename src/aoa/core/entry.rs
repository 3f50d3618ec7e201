//! One bearing of a buffer, which may stand for several.

use crate::aoa::triangulation::linearise;
use crate::aoa::words::Correction;
use crate::aoa::{Alternative, Bearing, Observation, Retract};
use crate::math::{atan2, larger, sqrt, wrap};
use crate::snapshot::value;

/// One bearing, or the mean of several of one station.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The bearing, with the time of the last reading.
    pub(in crate::aoa) observation: Observation,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(in crate::aoa) probability: f32,
    /// Number of readings averaged.
    pub(in crate::aoa) readings: f32,
    /// Number of places whose bearings were averaged: their errors are as good as independent.
    pub(in crate::aoa) worth: f32,
    /// When the first of them was taken.
    pub(in crate::aoa) first_ms: u32,
    /// By what it was corrected.
    pub(in crate::aoa) correction: Correction,
}

value!(Entry {
    observation,
    probability,
    readings,
    worth,
    first_ms,
    correction,
});

/// How much of what an entry stands for is to be taken back.
pub(super) enum Part {
    None,
    Some,
    All,
}

impl From<&Alternative> for Entry {
    fn from(bearing: &Alternative) -> Self {
        Self {
            correction: bearing.correction(),
            ..Self::new(*bearing.observation(), bearing.probability())
        }
    }
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
            correction: Correction::NONE,
        }
    }

    pub(in crate::aoa) fn position(&self) -> [f32; 2] {
        self.observation.position()
    }

    /// Is corrected by something else than before.
    pub(in crate::aoa) fn correct(&mut self, by: &Correction) {
        self.observation = self.correction.replace(by, &self.observation);
    }

    /// Whether it is of one place, and not the mean of several.
    pub(in crate::aoa) fn is_of_one_place(&self) -> bool {
        self.worth == 1.0
    }

    /// How much of it is to be taken back.
    pub(super) fn part_of(&self, what: &Retract) -> Part {
        let last = &self.observation;
        let all_if = |whole: bool| if whole { Part::All } else { Part::Some };
        match *what {
            Retract::Bearing { time_ms, station } => {
                let since_first = time_ms.wrapping_sub(self.first_ms) as i32;
                let is_within = last.since_ms(time_ms) >= 0 && since_first >= 0;
                if last.station() != station || !is_within {
                    Part::None
                } else {
                    all_if(last.time_ms() == time_ms && self.first_ms == time_ms)
                }
            }
            Retract::Span { from_ms, until_ms } => {
                let first = |time_ms: u32| time_ms.wrapping_sub(self.first_ms) as i32;
                if last.since_ms(from_ms) < 0 || first(until_ms) < 0 {
                    Part::None
                } else {
                    all_if(first(from_ms) <= 0 && last.since_ms(until_ms) <= 0)
                }
            }
            Retract::Place { position, radius_m } => {
                if square_of_distance(position, self.position()) > radius_m * radius_m {
                    Part::None
                } else {
                    // The mean of several places may be near one where none of them is.
                    all_if(self.is_of_one_place())
                }
            }
        }
    }

    /// How many readings it stands for, in which bearings that exclude each other are one.
    pub(in crate::aoa) fn weight(&self) -> f32 {
        self.probability * self.readings
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

    /// Whether they are, or the last of each: of several sources, those of one stop were heard at different times.
    pub(in crate::aoa) fn excludes_last(&self, other: &Self) -> bool {
        self.excludes(other) && self.observation.time_ms() == other.observation.time_ms()
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

    /// Seconds between the spans of the readings of two.
    pub(in crate::aoa) fn seconds_from(&self, other: &Self) -> f32 {
        let after = |a: &Self, b: &Self| {
            1e-3 * b.observation.since_ms(a.observation.time_ms()) as f32 - b.span_s()
        };
        let (forth, back) = (after(self, other), after(other, self));
        let gap = larger(forth, back);
        larger(gap, 0.0)
    }

    /// Seconds between the first and the last of the readings.
    pub(in crate::aoa) fn span_s(&self) -> f32 {
        1e-3 * self.observation.since_ms(self.first_ms) as f32
    }

    /// Takes other readings of the same place into the mean, in which every reading counts the same. They tell as much as
    /// one reading, in the mean: how much less their own errors are is for the caller to say, by the number of readings.
    pub(in crate::aoa) fn join(&mut self, other: &Self, comparison: &impl Comparison) {
        let [old, fresh] =
            [&*self, other].map(|entry| entry.readings * entry.observation.information());
        let part = fresh / (old + fresh);
        self.correction = self.correction.mixed(&other.correction, part);
        let readings = self.readings + other.readings;
        self.blend(other, part, (old + fresh) / readings, comparison);
    }

    /// Takes another in that says the same.
    pub(super) fn merge(&mut self, other: &Self, comparison: &impl Comparison) {
        if comparison.are_of_one_place(self, other) {
            self.join(other, comparison);
        } else {
            self.average(other, comparison);
        }
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
        let sigma = larger(sigma, least);
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
            self.observation = mean.from_station(a.station()).with_heading(a.heading());
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

/// How the bearings of a locator compare.
pub(in crate::aoa) trait Comparison {
    /// Where the source is thought to be, if anywhere.
    fn source(&self) -> Option<[f32; 2]>;

    /// The angle from one bearing to the other, of those that are the same but for whole turns.
    fn fold(&self, _a: &Entry, _b: &Entry, angle: f32) -> f32 {
        angle
    }

    /// Whether two bearings are of one place, where an error that they have in common is one.
    fn are_of_one_place(&self, _a: &Entry, _b: &Entry) -> bool {
        false
    }

    /// Whether two bearings may well be of the same direction.
    fn is_similar(&self, _a: &Entry, _b: &Entry) -> bool {
        true
    }

    /// How much would be lost with the one of two that contradict each other that is not kept, from nothing to one.
    fn stake(&self, _a: &Entry, _b: &Entry) -> f32 {
        0.0
    }

    /// Whether `a` is kept rather than `b`, which contradicts it.
    fn prefers(&self, _a: &Entry, _b: &Entry) -> bool {
        true
    }
}

/// Clean bearings, which never contradict each other, on a source that is thought to be here.
impl Comparison for Option<[f32; 2]> {
    fn source(&self) -> Option<[f32; 2]> {
        *self
    }
}

pub(in crate::aoa) fn square_of_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
