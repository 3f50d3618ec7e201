//! Two bearings as one.

use super::errors::Errors;
use super::term::{State, fold_angle};
use crate::aoa::gauss_newton::linearise;
use crate::aoa::{Bearing, Observation};
use crate::math::{atan2, sqrt, wrap};
use crate::snapshot::value;

/// A bearing in the buffer, which may stand for several.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) observation: Observation,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(super) probability: f32,
    /// How many readings it is the mean of,
    pub(super) readings: f32,
    /// and how many independent ones these are worth.
    pub(super) worth: f32,
    /// When the first of them was taken; the observation has the time of the last.
    pub(super) first_ms: u32,
}

impl Entry {
    pub(super) const fn new(observation: Observation, probability: f32) -> Self {
        Self {
            observation,
            probability,
            readings: 1.0,
            worth: 1.0,
            first_ms: observation.time_ms(),
        }
    }

    /// Takes one more reading of the same place into the mean, in which every reading counts alike: it adds `worth`
    /// independent readings to what the mean is worth, which is exact for errors of an autoregression of first order.
    pub(super) fn join(&mut self, new: &Self, worth: f32, source: Option<&State>) {
        // What one reading of the mean would tell on its own.
        let each = self.observation.information() / self.worth;
        let (n, fresh) = (self.readings, new.observation.information());
        let mean = (n * each + fresh) / (n + 1.0);
        let part = fresh / (n * each + fresh);
        let information = mean * (self.worth + worth);
        if let Some(one) = self.blend(new, part, information, source) {
            self.become_mean(one, new);
            self.worth += worth;
        }
    }

    /// Whether both may be of one reading, whose bearings meet where they were taken.
    pub(super) fn excludes(&self, other: &Self) -> bool {
        let (a, b) = (&self.observation, &other.observation);
        self.is_one_of_several() && other.is_one_of_several() && a.position() == b.position()
    }

    /// Bearings of different stations are never merged.
    pub(super) fn is_of_station_of(&self, other: &Self) -> bool {
        self.observation.station() == other.observation.station()
    }

    pub(super) fn is_one_of_several(&self) -> bool {
        self.probability < 1.0
    }

    /// Becomes the mean of both, in which every reading counts alike.
    fn become_mean(&mut self, mean: Observation, other: &Self) {
        self.observation = mean;
        let part = other.readings / (self.readings + other.readings);
        self.probability += part * (other.probability - self.probability);
        self.readings += other.readings;
        if mean.since_ms(other.first_ms) > mean.since_ms(self.first_ms) {
            self.first_ms = other.first_ms;
        }
    }

    /// Seconds between a time and the nearest of its readings, as far as that is known.
    pub(super) fn seconds_from(&self, time_ms: u32) -> f32 {
        let (before, behind) = (
            -self.observation.since_ms(self.first_ms),
            -self.observation.since_ms(time_ms),
        );
        let ms = if behind >= 0 {
            behind
        } else if behind < before {
            before - behind
        } else {
            0
        };
        1e-3 * ms as f32
    }

    /// Whether a reading of this station and time may be in it.
    pub(super) fn holds(&self, observation: &Observation) -> bool {
        let own = &self.observation;
        own.station() == observation.station()
            && (own.time_ms() == observation.time_ms() || self.first_ms == observation.time_ms())
    }

    fn blend(
        &self,
        other: &Self,
        part: f32,
        information: f32,
        source: Option<&State>,
    ) -> Option<Observation> {
        let turn = turn(self, other, source);
        let (a, b) = (&self.observation, &other.observation);
        blend(a, b, turn, part, information, source)
    }

    /// Takes another in, each counting by its information.
    pub(super) fn average(&mut self, other: &Self, source: Option<&State>) {
        let (a, b) = (&self.observation, &other.observation);
        let (ia, ib) = (a.information(), b.information());
        if let Some(one) = self.blend(other, ib / (ia + ib), ia + ib, source) {
            self.become_mean(one, other);
            self.worth += other.worth;
        }
    }
}

/// Whether two bearings may well be of the same direction: within three deviations of their difference.
///
/// Once it is known where the source is, a mirrored bearing says what a direct one does: they are lines.
pub(super) fn similar(a: &Entry, b: &Entry, source: Option<&State>, errors: &Errors) -> bool {
    let turn = turn(a, b, source);
    let [s, t] = [a, b].map(|entry| errors.variance(&entry.observation, 1.0, source));
    turn * turn < 9.0 * (s + t)
}

/// From one bearing to the other, as errors at the source if that is known.
fn turn(a: &Entry, b: &Entry, source: Option<&State>) -> f32 {
    let (one, other) = (&a.observation, &b.observation);
    match source {
        Some(&[x, y, _]) => {
            let [ea, eb] = [one, other].map(|o| linearise(o, [x, y]).residual);
            let turn = wrap(eb - ea);
            // Of bearings that have alternatives many point elsewhere, and half of those behind.
            if a.is_one_of_several() || b.is_one_of_several() {
                turn
            } else {
                fold_angle(turn)
            }
        }
        None => wrap(other.bearing().radians() - one.bearing().radians()),
    }
}

/// A bearing that is `part` of the way from `a` to `b`, which is `turn`, and worth `information`.
#[inline(never)]
fn blend(
    a: &Observation,
    b: &Observation,
    turn: f32,
    part: f32,
    information: f32,
    source: Option<&State>,
) -> Option<Observation> {
    let mix = |a: f32, b: f32| a + part * (b - a);
    let position = [
        mix(a.position()[0], b.position()[0]),
        mix(a.position()[1], b.position()[1]),
    ];
    let radians = match source {
        Some(&[x, y, _]) => {
            let [ea, eb] = [a, b].map(|o| linearise(o, [x, y]).residual);
            // A mirrored one only of two mirrored ones.
            let error = if ea.abs() <= eb.abs() {
                ea + part * turn
            } else {
                eb - (1.0 - part) * turn
            };
            atan2(y - position[1], x - position[0]) + error
        }
        None => a.bearing().radians() + part * turn,
    };
    let sigma = 1.0 / sqrt(information);
    let least = Observation::MIN_SIGMA_RAD;
    let sigma = if sigma > least { sigma } else { least };
    let latest = if b.since_ms(a.time_ms()) > 0 { b } else { a };
    Observation::new(
        latest.time_ms(),
        position,
        Bearing::from_radians(radians),
        sigma,
    )
    .map(|one| one.from_station(a.station()))
    .ok()
}

value!(Entry {
    observation,
    probability,
    readings,
    worth,
    first_ms,
});
