//! The numerics by which the paper's table was made, as far as they can be told from it and from the programs of
//! the original study of the unscented particle filter: not to be used for anything else.
//!
//! * Likelihoods are densities plus 1e-99, not logarithms: where all underflow, all particles are equal.
//! * The transition of a proposal is evaluated at x_t - x_{t-1}, without the drift, for either sign.
//! * The unscented filters take noise of mean zero, of variance 1.5 (state) and 0.1 (measurement), and alpha 1,
//!   beta 0, kappa 2.
//! * Residual resampling; the estimate is the mean of the particles after it.
//! * The fitness of evolution is the likelihood alone.
//! * A child is the mutant with a probability of 0.6, else its parent. The paper takes at least one gene from the
//!   mutant, and with one dimension that is all of it; but then PFDE is at 0.69, far below what the paper prints.

use std::f64::consts::TAU;

use foxhunt_host::reference::gamma::{GammaNoise, START, noise};
use foxhunt_simulation::random::normal;
use rand::{Rng, RngExt};

/// Added to every likelihood.
const TINY: f64 = 1e-99;
const PROCESS: f64 = 1.5;
const MEASURED: f64 = 0.1;
/// Variance of the first state of the unscented filters.
const FIRST: f64 = 0.75;

/// What is combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Legacy {
    pub particles: usize,
    /// Each particle is proposed by an unscented Kalman filter.
    pub unscented: bool,
    /// Evolution in place of resampling.
    pub evolution: bool,
}

#[derive(Debug, Clone, Copy)]
struct Particle {
    state: f64,
    /// Of its own unscented filter.
    variance: f64,
}

impl Legacy {
    /// RMSE of one run.
    pub fn rmse(
        self,
        model: &GammaNoise,
        truth: &[f64],
        measurements: &[f64],
        rng: &mut impl Rng,
    ) -> f64 {
        let first = Particle {
            state: START,
            variance: FIRST,
        };
        let mut particles = vec![first; self.particles];
        let mut squares = 0.0;
        for ((x, z), t) in truth.iter().zip(measurements).zip(1..) {
            let likelihood =
                |state: f64| density(z - GammaNoise::measurement(state, t), model.variance) + TINY;
            let mut weights = Vec::new();
            for particle in &mut particles {
                let before = particle.state;
                if self.unscented {
                    let (mean, variance) = unscented(model, *particle, *z, t);
                    particle.state = mean + variance.sqrt() * normal(rng);
                    particle.variance = variance;
                    let step = particle.state - before;
                    let transition = step * step * (-2.0 * step).exp();
                    let proposal = density(particle.state - mean, variance);
                    weights.push(likelihood(particle.state) * transition / proposal);
                } else {
                    particle.state = model.base(before, t) + noise(rng);
                    weights.push(likelihood(particle.state));
                }
            }
            if self.evolution {
                evolve(&mut particles, likelihood, rng);
            } else {
                particles = resample(&particles, &weights, rng);
            }
            let mean = particles.iter().map(|p| p.state).sum::<f64>() / particles.len() as f64;
            squares += (mean - x).powi(2);
        }
        (squares / truth.len() as f64).sqrt()
    }
}

/// Mean and variance after a step of an unscented Kalman filter of state and both noises, alpha 1, beta 0, kappa 2.
fn unscented(model: &GammaNoise, particle: Particle, z: f64, t: usize) -> (f64, f64) {
    // Seven points: the middle, and either way along the state, the process noise and the measurement noise.
    let reach = (3.0_f64 + 2.0).sqrt();
    let [state, process, measured] =
        [particle.variance, PROCESS, MEASURED].map(|v| reach * v.sqrt());
    let mut points = [(0.0, 0.0, 0.0); 7];
    points[1].0 = state;
    points[2].0 = -state;
    points[3].1 = process;
    points[4].1 = -process;
    points[5].2 = measured;
    points[6].2 = -measured;
    let weight = |k: usize| if k == 0 { 0.4 } else { 0.1 };
    let through = points.map(|(dx, v, n)| {
        let x = model.base(particle.state + dx, t) + v;
        (x, GammaNoise::measurement(x, t) + n)
    });
    let sum =
        |f: &dyn Fn((f64, f64)) -> f64| -> f64 { (0..7).map(|k| weight(k) * f(through[k])).sum() };
    let (mean, expected) = (sum(&|(x, _)| x), sum(&|(_, z)| z));
    let variance = sum(&|(x, _)| (x - mean).powi(2));
    let together = sum(&|(x, z)| (x - mean) * (z - expected));
    let spread = sum(&|(_, z)| (z - expected).powi(2));
    let gain = together / spread;
    let rest = (variance - gain * together).max(f64::MIN_POSITIVE);
    (mean + gain * (z - expected), rest)
}

/// 20 generations with F1 = 1, F2 = 0.9, Cr = 0.6.
fn evolve(particles: &mut [Particle], fitness: impl Fn(f64) -> f64, rng: &mut impl Rng) {
    let n = particles.len();
    for _ in 0..20 {
        for i in 0..n {
            let mut parents = [i; 4];
            for k in 1..4 {
                while parents[..k].contains(&parents[k]) {
                    parents[k] = rng.random_range(0..n);
                }
            }
            let [_, base, plus, minus] = parents.map(|parent| particles[parent].state);
            let mutant = base + 0.9 * (plus - minus);
            let crossed = rng.random::<f64>() < 0.6;
            if crossed && fitness(mutant) > fitness(particles[i].state) {
                particles[i].state = mutant;
            }
        }
    }
}

/// Whole copies first, the rest by chance.
fn resample(particles: &[Particle], weights: &[f64], rng: &mut impl Rng) -> Vec<Particle> {
    let n = particles.len();
    let total: f64 = weights.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return particles.to_vec();
    }
    let copies: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
    let mut chosen: Vec<Particle> = copies
        .iter()
        .zip(particles)
        .flat_map(|(count, particle)| std::iter::repeat_n(*particle, *count as usize))
        .collect();
    let rests: Vec<f64> = copies.iter().map(|count| count.fract()).collect();
    let sum: f64 = rests.iter().sum();
    while chosen.len() < n {
        let mut place = sum * rng.random::<f64>();
        let index = rests.iter().position(|rest| {
            place -= rest;
            place < 0.0
        });
        chosen.push(particles[index.unwrap_or(n - 1)]);
    }
    chosen
}

fn density(x: f64, variance: f64) -> f64 {
    (-0.5 * x * x / variance).exp() / (TAU * variance).sqrt()
}
