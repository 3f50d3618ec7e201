//! Two bearings as one.

use super::errors::Errors;
use super::term::{State, fold_angle};
use crate::aoa::gauss_newton::linearise;
use crate::aoa::{Bearing, Observation};
use crate::math::{atan2, sqrt, wrap};
use crate::snapshot::value;

/// A bearing in the buffer, which may stand for several.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) observation: Observation,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(super) share: f32,
    /// How many readings it is the mean of,
    readings: f32,
    /// and how many independent ones these are worth.
    pub(super) worth: f32,
    /// Seconds since the last of them.
    pub(super) age_s: f32,
}

impl Sight {
    pub(super) const fn new(observation: Observation, share: f32) -> Self {
        Self {
            observation,
            share,
            readings: 1.0,
            worth: 1.0,
            age_s: 0.0,
        }
    }

    /// How many readings it is the mean of.
    pub(super) const fn readings(&self) -> f32 {
        self.readings
    }

    /// Takes one more reading of the same place into the mean, in which every reading counts alike: it adds `worth`
    /// independent readings to what the mean is worth, which is exact for errors of an autoregression of first order.
    pub(super) fn join(&mut self, new: &Self, worth: f32, source: Option<&State>) {
        // What one reading of the mean would tell on its own.
        let each = self.observation.information() / self.worth;
        let (n, fresh) = (self.readings, new.observation.information());
        let mean = (n * each + fresh) / (n + 1.0);
        let share = fresh / (n * each + fresh);
        let information = mean * (self.worth + worth);
        if let Some(one) = self.blend(new, share, information, source) {
            self.observation = one;
            self.share = self.mean_share(new);
            self.readings += 1.0;
            self.worth += worth;
        }
        self.age_s = 0.0;
    }

    /// Whether both may be of one reading, whose bearings meet where they were taken.
    pub(super) fn excludes(&self, other: &Self) -> bool {
        let (a, b) = (&self.observation, &other.observation);
        self.is_one_of_several() && other.is_one_of_several() && a.position() == b.position()
    }

    pub(super) fn is_one_of_several(&self) -> bool {
        self.share < 1.0
    }

    /// Of both, in which every reading counts alike.
    fn mean_share(&self, other: &Self) -> f32 {
        let part = other.readings / (self.readings + other.readings);
        self.share + part * (other.share - self.share)
    }

    fn blend(
        &self,
        other: &Self,
        share: f32,
        information: f32,
        source: Option<&State>,
    ) -> Option<Observation> {
        let turn = turn(self, other, source);
        let (a, b) = (&self.observation, &other.observation);
        blend(a, b, turn, share, information, source)
    }

    /// Takes another in, each counting by its information.
    pub(super) fn average(&mut self, other: &Self, source: Option<&State>) {
        let (a, b) = (&self.observation, &other.observation);
        let (ia, ib) = (a.information(), b.information());
        if let Some(one) = self.blend(other, ib / (ia + ib), ia + ib, source) {
            self.observation = one;
            self.share = self.mean_share(other);
            self.readings += other.readings;
            self.worth += other.worth;
            if other.age_s < self.age_s {
                self.age_s = other.age_s;
            }
        }
    }
}

/// Whether two bearings may well be of the same direction: within three deviations of their difference.
///
/// Once it is known where the source is, a mirrored bearing says what a direct one does: they are lines.
pub(super) fn agree(a: &Sight, b: &Sight, source: Option<&State>, errors: &Errors) -> bool {
    let turn = turn(a, b, source);
    let [s, t] = [a, b].map(|sight| errors.variance(&sight.observation, 1.0, source));
    turn * turn < 9.0 * (s + t)
}

/// From one bearing to the other, as errors at the source if that is known.
fn turn(a: &Sight, b: &Sight, source: Option<&State>) -> f32 {
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

/// A bearing that is `share` of the way from `a` to `b`, which is `turn`, and worth `information`.
#[inline(never)]
fn blend(
    a: &Observation,
    b: &Observation,
    turn: f32,
    share: f32,
    information: f32,
    source: Option<&State>,
) -> Option<Observation> {
    let mix = |a: f32, b: f32| a + share * (b - a);
    let position = [
        mix(a.position()[0], b.position()[0]),
        mix(a.position()[1], b.position()[1]),
    ];
    let radians = match source {
        Some(&[x, y, _]) => {
            let [ea, eb] = [a, b].map(|o| linearise(o, [x, y]).residual);
            // A mirrored one only of two mirrored ones.
            let error = if ea.abs() <= eb.abs() {
                ea + share * turn
            } else {
                eb - (1.0 - share) * turn
            };
            atan2(y - position[1], x - position[0]) + error
        }
        None => a.bearing().radians() + share * turn,
    };
    let deviation = 1.0 / sqrt(information);
    let least = Observation::MIN_DEVIATION_RAD;
    let deviation = if deviation > least { deviation } else { least };
    Observation::new(position, Bearing::from_radians(radians), deviation).ok()
}

value!(Sight {
    observation,
    share,
    readings,
    worth,
    age_s,
});
