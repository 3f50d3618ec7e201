//! A model whose noise is not normal but gamma distributed, and measured precisely.
//!
//! x_t = 1 + sin(omega pi (t - 1)) + x / 2 + v, v gamma with shape 3 and rate 2; z = 0.2 x^2 + n up to step 30,
//! x / 2 - 2 + n after it, n normal; x_0 = 1. Li, Wang and Wang, J. Electronics & Information Technology 33 (2011),
//! after van der Merwe et al., "The unscented particle filter" (2000). 50 steps. The paper prints omega = 0.4;
//! its table is that of 0.04. Its measurement variance is 1e-5, for which the transition hardly matters; variances
//! up to 1 make the problem one of filtering.

use core::f32::consts::PI;

use foxhunt::kalman::Covariance;
use foxhunt::math::{ln, sin_cos, sqrt};
use foxhunt::model::{Dynamics, Likelihood};
use foxhunt::proposal::{Sensor, Transition};
use foxhunt::random::{Rng, normal, uniform_open};

/// State before the first step.
pub const START: f32 = 1.0;

const SHAPE: f32 = 3.0;
const RATE: f32 = 2.0;

/// How the state comes to step `step`, counted from one. Time in seconds plays no part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GammaNoise {
    /// t
    pub step: u32,
    /// Of the drift: 0.04, or 0.4 as printed.
    pub omega: f32,
}

/// What was measured at a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// t
    pub step: u32,
    /// z
    pub value: f32,
    /// Variance of its noise.
    pub variance: f32,
}

/// An endless run: for each step from the first, its dynamics, the state there and the measurement of it with a
/// noise of variance `variance`.
pub fn simulate<R: Rng + ?Sized>(
    omega: f32,
    variance: f32,
    rng: &mut R,
) -> impl Iterator<Item = (GammaNoise, f32, Measurement)> + use<'_, R> {
    let mut state = START;
    (1..).map(move |step| {
        let dynamics = GammaNoise { step, omega };
        [state] = dynamics.step([state], 1.0, rng);
        let value = expected(step, state) + sqrt(variance) * normal(rng);
        let measurement = Measurement {
            step,
            value,
            variance,
        };
        (dynamics, state, measurement)
    })
}

fn expected(step: u32, x: f32) -> f32 {
    if step <= 30 {
        0.2 * x * x
    } else {
        0.5 * x - 2.0
    }
}

/// Gamma with this shape and scale 1.
///
/// Marsaglia and Tsang, "A simple method for generating gamma variables" (2000). Bounded: after 16 rejections in a row,
/// one chance in 10^20, it returns the mode of the proposal.
fn standard_gamma<R: Rng + ?Sized>(rng: &mut R) -> f32 {
    const TRIES: u32 = 16;
    let d = SHAPE - 1.0 / 3.0;
    let c = 1.0 / (3.0 * sqrt(d));
    for _ in 0..TRIES {
        let x = normal(rng);
        let v = 1.0 + c * x;
        let u = uniform_open(rng);
        if v <= 0.0 {
            continue;
        }
        let v = v * v * v;
        if ln(u) < 0.5 * x * x + d * (1.0 - v + ln(v)) {
            return d * v;
        }
    }
    d
}

impl GammaNoise {
    /// The successor of `x` if there were no noise: none can be less.
    fn base(&self, x: f32) -> f32 {
        let (sin, _) = sin_cos(self.omega * PI * (self.step as f32 - 1.0));
        1.0 + sin + 0.5 * x
    }
}

impl Dynamics<1> for GammaNoise {
    fn step<R: Rng + ?Sized>(&self, [x]: [f32; 1], _dt: f32, rng: &mut R) -> [f32; 1] {
        [self.base(x) + standard_gamma(rng) / RATE]
    }
}

impl Transition<1> for GammaNoise {
    fn mean(&self, [x]: &[f32; 1], _dt: f32) -> [f32; 1] {
        [self.base(*x) + SHAPE / RATE]
    }

    fn noise(&self, _dt: f32) -> Covariance<1> {
        Covariance::diagonal([sqrt(SHAPE) / RATE])
    }

    fn log_transition(&self, [from]: &[f32; 1], [to]: &[f32; 1], _dt: f32) -> f32 {
        let noise = to - self.base(*from);
        if noise > 0.0 {
            // rate^shape / (shape - 1)! = 4
            ln(4.0 * noise * noise) - RATE * noise
        } else {
            f32::NEG_INFINITY
        }
    }
}

impl Likelihood<1> for Measurement {
    fn log_likelihood(&self, state: &[f32; 1]) -> f32 {
        let [residual] = self.residual(state);
        -0.5 * (residual * residual / self.variance + ln(2.0 * PI * self.variance))
    }
}

impl Sensor<1, 1> for Measurement {
    fn residual(&self, [x]: &[f32; 1]) -> [f32; 1] {
        [self.value - expected(self.step, *x)]
    }

    fn noise(&self) -> Covariance<1> {
        Covariance::diagonal([sqrt(self.variance)])
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
    use std::vec::Vec;

    #[test]
    fn the_noise_has_the_distribution_of_its_shape() {
        const SAMPLES: usize = 1_000_000;
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(4);
        let mut samples: Vec<f64> = (0..SAMPLES)
            .map(|_| f64::from(standard_gamma(&mut rng)))
            .collect();
        samples.sort_by(f64::total_cmp);
        let cumulative = |x: f64| 1.0 - (-x).exp() * (1.0 + x + x * x / 2.0);
        let distances = samples.iter().enumerate();
        let distances = distances.map(|(i, &x)| (cumulative(x) - i as f64 / SAMPLES as f64).abs());
        // A Kolmogorov-Smirnov distance larger than this happens by chance once in a thousand seeds.
        let distance = distances.fold(0.0, f64::max);
        assert!(distance < 1.95e-3, "{distance}");
    }

    #[test]
    fn the_density_and_the_moments_are_those_of_the_steps() {
        // 200,000 steps: five standard errors of the mean are 0.01, of the variance 0.02.
        let dynamics = GammaNoise {
            step: 4,
            omega: 0.04,
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(41);
        let [mean] = dynamics.mean(&[3.0], 1.0);
        let [sigma] = dynamics.noise(1.0).sigmas();
        let (mut sum, mut squares) = (0f64, 0f64);
        for _ in 0..200_000 {
            let off = f64::from(dynamics.step([3.0], 1.0, &mut rng)[0] - mean);
            sum += off / 200_000.0;
            squares += off * off / 200_000.0;
        }
        assert!(sum.abs() < 0.01, "{sum}");
        assert!((squares - f64::from(sigma * sigma)).abs() < 0.02);
        let (mut mass, mut moment) = (0.0, 0.0);
        for i in 0..20_000 {
            let x = mean - 2.0 + i as f32 * 1e-3;
            let density = dynamics.log_transition(&[3.0], &[x], 1.0).exp();
            mass += density * 1e-3;
            moment += density * 1e-3 * (x - mean);
        }
        assert!(
            (mass - 1.0).abs() < 1e-3 && moment.abs() < 1e-3,
            "{mass} {moment}"
        );
    }
}
