//! A normal distribution of where a source is and how fast it moves, given what it has done so far.

use crate::aoa::Observation;
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::{Line, read};
use crate::estimate::Symmetric2;
use crate::math::sqrt;
use crate::random::{Rng, normal};
use crate::snapshot::value;

/// Standard deviation along the line of sight that [`Component::divide`] leaves, as a fraction of the distance: the smaller,
/// the better a bearing is linearised, and the more of the spread is left to the number of components.
const LEFT: f32 = 0.1;

/// Iterations of the iterated Kalman filter after the first linearisation: one less biases close passes, one more changes
/// nothing that is seen.
const ITERATIONS: u32 = 2;

/// Sigmas within which a component that has stopped is where the stationary source is: more join what is another stop, fewer
/// keep two explanations of one stop.
const SAME_PLACE: f32 = 3.0;

/// One component of the mixture, in metres east and north and metres a second.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    pub(super) position: [f32; 2],
    pub(super) velocity: [f32; 2],
    /// Covariance of the position.
    pub(super) position_covariance: Symmetric2,
    /// Covariance of the position (rows) with the velocity.
    pub(super) cross_covariance: [[f32; 2]; 2],
    /// Covariance of the velocity.
    pub(super) velocity_covariance: Symmetric2,
    /// For how many seconds it has been stationary; negative while it moves.
    pub(super) stationary_s: f32,
}

value!(Component {
    position,
    velocity,
    position_covariance,
    cross_covariance,
    velocity_covariance,
    stationary_s,
});

/// The common bias of all bearings, in its prior sigmas, as known when the source departed. A bearing on a source that moves
/// tells next to nothing of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownBias {
    pub(super) mean: f32,
    pub(super) variance: f32,
}

value!(KnownBias { mean, variance });

impl Component {
    /// A component that has just stopped at a place.
    pub(super) const fn stationary(position: [f32; 2], covariance: Symmetric2) -> Self {
        Self {
            position,
            velocity: [0.0; 2],
            position_covariance: covariance,
            cross_covariance: [[0.0; 2]; 2],
            velocity_covariance: Symmetric2::ZERO,
            stationary_s: 0.0,
        }
    }

    pub(super) fn is_stationary(&self) -> bool {
        self.stationary_s >= 0.0
    }

    /// Moves by `seconds` of the velocity, of which the fraction `keep` is left at the end.
    pub(super) fn travel(&mut self, seconds: f32, keep: f32) {
        let [u, v] = self.velocity;
        let [x, y] = self.position;
        self.position = [x + seconds * u, y + seconds * v];
        self.velocity = [keep * u, keep * v];
        let [[xu, xv], [yu, yv]] = self.cross_covariance;
        let Symmetric2 {
            xx: uu,
            xy: uv,
            yy: vv,
        } = self.velocity_covariance;
        // Position with velocity, at the end of the way.
        let [[ru, rv], [su, sv]] = [
            [xu + seconds * uu, xv + seconds * uv],
            [yu + seconds * uv, yv + seconds * vv],
        ];
        let Symmetric2 { xx, xy, yy } = &mut self.position_covariance;
        *xx += seconds * (xu + ru);
        *xy += seconds * (xv + su);
        *yy += seconds * (yv + sv);
        self.cross_covariance = [[ru, rv], [su, sv]].map(|row| row.map(|entry| keep * entry));
        self.velocity_covariance = self.velocity_covariance.scaled(keep * keep);
    }

    /// Adds noise on either axis: to the position, to position and velocity together, to the velocity.
    pub(super) fn disturb(&mut self, position: f32, both: f32, velocity: f32) {
        self.position_covariance =
            (self.position_covariance).plus(&Symmetric2::isotropic(position));
        self.cross_covariance[0][0] += both;
        self.cross_covariance[1][1] += both;
        self.velocity_covariance =
            (self.velocity_covariance).plus(&Symmetric2::isotropic(velocity));
    }

    pub(super) fn set_velocity(&mut self, mean: [f32; 2], variance: f32) {
        self.velocity = mean;
        self.cross_covariance = [[0.0; 2]; 2];
        self.velocity_covariance = Symmetric2::isotropic(variance);
    }

    /// Makes it one that stopped `seconds` ago.
    pub(super) fn stop(&mut self, seconds: f32) {
        self.set_velocity([0.0; 2], 0.0);
        self.stationary_s = seconds;
    }

    /// Whether it is stationary and may well be at that place.
    pub(super) fn is_at(&self, place: &Self) -> bool {
        let ([ax, ay], [bx, by]) = (self.position, place.position);
        let offset = [ax - bx, ay - by];
        let covariance = (self.position_covariance).plus(&place.position_covariance);
        self.is_stationary() && covariance.is_within(offset, SAME_PLACE)
    }

    /// Predicts the error of a bearing, linearised about a position.
    fn predict_bearing(
        &self,
        about: [f32; 2],
        observation: &Observation,
        errors: &Errors,
        bias: KnownBias,
    ) -> Prediction {
        let [x, y] = about;
        let line = read(observation, errors, &[x, y, bias.mean]);
        let [gx, gy, gb] = line.gradient;
        let gain = self.gain(&line.gradient).position;
        let spread = gx * gain[0] + gy * gain[1];
        let spread = if spread > 0.0 { spread } else { 0.0 };
        let back = gx * (self.position[0] - x) + gy * (self.position[1] - y);
        Prediction {
            gain,
            variance: line.variance + gb * gb * bias.variance + spread,
            error: line.error + back,
            line,
        }
    }

    /// Covariance of position and velocity with a measurement of the position.
    fn gain(&self, &[gx, gy, ..]: &[f32; 3]) -> Gain {
        let [[xu, xv], [yu, yv]] = self.cross_covariance;
        Gain {
            position: self.position_covariance.times([gx, gy]),
            velocity: [gx * xu + gy * yu, gx * xv + gy * yv],
        }
    }

    /// Adds `step` gains to the mean, and `factor` squares of the gain to the covariance.
    fn shift(&mut self, gain: &Gain, step: f32, factor: f32) {
        let ([px, py], [pu, pv]) = (gain.position, gain.velocity);
        let ([x, y], [u, v]) = (self.position, self.velocity);
        self.position = [x + step * px, y + step * py];
        self.velocity = [u + step * pu, v + step * pv];
        self.position_covariance = self.position_covariance.plus_outer(factor, [px, py]);
        self.velocity_covariance = self.velocity_covariance.plus_outer(factor, [pu, pv]);
        let [[xu, xv], [yu, yv]] = self.cross_covariance;
        self.cross_covariance = [
            [xu + factor * px * pu, xv + factor * px * pv],
            [yu + factor * py * pu, yv + factor * py * pv],
        ];
    }

    /// Draws the distance from a place, up to a standard deviation that is small beside it: a bearing from elsewhere is no
    /// linear measurement of a long distribution. All draws together have the distribution from before.
    pub(super) fn divide<R: Rng + ?Sized>(&mut self, from: [f32; 2], rng: &mut R) {
        let (dx, dy) = (self.position[0] - from[0], self.position[1] - from[1]);
        // Everything times the distance.
        let square = dx * dx + dy * dy + 1.0;
        let gain = self.gain(&[dx, dy, 0.0]);
        let variance = dx * gain.position[0] + dy * gain.position[1];
        let left = LEFT * LEFT * square * square;
        if variance > left {
            let drawn = (1.0 - left / variance) / variance;
            self.shift(&gain, sqrt(drawn) * normal(rng), -drawn);
        }
    }

    /// Odds that a bearing is no outlier, and whether it is mirrored then.
    pub(super) fn odds(
        &self,
        observation: &Observation,
        errors: &Errors,
        bias: KnownBias,
    ) -> (f32, bool) {
        let prediction = self.predict_bearing(self.position, observation, errors, bias);
        (prediction.odds(errors), prediction.line.mirrored)
    }

    /// Takes a bearing, by a Kalman filter that counts it for as much as it is no outlier, and returns one plus its odds.
    ///
    /// Bearings are no linear measurement: the gain is that of where they leave the state, found in a few steps (the
    /// iterated filter: Bell and Cathey 1993).
    pub(super) fn update(
        &mut self,
        observation: &Observation,
        errors: &Errors,
        bias: KnownBias,
    ) -> f32 {
        let mut prediction = self.predict_bearing(self.position, observation, errors, bias);
        let odds = prediction.odds(errors);
        let fit = odds / (1.0 + odds);
        if fit >= 0.5 {
            for _ in 0..ITERATIONS {
                let shift = prediction.error / prediction.variance;
                let ([x, y], [gx, gy]) = (self.position, prediction.gain);
                let about = [x - gx * shift, y - gy * shift];
                prediction = self.predict_bearing(about, observation, errors, bias);
            }
        }
        let shift = prediction.error / prediction.variance;
        let gain = self.gain(&prediction.line.gradient);
        // The moments of both possibilities together: less variance if it was no outlier, more for what lies between them.
        let factor = fit * (1.0 - fit) * shift * shift - fit / prediction.variance;
        self.shift(&gain, -fit * shift, factor);
        1.0 + odds
    }
}

struct Gain {
    position: [f32; 2],
    velocity: [f32; 2],
}

/// The error of a bearing as a component predicts it.
struct Prediction {
    line: Line,
    /// Covariance of the position with it.
    gain: [f32; 2],
    variance: f32,
    /// The error at the mean, by the linearisation.
    error: f32,
}

impl Prediction {
    fn odds(&self, errors: &Errors) -> f32 {
        self.line.odds(self.error, self.variance, errors)
    }
}
