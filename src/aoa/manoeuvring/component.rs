//! A normal distribution of where a source is and how fast it moves, given what it has done so far.

use super::biases::{Gain, StationBiases, at};
use crate::aoa::Observation;
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::{Line, read};
use crate::estimate::Symmetric2;
use crate::math::{larger, sqrt};
use crate::random::{Rng, normal};
use crate::snapshot::value;

/// Standard deviation along the line of sight that [`Component::divide`] leaves, as a fraction of the distance: the smaller,
/// the better a bearing is linearised, and the more of the spread is left to the number of components.
const LEFT: f32 = 0.1;

/// Iterations of the iterated Kalman filter after the first linearisation: one less biases close passes, one more changes
/// nothing that is seen. Among stations, nobody passes so close, and one is as good as more.
const ITERATIONS: u32 = 2;
const ITERATIONS_AMONG_STATIONS: u32 = 1;

/// Sigmas within which a component that has stopped is where the stationary source is: more join what is another stop, fewer
/// keep two explanations of one stop.
const SAME_PLACE: f32 = 3.0;

/// One component of the mixture, in metres east and north and metres a second, with the biases of `K` stations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component<const K: usize> {
    pub(super) position: [f32; 2],
    pub(super) velocity: [f32; 2],
    /// Covariance of the position.
    pub(super) position_covariance: Symmetric2,
    /// Covariance of the position (rows) with the velocity.
    pub(super) cross_covariance: [[f32; 2]; 2],
    /// Covariance of the velocity.
    pub(super) velocity_covariance: Symmetric2,
    /// For how many seconds it has been stationary; while it moves, how fast it may be as a fraction of the fastest, less
    /// than zero.
    pub(super) stationary_s: f32,
    /// What is known of the stations' biases.
    pub(super) biases: StationBiases<K>,
}

value!(impl[const K: usize] Component<K> as "Component", {
    position,
    velocity,
    position_covariance,
    cross_covariance,
    velocity_covariance,
    stationary_s,
    biases,
});

/// The common bias of all bearings, in its prior sigmas, as known when the source departed. A bearing on a source that moves
/// tells next to nothing of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownBias {
    pub(super) mean: f32,
    pub(super) variance: f32,
}

value!(KnownBias { mean, variance });

/// A bearing, and what is believed of its error.
#[derive(Clone, Copy)]
pub(super) struct Heard<'a> {
    pub(super) observation: &'a Observation,
    pub(super) errors: &'a Errors,
    pub(super) bias: KnownBias,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(super) probability: f32,
}

impl<const K: usize> Component<K> {
    /// A component that has just stopped at a place.
    pub(super) const fn stationary(position: [f32; 2], covariance: Symmetric2) -> Self {
        Self {
            position,
            velocity: [0.0; 2],
            position_covariance: covariance,
            cross_covariance: [[0.0; 2]; 2],
            velocity_covariance: Symmetric2::ZERO,
            stationary_s: 0.0,
            biases: StationBiases::NONE,
        }
    }

    pub(super) fn is_stationary(&self) -> bool {
        self.stationary_s >= 0.0
    }

    /// How fast it may be while it moves, as a fraction of the fastest.
    pub(super) fn pace(&self) -> f32 {
        -self.stationary_s
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
        self.biases.travel(seconds, keep);
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

    /// Blurs the position by what it goes in a time that is not known, of this variance in square seconds.
    pub(super) fn blur(&mut self, square: f32) {
        let way = (self.velocity_covariance.scaled(square)).plus_outer(square, self.velocity);
        self.position_covariance = self.position_covariance.plus(&way);
    }

    pub(super) fn set_velocity(&mut self, mean: [f32; 2], variance: f32) {
        self.velocity = mean;
        self.cross_covariance = [[0.0; 2]; 2];
        self.velocity_covariance = Symmetric2::isotropic(variance);
        self.biases.forget_velocity();
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
    fn predict_bearing(&self, about: [f32; 2], heard: &Heard<'_>) -> Prediction<K> {
        let [x, y] = about;
        let Heard {
            observation, bias, ..
        } = heard;
        let line = read(observation, heard.errors, &[x, y, bias.mean]);
        let [gx, gy, gb] = line.gradient;
        let station = StationBiases::<K>::index(observation);
        let gain = self.gain([gx, gy], station);
        let own = station.map_or(0.0, |station| at(&gain.biases, station));
        let spread = gx * gain.position[0] + gy * gain.position[1] + own;
        let spread = larger(spread, 0.0);
        let back = gx * (self.position[0] - x) + gy * (self.position[1] - y);
        Prediction {
            gain,
            variance: line.variance + gb * gb * bias.variance + spread + self.bend([gx, gy]),
            error: line.error + self.biases.mean_of(station) + back,
            line,
        }
    }

    /// Variance of what a bearing of this gradient has beside the linear part: the second-order term of the filter (Jazwinski
    /// 1970, section 9.3). Only among stations, where the distance is not divided; zero elsewhere.
    fn bend(&self, [gx, gy]: [f32; 2]) -> f32 {
        if K == 0 {
            return 0.0;
        }
        let dot = |[a, b]: [f32; 2], [x, y]: [f32; 2]| a * x + b * y;
        let (across, along) = ([gx, gy], [gy, -gx]);
        let [pa, pl] = [across, along].map(|direction| self.position_covariance.times(direction));
        let both = dot(along, pa);
        dot(across, pa) * dot(along, pl) + both * both
    }

    /// Covariance of everything with a measurement of the position, and of the bias of a station.
    fn gain(&self, [gx, gy]: [f32; 2], station: Option<usize>) -> Gain<K> {
        let [[xu, xv], [yu, yv]] = self.cross_covariance;
        let mut gain = Gain {
            position: self.position_covariance.times([gx, gy]),
            velocity: [gx * xu + gy * yu, gx * xv + gy * yv],
            biases: self.biases.position.map(|[x, y]| gx * x + gy * y),
        };
        if let Some(station) = station {
            self.biases.add_to(&mut gain, station);
        }
        gain
    }

    /// Adds `step` gains to the mean, and `factor` squares of the gain to the covariance.
    fn shift(&mut self, gain: &Gain<K>, step: f32, factor: f32) {
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
        self.biases.shift(gain, step, factor);
    }

    /// Draws the distance from a place, up to a standard deviation that is small beside it: a bearing from elsewhere is no
    /// linear measurement of a long distribution. All draws together have the distribution from before.
    pub(super) fn divide<R: Rng + ?Sized>(&mut self, from: [f32; 2], rng: &mut R) {
        let (dx, dy) = (self.position[0] - from[0], self.position[1] - from[1]);
        // Everything times the distance.
        let square = dx * dx + dy * dy + 1.0;
        let gain = self.gain([dx, dy], None);
        let variance = dx * gain.position[0] + dy * gain.position[1];
        let left = LEFT * LEFT * square * square;
        if variance > left {
            let drawn = (1.0 - left / variance) / variance;
            self.shift(&gain, sqrt(drawn) * normal(rng), -drawn);
        }
    }

    /// One at rest about a place, before any bearing of a station, whose biases have that standard deviation.
    pub(super) fn among_stations(
        position: [f32; 2],
        covariance: Symmetric2,
        sigma_rad: f32,
    ) -> Self {
        Self {
            biases: StationBiases::new(sigma_rad),
            ..Self::stationary(position, covariance)
        }
    }

    /// Odds that a bearing is no outlier, and whether it is mirrored then.
    pub(super) fn odds(&self, heard: &Heard<'_>) -> (f32, bool) {
        let prediction = self.predict_bearing(self.position, heard);
        (prediction.odds(heard.errors), prediction.line.mirrored)
    }

    /// Takes the bearings of a reading, which exclude each other, by a Kalman filter that counts the likeliest of them for as much
    /// as it is the source's, and returns one plus the odds of all: those that lie apart are hardly ever likely both.
    pub(super) fn update<'a>(&mut self, reading: impl Iterator<Item = Heard<'a>>) -> f32 {
        let (mut total, mut most, mut likeliest) = (1.0, -1.0, None);
        for heard in reading {
            let prediction = self.predict_bearing(self.position, &heard);
            let odds = heard.probability * prediction.odds(heard.errors);
            total += odds;
            if odds > most {
                (most, likeliest) = (odds, Some((heard, prediction)));
            }
        }
        if let Some((heard, prediction)) = likeliest {
            self.take(&heard, prediction, most / total);
        }
        total
    }

    /// Takes a bearing as it was predicted, which is the source's with a probability.
    ///
    /// Bearings are no linear measurement: the gain is that of where they leave the state, found in a few steps (the
    /// iterated filter: Bell and Cathey 1993).
    fn take(&mut self, heard: &Heard<'_>, mut prediction: Prediction<K>, fit: f32) {
        if fit >= 0.5 {
            let iterations = if K == 0 {
                ITERATIONS
            } else {
                ITERATIONS_AMONG_STATIONS
            };
            for _ in 0..iterations {
                let shift = prediction.error / prediction.variance;
                let ([x, y], [gx, gy]) = (self.position, prediction.gain.position);
                let about = [x - gx * shift, y - gy * shift];
                prediction = self.predict_bearing(about, heard);
            }
        }
        let shift = prediction.error / prediction.variance;
        // The moments of both possibilities together: less variance if it was no outlier, more for what lies between them.
        let factor = fit * (1.0 - fit) * shift * shift - fit / prediction.variance;
        self.shift(&prediction.gain, -fit * shift, factor);
    }
}

/// The error of a bearing as a component predicts it.
struct Prediction<const K: usize> {
    line: Line,
    /// Covariance of everything with it.
    gain: Gain<K>,
    variance: f32,
    /// The error at the mean, by the linearisation.
    error: f32,
}

impl<const K: usize> Prediction<K> {
    fn odds(&self, errors: &Errors) -> f32 {
        self.line.odds(self.error, self.variance, errors)
    }
}
