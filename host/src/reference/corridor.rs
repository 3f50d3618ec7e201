//! Tracking along a corridor, exactly: a grid over place and velocity.

/// What is known of the person who walks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The corridor runs from zero to this, in metres; every place is as likely at first.
    pub length: f64,
    /// Standard deviation of the first velocity, around zero, in metres a second.
    pub velocity: f64,
    /// Standard deviation of the acceleration, which is constant between two steps, in metres per second squared.
    pub acceleration: f64,
    /// Seconds from one step to the next.
    pub interval: f64,
}

impl Default for Motion {
    /// Of the published experiment, with a velocity prior that contains its 2.5 metres a second.
    fn default() -> Self {
        Self {
            length: 80.0,
            velocity: 1.5,
            acceleration: 0.5,
            interval: 2.0,
        }
    }
}

/// The exact filter for [`Motion`] and any likelihood of the place, by sums over a grid.
///
/// With a constant acceleration over a step of T seconds, `x' - x = T (v + v') / 2`. Velocities that are
/// multiples of `2 / T` times the spacing of the places hence lead from grid point to grid point, and nothing
/// is interpolated.
#[derive(Debug, Clone)]
pub struct CorridorFilter {
    spacing: f64,
    places: usize,
    /// Metres a second from one velocity of the grid to the next.
    step: f64,
    /// The velocities are from minus this to plus this many steps.
    reach: isize,
    first_velocity: Vec<f64>,
    /// Probability of a change of velocity, by its number of steps.
    change: Vec<f64>,
}

/// What the filter knows after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief {
    /// Posterior mean of the place, in metres.
    pub mean: f64,
    /// Posterior variance of the place, in square metres.
    pub variance: f64,
}

/// Probabilities beyond this many standard deviations are left out.
const BAND: f64 = 5.0;

impl CorridorFilter {
    /// A filter on places `spacing` metres apart. `steps` bounds the length of the runs: velocities grow with it.
    pub fn new(motion: &Motion, spacing: f64, steps: usize) -> Self {
        let step = 2.0 * spacing / motion.interval;
        let noise = motion.acceleration * motion.interval;
        let widest = (motion.velocity.powi(2) + steps as f64 * noise.powi(2)).sqrt();
        // Nobody crosses the whole corridor in one step.
        let fastest = (4.0 * widest).min(motion.length / motion.interval);
        let reach = (fastest / step).ceil() as isize;
        let bell = |sigma: f64, to: isize| -> Vec<f64> {
            let weight = |n: isize| (-0.5 * (n as f64 * step / sigma).powi(2)).exp();
            let total: f64 = (-to..=to).map(weight).sum();
            (-to..=to).map(|n| weight(n) / total).collect()
        };
        Self {
            spacing,
            places: (motion.length / spacing).round() as usize + 1,
            step,
            reach,
            first_velocity: bell(motion.velocity, reach),
            change: bell(noise, (BAND * noise / step).ceil() as isize),
        }
    }

    /// The places of the grid, in metres.
    pub fn places(&self) -> impl Iterator<Item = f64> {
        (0..self.places).map(|n| n as f64 * self.spacing)
    }

    /// The velocities of the grid, in metres a second.
    pub fn velocities(&self) -> impl Iterator<Item = f64> {
        (-self.reach..=self.reach).map(|n| n as f64 * self.step)
    }

    /// What is known after each step, given for each step the log-likelihood of every place of the grid.
    pub fn run(&self, log_likelihoods: &[Vec<f64>]) -> Vec<Belief> {
        let velocities = self.first_velocity.len();
        // By place and velocity.
        let mut density: Vec<f64> = (0..self.places)
            .flat_map(|_| self.first_velocity.iter().copied())
            .collect();
        let mut beliefs = Vec::with_capacity(log_likelihoods.len());
        for (step, log_likelihood) in log_likelihoods.iter().enumerate() {
            if step > 0 {
                density = self.predict(&density);
            }
            let highest = log_likelihood
                .iter()
                .fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            for (row, l) in density.chunks_exact_mut(velocities).zip(log_likelihood) {
                let likelihood = (l - highest).exp();
                row.iter_mut().for_each(|mass| *mass *= likelihood);
            }
            let total: f64 = density.iter().sum();
            density.iter_mut().for_each(|mass| *mass /= total);
            beliefs.push(self.belief(&density));
        }
        beliefs
    }

    fn predict(&self, density: &[f64]) -> Vec<f64> {
        let velocities = self.first_velocity.len() as isize;
        let reach = (self.change.len() / 2) as isize;
        let mut after = vec![0.0; density.len()];
        for (n, mass) in density.iter().enumerate() {
            // Masses below any that matter: skipping them saves most of the work.
            if *mass < 1e-12 {
                continue;
            }
            let (place, v) = (n as isize / velocities, n as isize % velocities);
            for (change, probability) in (-reach..=reach).zip(&self.change) {
                let new = v + change;
                let to = place + (v - self.reach) + (new - self.reach);
                if (0..velocities).contains(&new) && (0..self.places as isize).contains(&to) {
                    after[(to * velocities + new) as usize] += mass * probability;
                }
            }
        }
        after
    }

    fn belief(&self, density: &[f64]) -> Belief {
        let rows = density.chunks_exact(self.first_velocity.len());
        let masses: Vec<f64> = rows.map(|row| row.iter().sum()).collect();
        let mean: f64 = self.places().zip(&masses).map(|(x, mass)| x * mass).sum();
        let squares = self
            .places()
            .zip(&masses)
            .map(|(x, mass)| mass * (x - mean).powi(2));
        Belief {
            mean,
            variance: squares.sum(),
        }
    }
}

/// A radio map along a line: at equally spaced places, the mean of every beacon and its variance.
#[derive(Debug, Clone)]
pub struct LineMap {
    /// Metres between the places; the first is at zero.
    pub spacing: f64,
    /// For each place, for each beacon, mean in dBm and variance of one packet in dB^2.
    pub levels: Vec<Vec<[f64; 2]>>,
}

impl LineMap {
    /// Mean and variance of `beacon` at `x` metres, linear between the places.
    pub fn at(&self, x: f64, beacon: usize) -> [f64; 2] {
        let position = (x / self.spacing).clamp(0.0, (self.levels.len() - 1) as f64);
        let first = (position as usize).min(self.levels.len().saturating_sub(2));
        let second = (first + 1).min(self.levels.len() - 1);
        let part = position - first as f64;
        let (a, b) = (self.levels[first][beacon], self.levels[second][beacon]);
        [0, 1].map(|n| (1.0 - part) * a[n] + part * b[n])
    }

    /// Log-likelihood of a scan, in which every beacon that was heard gives its mean, at `x` metres. `variance`
    /// makes that of a beacon's mean from the map's variance of one packet.
    pub fn log_likelihood(
        &self,
        x: f64,
        scan: &[Option<f64>],
        variance: impl Fn(f64) -> f64,
    ) -> f64 {
        let of = |(beacon, level): (usize, &Option<f64>)| {
            let [mean, single] = self.at(x, beacon);
            let variance = variance(single);
            level.map_or(0.0, |level| {
                -0.5 * ((level - mean).powi(2) / variance + variance.ln())
            })
        };
        scan.iter().enumerate().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix1x2, Matrix2, Vector2};

    use super::*;
    use crate::reference::Kalman;

    /// With a normal likelihood far from the walls, the exact filter is the Kalman filter.
    #[test]
    fn in_the_open_it_is_the_kalman_filter() {
        let motion = Motion {
            length: 200.0,
            ..Motion::default()
        };
        let measured = [100.0, 104.0, 111.0, 114.0, 122.0];
        let variance = 9.0;
        let filter = CorridorFilter::new(&motion, 0.5, measured.len());
        let bell = |z: &f64| {
            let at = |x: f64| -0.5 * (x - z).powi(2) / variance;
            filter.places().map(at).collect()
        };
        let log_likelihoods: Vec<Vec<f64>> = measured.iter().map(bell).collect();

        let t = motion.interval;
        let push = Vector2::new(0.5 * t * t, t) * motion.acceleration;
        let mut kalman = Kalman {
            mean: Vector2::new(measured[0], 0.0),
            covariance: Matrix2::new(variance, 0.0, 0.0, motion.velocity.powi(2)),
        };
        for (step, belief) in filter.run(&log_likelihoods).iter().enumerate() {
            if step > 0 {
                kalman.predict(&Matrix2::new(1.0, t, 0.0, 1.0), &(push * push.transpose()));
                kalman.update(&Matrix1x2::new(1.0, 0.0), measured[step], variance);
            }
            assert!((belief.mean - kalman.mean[0]).abs() < 0.01, "step {step}");
            assert!((belief.variance / kalman.covariance[(0, 0)] - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn nobody_walks_through_the_end() {
        let motion = Motion::default();
        let filter = CorridorFilter::new(&motion, 0.5, 3);
        let flat = vec![0.0; filter.places().count()];
        let at_the_end = filter
            .places()
            .map(|x| if x < 0.25 { 0.0 } else { -1e4 })
            .collect();
        let beliefs = filter.run(&[at_the_end, flat.clone(), flat]);
        assert_eq!(beliefs[0].mean, 0.0);
        assert!(beliefs[1].mean > 1.0 && beliefs[2].mean > beliefs[1].mean);
    }

    #[test]
    fn the_map_is_linear_between_its_places() {
        let map = LineMap {
            spacing: 2.0,
            levels: vec![vec![[-50.0, 4.0]], vec![[-60.0, 8.0]]],
        };
        assert_eq!(map.at(0.5, 0), [-52.5, 5.0]);
        assert_eq!(map.at(-1.0, 0), [-50.0, 4.0]);
        assert_eq!(map.at(9.0, 0), [-60.0, 8.0]);
        assert_eq!(map.log_likelihood(1.0, &[None], |v| v), 0.0);
        let l = map.log_likelihood(1.0, &[Some(-53.0)], |v| v / 2.0);
        assert!((l + 0.5 * (4.0 / 3.0 + 3f64.ln())).abs() < 1e-12);
    }
}
