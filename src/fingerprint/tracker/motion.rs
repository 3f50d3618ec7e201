//! How particles move between updates.

use super::{Config, Site, Tracker, Walls};
use crate::math::{exp, sqrt};
use crate::random::{Rng, normal};

impl<const N: usize, const B: usize> Tracker<N, B> {
    /// Moves all particles by `dt` seconds, and sets `log_weights` to minus infinity for those that would pass a wall, to
    /// zero for the others.
    ///
    /// The velocity falls to v' = keep v + n, with normal n of variance `fresh`, and the place moves by the mean of both
    /// velocities. Given the move of a particle, which is sampled, its velocity is normal again (Kalman).
    pub(super) fn predict<R: Rng + ?Sized>(
        &mut self,
        dt: f32,
        site: &Site<'_>,
        log_weights: &mut [f32; N],
        rng: &mut R,
    ) {
        let steps = self.velocity_variance.each_mut();
        let [step_x, step_y] = steps.map(|variance| Step::of(dt, variance, &site.config));
        let [along_x, along_y] = site.map.lattice().extends();
        let is_free = site.walls == Walls::None;
        let [x, y, vx, vy] = self.particles.columns_mut();
        let x = x.iter_mut().zip(vx);
        let y = y.iter_mut().zip(vy);
        for (((x, vx), (y, vy)), log_weight) in x.zip(y).zip(log_weights) {
            let from = [*x, *y];
            if along_x {
                step_x.take(x, vx, rng);
            }
            if along_y {
                step_y.take(y, vy, rng);
            }
            *log_weight = if is_free || site.walls.allow(from, [*x, *y]) {
                0.0
            } else {
                f32::NEG_INFINITY
            };
        }
    }
}

/// A move along one axis.
#[derive(Clone, Copy)]
struct Step {
    half: f32,
    keep: f32,
    sigma: f32,
    gain: f32,
}

impl Step {
    /// A move of `dt` seconds by a velocity of this variance, which becomes that after the move.
    fn of(dt: f32, variance: &mut f32, config: &Config) -> Self {
        let (noise, memory_s) = (config.velocity_noise_m2_s3, config.velocity_memory_s);
        let keep = exp(-dt / memory_s);
        // The second is the limit of the first, whose terms cancel.
        let fresh = if keep < 0.999 {
            0.5 * noise * memory_s * (1.0 - keep * keep)
        } else {
            noise * dt
        };
        let half = 0.5 * dt * (1.0 + keep);
        let square = half * half * *variance + 0.25 * dt * dt * fresh;
        let covariance = half * keep * *variance + 0.5 * dt * fresh;
        let gain = covariance / square;
        *variance = keep * keep * *variance + fresh - gain * covariance;
        Self {
            half,
            keep,
            sigma: sqrt(square),
            gain,
        }
    }

    #[inline(always)]
    fn take<R: Rng + ?Sized>(&self, place: &mut f32, velocity: &mut f32, rng: &mut R) {
        let step = self.sigma * normal(rng);
        *place += self.half * *velocity + step;
        *velocity = self.keep * *velocity + self.gain * step;
    }
}
