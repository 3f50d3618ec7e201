//! A particle filter of somebody who walks among arrays, which knows how he walks and how the arrays err.

use nalgebra::{Matrix2, Vector2};
use rand::{Rng, RngExt};

use crate::{
    stations::Stations,
    walker::{Gait, Walker},
};
use foxhunt_simulation::{Sight, random::normal};

/// A bootstrap filter over walks. The biases of the arrays are marginalised: given a walk, they are normal (Rao-Blackwellised
/// filtering, Doucet and others 2000), whatever the errors have in common from one reading to the next. It knows all but the
/// room: where he starts, it knows no better than a locator with `Config::ROOM` does.
pub struct Walkers {
    walker: Walker,
    stations: Stations,
    interval_s: f64,
    count: usize,
    particles: Vec<Particle>,
    log_weights: Vec<f64>,
    /// Variance of each bias: the same for all walks.
    variances: [f64; 4],
}

#[derive(Clone, Copy)]
struct Particle {
    gait: Gait,
    /// Mean of each bias, and the latest residual of each array.
    biases: [f64; 4],
    residuals: [f64; 4],
}

impl Walkers {
    /// So many walks that start anywhere about the room; rounds of readings come at this interval.
    pub fn new(
        walker: Walker,
        stations: Stations,
        interval_s: f64,
        particles: usize,
        rng: &mut impl Rng,
    ) -> Self {
        /// How far outside the room he may be as well: then the area is that within `range_m` of `robust::Config::ROOM`.
        const MARGIN: f64 = 14.0;
        /// Starts for each walk that goes on after the first round, which excludes most of the area.
        const STARTS: usize = 10;
        let starts = STARTS * particles;
        let particle = |_| Particle {
            gait: walker.start_within(MARGIN, rng),
            biases: [0.0; 4],
            residuals: [f64::NAN; 4],
        };
        Self {
            walker,
            stations,
            interval_s,
            count: particles,
            particles: (0..starts).map(particle).collect(),
            log_weights: vec![0.0; starts],
            variances: [stations.bias_sigma.powi(2); 4],
        }
    }

    /// Takes a round of readings, of one of each array: mean and covariance of the place.
    pub fn push(
        &mut self,
        round: &[(u8, Sight)],
        rng: &mut impl Rng,
    ) -> (Vector2<f64>, Matrix2<f64>) {
        let is_first = self.particles.iter().any(|p| p.residuals[0].is_nan());
        if !is_first {
            for particle in &mut self.particles {
                (self.walker).advance(&mut particle.gait, self.interval_s, rng);
            }
        }
        for (station, sight) in round {
            self.weigh(usize::from(*station), sight, is_first);
        }
        let weights = self.weights();
        let mean = sum(&self.particles, &weights, |place| place);
        let scatter: Matrix2<f64> = (self.particles.iter().zip(&weights))
            .map(|(particle, weight)| {
                let off = Vector2::from(particle.gait.position) - mean;
                off * off.transpose() * *weight
            })
            .sum();
        let worth = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        if is_first || worth < 0.5 * self.count as f64 {
            self.resample(&weights, rng);
        }
        (mean, scatter)
    }

    /// Weighs by a reading: of an autoregression, by what is new in it.
    fn weigh(&mut self, k: usize, sight: &Sight, is_first: bool) {
        let correlation = (-self.interval_s / self.stations.time_s).exp();
        let (kept, square) = if is_first {
            (0.0, 1.0)
        } else {
            (correlation, 1.0 - correlation * correlation)
        };
        let noise = square * self.stations.sigma.powi(2);
        let slope = 1.0 - kept;
        let variance = slope * slope * self.variances[k] + noise;
        let gain = slope * self.variances[k] / variance;
        for (particle, log_weight) in self.particles.iter_mut().zip(&mut self.log_weights) {
            let residual = sight.residual(particle.gait.position);
            let before = if is_first { 0.0 } else { particle.residuals[k] };
            let new = residual - kept * before - slope * particle.biases[k];
            *log_weight -= 0.5 * new * new / variance;
            particle.biases[k] += gain * new;
            particle.residuals[k] = residual;
        }
        self.variances[k] *= 1.0 - gain * slope;
    }

    fn weights(&mut self) -> Vec<f64> {
        let largest = self.log_weights.iter().copied().fold(f64::MIN, f64::max);
        self.log_weights.iter_mut().for_each(|log| *log -= largest);
        let total: f64 = self.log_weights.iter().map(|log| log.exp()).sum();
        (self.log_weights.iter())
            .map(|log| log.exp() / total)
            .collect()
    }

    /// Systematically; copies are set a centimetre apart, so that those who stand differ.
    fn resample(&mut self, weights: &[f64], rng: &mut impl Rng) {
        const JITTER_M: f64 = 0.01;
        let count = self.count;
        let mut left = rng.random::<f64>();
        let mut chosen = Vec::with_capacity(count);
        for (particle, weight) in self.particles.iter().zip(weights) {
            left += weight * count as f64;
            while left >= 1.0 && chosen.len() < count {
                left -= 1.0;
                let mut copy = *particle;
                for coordinate in &mut copy.gait.position {
                    *coordinate += JITTER_M * normal(rng);
                }
                chosen.push(copy);
            }
        }
        while let Some(last) = self.particles.last()
            && chosen.len() < count
        {
            chosen.push(*last);
        }
        self.particles = chosen;
        self.log_weights = vec![0.0; count];
    }
}

fn sum(
    particles: &[Particle],
    weights: &[f64],
    of: impl Fn(Vector2<f64>) -> Vector2<f64>,
) -> Vector2<f64> {
    (particles.iter().zip(weights))
        .map(|(particle, weight)| of(particle.gait.position.into()) * *weight)
        .sum()
}
