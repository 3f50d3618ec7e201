//! What a user tells the filter: how states move, and how well they explain a measurement.
//!
//! Both traits ask for one particle and get the whole cloud for free; a model that knows a faster way over
//! the columns overrides the second method. This is a complete model of a robot on a line that measures its
//! distance from a wall:
//!
//! ```
//! use foxhunt::filter::ParticleFilter;
//! use foxhunt::model::{Dynamics, Likelihood};
//! use foxhunt::random::{normal, Rng, SeedableRng, Xoshiro128PlusPlus};
//!
//! struct Robot { speed_m_s: f32 }
//!
//! impl Dynamics<1> for Robot {
//!     fn step<R: Rng + ?Sized>(&self, [x]: [f32; 1], dt: f32, rng: &mut R) -> [f32; 1] {
//!         [x + self.speed_m_s * dt + 0.1 * normal(rng)]
//!     }
//! }
//!
//! struct Distance { metres: f32 }
//!
//! impl Likelihood<1> for Distance {
//!     fn log_likelihood(&self, [x]: &[f32; 1]) -> f32 {
//!         -0.5 * ((self.metres - x) / 0.2).powi(2)
//!     }
//! }
//!
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut filter = ParticleFilter::<1, 500>::new();
//! filter.initialise(&mut rng, |rng| [normal(rng)]);
//! let robot = Robot { speed_m_s: 1.0 };
//! for second in 1..=10 {
//!     let measurement = Distance { metres: second as f32 };
//!     filter.step(&robot, &measurement, 1.0, &mut rng)?;
//! }
//! assert!((filter.mean()[0] - 10.0).abs() < 0.2);
//! # Ok::<(), foxhunt::filter::UpdateError>(())
//! ```
//!
//! A closure from the state to its log-likelihood is a likelihood, too.

use crate::math::{larger, sqrt};
use crate::particles::{read, write};
use crate::random::{Rng, normal};

/// How a state of `D` dimensions moves between measurements.
pub trait Dynamics<const D: usize> {
    /// A random successor of `state` after `dt` seconds.
    fn step<R: Rng + ?Sized>(&self, state: [f32; D], dt: f32, rng: &mut R) -> [f32; D];

    /// Moves every particle. The default calls [`Dynamics::step`] for each in turn.
    fn predict<R: Rng + ?Sized>(&self, columns: &mut [&mut [f32]; D], dt: f32, rng: &mut R) {
        let particles = columns.iter().map(|column| column.len()).min().unwrap_or(0);
        for i in 0..particles {
            let state = read(&columns.each_ref().map(|column| &**column), i);
            write(columns, i, self.step(state, dt, rng));
        }
    }
}

/// How well a state of `D` dimensions explains a measurement, which the implementing value holds.
///
/// NaN and plus infinity count as minus infinity: a state that cannot be.
pub trait Likelihood<const D: usize> {
    /// Natural logarithm of the likelihood of `state`, up to a constant.
    fn log_likelihood(&self, state: &[f32; D]) -> f32;

    /// The log-likelihood of every particle. The default calls [`Likelihood::log_likelihood`] for each.
    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.log_likelihood(&read(columns, i));
        }
    }
}

impl<const D: usize, F: Fn(&[f32; D]) -> f32> Likelihood<D> for F {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        self(state)
    }
}

/// Every dimension wanders on its own; nothing moves in a time that is not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomWalk<const D: usize> {
    /// Standard deviation after one second, in the unit of each dimension; it grows with the square root of time.
    pub sigma: [f32; D],
}

impl<const D: usize> Dynamics<D> for RandomWalk<D> {
    fn step<R: Rng + ?Sized>(&self, mut state: [f32; D], dt: f32, rng: &mut R) -> [f32; D] {
        let root = sqrt(larger(dt, 0.0));
        for (x, sigma) in state.iter_mut().zip(self.sigma) {
            *x += sigma * root * normal(rng);
        }
        state
    }

    fn predict<R: Rng + ?Sized>(&self, columns: &mut [&mut [f32]; D], dt: f32, rng: &mut R) {
        let root = sqrt(larger(dt, 0.0));
        for (column, sigma) in columns.iter_mut().zip(self.sigma) {
            let spread = sigma * root;
            for x in column.iter_mut() {
                *x += spread * normal(rng);
            }
        }
    }
}

/// A body in the plane that keeps its velocity but for random accelerations: the state is (x, y, vx, vy) in
/// metres and metres a second.
///
/// An acceleration is constant over a step, so it moves the position by `dt^2 / 2` and the velocity by `dt`
/// times itself (Cui et al. 2017, eq. 9).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVelocity {
    /// Standard deviation of the acceleration along x and along y, in metres per second squared.
    pub sigma_m_s2: [f32; 2],
}

impl Dynamics<4> for ConstantVelocity {
    fn step<R: Rng + ?Sized>(&self, [x, y, vx, vy]: [f32; 4], dt: f32, rng: &mut R) -> [f32; 4] {
        let ax = self.sigma_m_s2[0] * normal(rng);
        let ay = self.sigma_m_s2[1] * normal(rng);
        let half = 0.5 * dt;
        [
            x + dt * (vx + half * ax),
            y + dt * (vy + half * ay),
            vx + dt * ax,
            vy + dt * ay,
        ]
    }
}
