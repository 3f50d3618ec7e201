//! A bootstrap filter of many particles that knows when the source departs, and when it stops if that is wished.

use super::chase::{Chase, Step};
use super::*;
use crate::aoa::robust::outside::read;
use crate::aoa::robust::{Correlation, Errors};

const PARTICLES: usize = 20_000;

/// What is known of the position at a bearing.
pub struct Known {
    pub mean: [f32; 2],
    /// In square metres squared.
    pub determinant: f32,
}

/// What is known at every bearing. Without the time of the stop, the source may stop at any time, as often as the locator
/// believes.
pub fn track(chase: &Chase, bearings: &[Step], knows_stop: bool, seed: u64) -> Vec<Known> {
    let mut rng = generator(seed ^ 0x04ac1e);
    let habits = Config::DEFAULT;
    let errors = Errors {
        rates: Mixture::new(0.0, chase.outliers.max(0.001)),
        ..Errors::DEFAULT
    };
    // What is known at the departure: by an exact posterior.
    let mut stationary = stationary(errors);
    let mut particles: Vec<[f32; 4]> = Vec::new();
    let mut weights = vec![1.0 / PARTICLES as f32; PARTICLES];
    let mut out = Vec::new();
    let sigma = habits.speed_m_s * FRAC_1_SQRT_2;
    let turn = 1.0 - (-1.0 / habits.straight_s).exp();
    let stop = 1.0 - (-1.0 / habits.moving_s).exp();
    // A straight road keeps the velocity for twenty times as long as it lasts.
    let keep = (-1.0 / (20.0 * habits.straight_s)).exp();
    for Step {
        time, observation, ..
    } in bearings
    {
        if *time < chase.departure {
            let answer = stationary.push(observation, &mut rng).unwrap();
            out.push(Known {
                mean: answer.fix().map_or([f32::NAN; 2], |fix| fix.position),
                determinant: f32::NAN,
            });
            continue;
        }
        if particles.is_empty() {
            let columns = stationary.state().columns();
            particles.extend((0..PARTICLES).map(|i| {
                let [x, y, ..]: [f32; 4] = crate::particles::read(&columns, i % 512);
                [x, y, sigma * normal(&mut rng), sigma * normal(&mut rng)]
            }));
        }
        for particle in &mut particles {
            let drives = match knows_stop {
                true => *time < chase.stop,
                false => particle[2..] != [0.0; 2],
            };
            if drives {
                let keep = if uniform(&mut rng) < turn { 0.0 } else { keep };
                drive(particle, keep, sigma, &mut rng);
                if !knows_stop && uniform(&mut rng) < stop {
                    particle[2..].fill(0.0);
                }
            } else {
                particle[0] += 0.1 * normal(&mut rng);
                particle[1] += 0.1 * normal(&mut rng);
            }
        }
        weigh(&particles, &mut weights, observation, &errors);
        out.push(known(&particles, &weights));
        if effective_sample_size(&weights) < 0.5 * PARTICLES as f32 {
            particles = resampled(&particles, &mut weights, &mut rng);
        }
    }
    out
}

fn stationary(errors: Errors) -> Locator<Robust<512, 256>> {
    let errors = Errors {
        correlation: Correlation::NONE,
        ..errors
    };
    Locator::new(robust::Config {
        errors,
        ..robust::Config::DEFAULT
    })
    .unwrap()
}

fn known(particles: &[[f32; 4]], weights: &[f32]) -> Known {
    let sum = |of: &dyn Fn(&[f32; 4]) -> f32| {
        let all = particles.iter().zip(weights);
        all.map(|(p, w)| w * of(p)).sum::<f32>()
    };
    let mean = [sum(&|p| p[0]), sum(&|p| p[1])];
    let moment = |a: usize, b: usize| sum(&|p| (p[a] - mean[a]) * (p[b] - mean[b]));
    Known {
        mean,
        determinant: moment(0, 0) * moment(1, 1) - moment(0, 1) * moment(0, 1),
    }
}

fn effective_sample_size(weights: &[f32]) -> f32 {
    let sums = |(sum, squares), weight: &f32| (sum + weight, squares + weight * weight);
    let (sum, squares): (f32, f32) = weights.iter().fold((0.0, 0.0), sums);
    sum * sum / squares
}

/// Moves a particle by a second, in which its velocity keeps a part of what it was.
fn drive(particle: &mut [f32; 4], keep: f32, sigma: f32, rng: &mut Xoshiro128PlusPlus) {
    let kick = sigma * (1.0 - keep * keep).sqrt();
    let [x, y, u, v] = *particle;
    let (p, q) = (keep * u + kick * normal(rng), keep * v + kick * normal(rng));
    *particle = [x + 0.5 * (u + p), y + 0.5 * (v + q), p, q];
}

/// Weighs the particles by a bearing.
fn weigh(particles: &[[f32; 4]], weights: &mut [f32], observation: &Observation, errors: &Errors) {
    for ([x, y, ..], weight) in particles.iter().zip(weights.iter_mut()) {
        let line = read(observation, errors, &[*x, *y, 0.0]);
        *weight *= 1.0 + line.odds(line.error, line.variance, errors);
    }
    let total: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
}

/// As many particles of equal weight.
fn resampled(
    particles: &[[f32; 4]],
    weights: &mut [f32],
    rng: &mut Xoshiro128PlusPlus,
) -> Vec<[f32; 4]> {
    let mut memory = vec![0.0; PARTICLES];
    let chosen = resample(Scheme::Systematic, weights, &mut memory, rng);
    let particles = chosen.iter().map(|i| particles[i]).collect();
    weights.fill(1.0 / PARTICLES as f32);
    particles
}
