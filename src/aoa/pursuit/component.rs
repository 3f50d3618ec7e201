//! A normal distribution of where a source is and how fast, given what it has done so far.

use crate::aoa::Observation;
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::{Line, read};

/// Metres east and north, velocity in metres a second, and the bias of all bearings in its prior deviations.
pub(super) const STATES: usize = 5;

pub(super) type Vector = [f32; STATES];
pub(super) type Matrix = [Vector; STATES];

/// What `rest` is of one that drives.
pub(super) const DRIVING: f32 = -1.0;

#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    pub(super) mean: Vector,
    pub(super) covariance: Matrix,
    /// For how many seconds it has been at rest: negative while it drives.
    pub(super) rest: f32,
}

impl Component {
    pub(super) const fn new() -> Self {
        Self {
            mean: [0.0; STATES],
            covariance: [[0.0; STATES]; STATES],
            rest: DRIVING,
        }
    }

    /// Of a place and the bias, at rest.
    pub(super) fn at_place(mean: [f32; 3], covariance: [[f32; 3]; 3]) -> Self {
        let [x, y, bias] = mean;
        let [[xx, xy, xb], [_, yy, yb], [_, _, bb]] = covariance;
        Self {
            mean: [x, y, 0.0, 0.0, bias],
            covariance: [
                [xx, xy, 0.0, 0.0, xb],
                [xy, yy, 0.0, 0.0, yb],
                [0.0; STATES],
                [0.0; STATES],
                [xb, yb, 0.0, 0.0, bb],
            ],
            rest: 0.0,
        }
    }

    /// Moves by `seconds` of the velocity, of which then `keep` is left.
    pub(super) fn travel(&mut self, seconds: f32, keep: f32) {
        let step = |row: &mut Vector| {
            row[0] += seconds * row[2];
            row[1] += seconds * row[3];
            row[2] *= keep;
            row[3] *= keep;
        };
        step(&mut self.mean);
        self.covariance.iter_mut().for_each(step);
        let [x, y, u, v, _] = &mut self.covariance;
        for (((x, y), u), v) in x.iter_mut().zip(y).zip(u).zip(v) {
            *x += seconds * *u;
            *y += seconds * *v;
            *u *= keep;
            *v *= keep;
        }
    }

    /// Adds noise to either axis: to the place, to place and velocity, to the velocity.
    pub(super) fn disturb(&mut self, place: f32, both: f32, velocity: f32) {
        let [x, y, u, v, _] = &mut self.covariance;
        x[0] += place;
        y[1] += place;
        x[2] += both;
        u[0] += both;
        y[3] += both;
        v[1] += both;
        u[2] += velocity;
        v[3] += velocity;
    }

    pub(super) fn set_velocity(&mut self, mean: [f32; 2], variance: f32) {
        [self.mean[2], self.mean[3]] = mean;
        for row in &mut self.covariance {
            row[2] = 0.0;
            row[3] = 0.0;
        }
        let [_, _, u, v, _] = &mut self.covariance;
        *u = [0.0, 0.0, variance, 0.0, 0.0];
        *v = [0.0, 0.0, 0.0, variance, 0.0];
    }

    pub(super) fn stop(&mut self, seconds: f32) {
        self.set_velocity([0.0; 2], 0.0);
        self.rest = seconds;
    }

    /// Whether it is at rest, and may well be at that place: within three deviations of their distance.
    pub(super) fn is_at(&self, place: &Self) -> bool {
        let [dx, dy] = [0, 1].map(|d: usize| self.mean[d] - place.mean[d]);
        let sum = |a: usize, b: usize| self.covariance[a][b] + place.covariance[a][b];
        let (xx, xy, yy) = (sum(0, 0), sum(0, 1), sum(1, 1));
        let square = yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy;
        self.rest >= 0.0 && square < 9.0 * (xx * yy - xy * xy)
    }

    /// Takes a bearing, by a Kalman filter that counts it for as much as it is not wild, and returns one plus its odds.
    ///
    /// Bearings are no linear measurement: the gain is that of where they leave the state, found in a few steps (the
    /// iterated filter: Bell and Cathey 1993).
    pub(super) fn take(&mut self, observation: &Observation, errors: &Errors) -> f32 {
        const AGAIN: u32 = 2;
        let prior = self.mean;
        let mut state = prior;
        let mut answer = 1.0;
        let mut update = (0.0, [0.0; STATES], 1.0, 0.0);
        for turn in 0..=AGAIN {
            let place = [state[0], state[1], state[4]];
            let Line { error, gradient } = read(observation, errors, &place);
            let [gx, gy, gb] = gradient;
            // P H'
            let gain = self
                .covariance
                .map(|row| gx * row[0] + gy * row[1] + gb * row[4]);
            let spread = gx * gain[0] + gy * gain[1] + gb * gain[4];
            let spread = if spread > 0.0 { spread } else { 0.0 };
            let variance = error.variance + spread;
            // What the error was before, as it is seen from here.
            let back = gx * (prior[0] - state[0])
                + gy * (prior[1] - state[1])
                + gb * (prior[4] - state[4]);
            let expected = error.angle + back;
            if turn == 0 {
                answer = 1.0 + error.odds(expected, variance, errors);
            }
            let fit = 1.0 - 1.0 / answer;
            update = (expected, gain, variance, fit);
            if turn == AGAIN || fit < 0.5 {
                break;
            }
            for ((state, prior), gain) in state.iter_mut().zip(prior).zip(gain) {
                *state = prior - gain * expected / variance;
            }
        }
        let (expected, gain, variance, fit) = update;
        for (mean, gain) in self.mean.iter_mut().zip(gain) {
            *mean -= fit * gain * expected / variance;
        }
        // Of both possibilities together: less if it was not wild, more for what lies between them.
        let shift = expected / variance;
        let factor = fit * (1.0 - fit) * shift * shift - fit / variance;
        for (row, a) in self.covariance.iter_mut().zip(gain) {
            for (entry, b) in row.iter_mut().zip(gain) {
                *entry += factor * (a * b);
            }
        }
        answer
    }
}
