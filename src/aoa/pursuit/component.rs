//! A normal distribution of where a source is and how fast, given what it has done so far.

use crate::aoa::Observation;
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::{Line, read};
use crate::math::sqrt;
use crate::random::{Rng, normal};

/// What `rest` is of one that drives.
pub(super) const DRIVING: f32 = -1.0;

/// Of a symmetric matrix of two rows: the first one, and the end of the second.
pub(super) type Symmetric = [f32; 3];

pub(super) fn matrix([xx, xy, yy]: Symmetric) -> [[f32; 2]; 2] {
    [[xx, xy], [xy, yy]]
}

/// Metres east and north, and metres a second.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    pub(super) place: [f32; 2],
    pub(super) velocity: [f32; 2],
    /// Covariance of the place,
    pub(super) place_spread: Symmetric,
    /// of the place (rows) with the velocity,
    pub(super) common: [[f32; 2]; 2],
    /// and of the velocity.
    pub(super) velocity_spread: Symmetric,
    /// For how many seconds it has been at rest: negative while it drives.
    pub(super) rest: f32,
}

/// What all bearings are off by alike, in its prior deviations, as it was known when the source departed. A bearing on
/// what moves tells next to nothing of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Offset {
    pub(super) mean: f32,
    pub(super) variance: f32,
}

impl Component {
    pub(super) const fn new() -> Self {
        Self::at_place([0.0; 2], [0.0; 3])
    }

    /// At rest.
    pub(super) const fn at_place(place: [f32; 2], place_spread: Symmetric) -> Self {
        Self {
            place,
            velocity: [0.0; 2],
            place_spread,
            common: [[0.0; 2]; 2],
            velocity_spread: [0.0; 3],
            rest: 0.0,
        }
    }

    /// Moves by `seconds` of the velocity, of which then `keep` is left.
    pub(super) fn travel(&mut self, seconds: f32, keep: f32) {
        let [u, v] = self.velocity;
        self.place = [self.place[0] + seconds * u, self.place[1] + seconds * v];
        self.velocity = [keep * u, keep * v];
        let ([[xu, xv], [yu, yv]], [uu, uv, vv]) = (self.common, self.velocity_spread);
        let [xx, xy, yy] = self.place_spread;
        // Both with the velocity, after the way.
        let [[ru, rv], [su, sv]] = [
            [xu + seconds * uu, xv + seconds * uv],
            [yu + seconds * uv, yv + seconds * vv],
        ];
        self.place_spread = [
            xx + seconds * (xu + ru),
            xy + seconds * (xv + su),
            yy + seconds * (yv + sv),
        ];
        self.common = [[ru, rv], [su, sv]].map(|row| row.map(|entry| keep * entry));
        self.velocity_spread = [uu, uv, vv].map(|entry| keep * keep * entry);
    }

    /// Adds noise to either axis: to the place, to place and velocity, to the velocity.
    pub(super) fn disturb(&mut self, place: f32, both: f32, velocity: f32) {
        self.place_spread[0] += place;
        self.place_spread[2] += place;
        self.common[0][0] += both;
        self.common[1][1] += both;
        self.velocity_spread[0] += velocity;
        self.velocity_spread[2] += velocity;
    }

    pub(super) fn set_velocity(&mut self, mean: [f32; 2], variance: f32) {
        self.velocity = mean;
        self.common = [[0.0; 2]; 2];
        self.velocity_spread = [variance, 0.0, variance];
    }

    pub(super) fn stop(&mut self, seconds: f32) {
        self.set_velocity([0.0; 2], 0.0);
        self.rest = seconds;
    }

    /// Whether it is at rest, and may well be at that place: within three deviations of their distance.
    pub(super) fn is_at(&self, place: &Self) -> bool {
        let [dx, dy] = [0, 1].map(|d: usize| self.place[d] - place.place[d]);
        let sum = |i: usize| self.place_spread[i] + place.place_spread[i];
        let [xx, xy, yy] = [0, 1, 2].map(sum);
        let square = yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy;
        self.rest >= 0.0 && square < 9.0 * (xx * yy - xy * xy)
    }

    /// What a bearing is off by as it is seen from a place, and what that place and that of the distribution add to its
    /// variance, with the gain of the place.
    fn foresee(
        &self,
        from: [f32; 2],
        observation: &Observation,
        errors: &Errors,
        offset: Offset,
    ) -> Sight {
        let [x, y] = from;
        let line = read(observation, errors, &[x, y, offset.mean]);
        let [gx, gy, gb] = line.gradient;
        let gain = self.gain(&line.gradient).place;
        let spread = gx * gain[0] + gy * gain[1];
        let spread = if spread > 0.0 { spread } else { 0.0 };
        let back = gx * (self.place[0] - x) + gy * (self.place[1] - y);
        Sight {
            gain,
            variance: line.error.variance + gb * gb * offset.variance + spread,
            expected: line.error.angle + back,
            line,
        }
    }

    /// Covariance of the place and of the velocity with a measurement of the place.
    fn gain(&self, &[gx, gy, ..]: &[f32; 3]) -> Gain {
        let ([xx, xy, yy], [[xu, xv], [yu, yv]]) = (self.place_spread, self.common);
        Gain {
            place: [gx * xx + gy * xy, gx * xy + gy * yy],
            velocity: [gx * xu + gy * yu, gx * xv + gy * yv],
        }
    }

    /// Adds a gain to the mean, and its square to the covariance, so many times.
    fn shift(&mut self, gain: &Gain, step: f32, factor: f32) {
        let ([px, py], [pu, pv]) = (gain.place, gain.velocity);
        self.place = [self.place[0] + step * px, self.place[1] + step * py];
        self.velocity = [self.velocity[0] + step * pu, self.velocity[1] + step * pv];
        let add = |[aa, ab, bb]: Symmetric, a: f32, b: f32| {
            [
                aa + factor * a * a,
                ab + factor * a * b,
                bb + factor * b * b,
            ]
        };
        self.place_spread = add(self.place_spread, px, py);
        self.velocity_spread = add(self.velocity_spread, pu, pv);
        let [[xu, xv], [yu, yv]] = self.common;
        self.common = [
            [xu + factor * px * pu, xv + factor * px * pv],
            [yu + factor * py * pu, yv + factor * py * pv],
        ];
    }

    /// Draws how far away it is, but for a deviation that is small beside that: a bearing from elsewhere is no linear
    /// measurement of what is long. Together they are the distribution that it was.
    pub(super) fn divide<R: Rng + ?Sized>(&mut self, from: [f32; 2], rng: &mut R) {
        /// Deviation that is left, as a share of the distance.
        const LEFT: f32 = 0.1;
        let (dx, dy) = (self.place[0] - from[0], self.place[1] - from[1]);
        // All of this times the distance.
        let square = dx * dx + dy * dy + 1.0;
        let gain = self.gain(&[dx, dy, 0.0]);
        let variance = dx * gain.place[0] + dy * gain.place[1];
        let left = LEFT * LEFT * square * square;
        if variance > left {
            let drawn = (1.0 - left / variance) / variance;
            self.shift(&gain, sqrt(drawn) * normal(rng), -drawn);
        }
    }

    /// Odds of a bearing not being wild, and whether it is mirrored then.
    pub(super) fn odds(
        &self,
        observation: &Observation,
        errors: &Errors,
        offset: Offset,
    ) -> (f32, bool) {
        let sight = self.foresee(self.place, observation, errors, offset);
        (sight.odds(errors), sight.line.error.mirrored)
    }

    /// Takes a bearing, by a Kalman filter that counts it for as much as it is not wild, and returns one plus its odds.
    ///
    /// Bearings are no linear measurement: the gain is that of where they leave the state, found in a few steps (the
    /// iterated filter: Bell and Cathey 1993).
    pub(super) fn take(
        &mut self,
        observation: &Observation,
        errors: &Errors,
        offset: Offset,
    ) -> f32 {
        const AGAIN: u32 = 2;
        let mut sight = self.foresee(self.place, observation, errors, offset);
        let odds = sight.odds(errors);
        let fit = odds / (1.0 + odds);
        if fit >= 0.5 {
            for _ in 0..AGAIN {
                let shift = sight.expected / sight.variance;
                let [x, y] = [0, 1].map(|d: usize| self.place[d] - sight.gain[d] * shift);
                sight = self.foresee([x, y], observation, errors, offset);
            }
        }
        let shift = sight.expected / sight.variance;
        let gain = self.gain(&sight.line.gradient);
        // Of both possibilities together: less if it was not wild, more for what lies between them.
        let factor = fit * (1.0 - fit) * shift * shift - fit / sight.variance;
        self.shift(&gain, -fit * shift, factor);
        1.0 + odds
    }
}

struct Gain {
    place: [f32; 2],
    velocity: [f32; 2],
}

/// A bearing as a normal distribution foretells it.
struct Sight {
    line: Line,
    /// Covariance of the place with it.
    gain: [f32; 2],
    variance: f32,
    /// What it is off by from the mean, by the line.
    expected: f32,
}

impl Sight {
    fn odds(&self, errors: &Errors) -> f32 {
        (self.line.error).odds(self.expected, self.variance, errors)
    }
}
