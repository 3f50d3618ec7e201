//! The model with gamma noise, and its exact filter.
//!
//! x_t = 1 + sin(omega pi (t - 1)) + x / 2 + v, v gamma with shape 3 and rate 2; z = 0.2 x^2 + n up to
//! step 30, x / 2 - 2 + n after it, n normal; x_0 = 1.

use std::f64::consts::PI;

use rand::Rng;
use rand_distr::{Distribution, Gamma};

use foxhunt_simulation::random::normal;

/// State before the first step.
pub const START: f64 = 1.0;

const SHAPE: f64 = 3.0;
const RATE: f64 = 2.0;

/// The model's parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GammaNoise {
    /// Of the drift: 0.04, or 0.4 as the paper prints.
    pub omega: f64,
    /// Variance of the measurements.
    pub variance: f64,
}

/// Masses below this fraction of the largest are left out.
const NEGLIGIBLE: f64 = 1e-14;
/// What the noise never exceeds: the density there is 1e-14 of its largest.
const LONGEST: f64 = 20.0;
/// Cells of the grid.
const CELLS: usize = 500;

impl GammaNoise {
    /// The successor of `x` at step `t`, counted from one, if there were no noise.
    pub fn base(&self, x: f64, t: usize) -> f64 {
        1.0 + (self.omega * PI * (t as f64 - 1.0)).sin() + 0.5 * x
    }

    /// Mean of z at step `t` given the state.
    pub fn measurement(x: f64, t: usize) -> f64 {
        if t <= 30 { 0.2 * x * x } else { 0.5 * x - 2.0 }
    }

    /// One run: the states and the measurements of steps 1 to `steps`.
    pub fn run(&self, steps: usize, rng: &mut impl Rng) -> (Vec<f64>, Vec<f64>) {
        let mut x = START;
        (1..=steps)
            .map(|t| {
                x = self.base(x, t) + noise(rng);
                let z = Self::measurement(x, t) + self.variance.sqrt() * normal(rng);
                (x, z)
            })
            .unzip()
    }

    /// The exact posterior mean of each step, given the `measurements` up to it: by sums over a grid that
    /// finds the posterior by itself.
    pub fn means(&self, measurements: &[f64]) -> Vec<f64> {
        self.means_with(measurements, CELLS)
    }

    fn means_with(&self, measurements: &[f64], cells: usize) -> Vec<f64> {
        let mut posterior = vec![(START, 1.0)];
        measurements
            .iter()
            .zip(1..)
            .map(|(z, t)| {
                posterior = self.step(&posterior, *z, t, cells);
                posterior.iter().map(|(x, mass)| x * mass).sum()
            })
            .collect()
    }

    /// Points and masses after step `t`, both by rising state.
    fn step(&self, before: &[(f64, f64)], z: f64, t: usize, cells: usize) -> Vec<(f64, f64)> {
        let bases: Vec<(f64, f64)> = before
            .iter()
            .map(|(x, mass)| (self.base(*x, t), *mass))
            .collect();
        let (mut low, mut high) = (bases[0].0, bases[bases.len() - 1].0 + LONGEST);
        for _ in 0..20 {
            let cell = (high - low) / cells as f64;
            let points: Vec<f64> = (0..cells).map(|k| low + (k as f64 + 0.5) * cell).collect();
            let logs: Vec<f64> = predicted(&bases, &points)
                .zip(&points)
                .map(|(density, x)| {
                    let residual = z - Self::measurement(*x, t);
                    density.ln() - 0.5 * residual * residual / self.variance
                })
                .collect();
            let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let matters = |log: &f64| log - largest > NEGLIGIBLE.ln();
            let first = logs.iter().position(matters).unwrap_or(0);
            let last = logs.iter().rposition(matters).unwrap_or(cells - 1);
            if (last - first + 1) as f64 > 0.7 * cells as f64 {
                let masses = logs.iter().map(|log| (log - largest).exp());
                let total: f64 = masses.clone().sum();
                return points.into_iter().zip(masses.map(|m| m / total)).collect();
            }
            // With a cell on either side, in which a peak may hide; never below the support.
            (low, high) = (
                low.max(points[first] - 1.5 * cell),
                points[last] + 1.5 * cell,
            );
        }
        before.to_vec()
    }
}

/// Density of the successors at the rising `points`, up to a factor.
///
/// The gamma density of shape 3 is a square times an exponential, so that a sum over all that lie below a
/// point follows from three running sums.
fn predicted(bases: &[(f64, f64)], points: &[f64]) -> impl Iterator<Item = f64> {
    let origin = bases[0].0;
    let mut sums = [0.0; 3];
    let mut next = 0;
    points.iter().map(move |x| {
        while let Some((base, mass)) = bases.get(next)
            && base < x
        {
            let d = base - origin;
            let weight = mass * (RATE * d).exp();
            for (sum, power) in sums.iter_mut().zip([1.0, d, d * d]) {
                *sum += weight * power;
            }
            next += 1;
        }
        let d = x - origin;
        let square = d * d * sums[0] - 2.0 * d * sums[1] + sums[2];
        (square * (-RATE * d).exp()).max(0.0)
    })
}

/// A sample of the model's noise: gamma with shape 3 and rate 2.
pub fn noise(rng: &mut impl Rng) -> f64 {
    Gamma::new(SHAPE, 1.0 / RATE).map_or(f64::NAN, |gamma| gamma.sample(rng))
}

#[cfg(test)]
mod tests {
    use foxhunt_simulation::random;

    use super::*;

    #[test]
    fn a_finer_grid_says_the_same() {
        for variance in [1e-5, 1e-2, 1.0] {
            let model = GammaNoise {
                omega: 0.04,
                variance,
            };
            for run in 0..5 {
                let (_, measurements) = model.run(50, &mut random::generator(7, run));
                let coarse = model.means(&measurements);
                let fine = model.means_with(&measurements, 8 * CELLS);
                for (a, b) in coarse.iter().zip(fine) {
                    assert!((a - b).abs() < 1e-3 * variance.sqrt().min(0.3), "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn means_are_those_of_many_weighted_samples() {
        // Two steps with a broad likelihood; 400,000 samples know the mean to 0.002.
        let model = GammaNoise {
            omega: 0.4,
            variance: 1.0,
        };
        let measurements = [1.0, 4.0];
        let mut rng = random::generator(8, 0);
        let (mut sum, mut total) = (0.0, 0.0);
        for _ in 0..400_000 {
            let x1 = model.base(START, 1) + noise(&mut rng);
            let x2 = model.base(x1, 2) + noise(&mut rng);
            let squares = (measurements[0] - GammaNoise::measurement(x1, 1)).powi(2)
                + (measurements[1] - GammaNoise::measurement(x2, 2)).powi(2);
            let weight = (-0.5 * squares).exp();
            sum += weight * x2;
            total += weight;
        }
        let exact = model.means(&measurements)[1];
        assert!(
            (sum / total - exact).abs() < 0.01,
            "{} {exact}",
            sum / total
        );
    }
}
