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
    /// How many readings it is the mean of,
    readings: f32,
    /// and how many independent ones these are worth.
    pub(super) worth: f32,
    /// Seconds since the last of them.
    pub(super) age_s: f32,
}

impl Sight {
    pub(super) const fn new(observation: Observation) -> Self {
        Self {
            observation,
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
    pub(super) fn join(&mut self, new: &Observation, worth: f32, source: Option<&State>) {
        // What one reading of the mean would tell on its own.
        let each = self.observation.information() / self.worth;
        let (n, fresh) = (self.readings, new.information());
        let mean = (n * each + fresh) / (n + 1.0);
        let share = fresh / (n * each + fresh);
        let information = mean * (self.worth + worth);
        if let Some(one) = blend(&self.observation, new, share, information, source) {
            self.observation = one;
            self.readings += 1.0;
            self.worth += worth;
        }
        self.age_s = 0.0;
    }

    /// Takes another in, each counting by its information.
    pub(super) fn average(&mut self, other: &Self, source: Option<&State>) {
        let (a, b) = (&self.observation, &other.observation);
        let (ia, ib) = (a.information(), b.information());
        if let Some(one) = blend(a, b, ib / (ia + ib), ia + ib, source) {
            self.observation = one;
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
pub(super) fn agree(
    a: &Observation,
    b: &Observation,
    source: Option<&State>,
    errors: &Errors,
) -> bool {
    let turn = turn(a, b, source);
    let [s, t] = [a, b].map(|o| errors.variance(o, 1.0, source));
    turn * turn < 9.0 * (s + t)
}

/// From one bearing to the other, as errors at the source if that is known.
fn turn(a: &Observation, b: &Observation, source: Option<&State>) -> f32 {
    match source {
        Some(&[x, y, _]) => {
            let [ea, eb] = [a, b].map(|o| linearise(o, [x, y]).residual);
            fold_angle(wrap(eb - ea))
        }
        None => wrap(b.bearing().radians() - a.bearing().radians()),
    }
}

/// A bearing that is `share` of the way from `a` to `b`, and worth `information`.
#[inline(never)]
fn blend(
    a: &Observation,
    b: &Observation,
    share: f32,
    information: f32,
    source: Option<&State>,
) -> Option<Observation> {
    let mix = |a: f32, b: f32| a + share * (b - a);
    let position = [
        mix(a.position()[0], b.position()[0]),
        mix(a.position()[1], b.position()[1]),
    ];
    let turn = turn(a, b, source);
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
    observation: Observation,
    readings: f32,
    worth: f32,
    age_s: f32,
});
