//! How particles move between updates.

use super::Config;
use crate::math::{exp, sqrt};
use crate::random::{Rng, normal_of};

/// A move along one axis.
///
/// The velocity falls to v' = keep v + n, with normal n of variance `fresh`, and the place moves by the mean of both
/// velocities. Given the move of a particle, which is sampled, its velocity is normal again (Kalman).
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    half: f32,
    keep: f32,
    sigma: f32,
    gain: f32,
}

impl Step {
    /// A move of `dt` seconds by a velocity of this variance, which becomes that after the move; `scale` turns metres into
    /// the unit of places.
    pub fn of(dt: f32, variance: &mut f32, config: &Config, scale: f32) -> Self {
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
            sigma: scale * sqrt(square),
            gain,
        }
    }

    /// Place and velocity after it.
    #[inline(always)]
    pub fn take(&self, (place, velocity): (f32, f32), noise: f32) -> (f32, f32) {
        let step = self.sigma * noise;
        (
            place + (self.half * velocity + step),
            self.keep * velocity + self.gain * step,
        )
    }
}

/// Standard normal numbers for a cloud, spread more evenly than independent ones: a sequence of fixed steps round a circle,
/// from a random start, through the quantile function.
///
/// Each particle gets a normal number, but those of siblings, which stand side by side after resampling, fill the
/// distribution (randomised quasi-Monte Carlo: see L'Ecuyer, Lécot and Tuffin 2008). It takes less than drawing a number
/// for each particle, and the mean of a cloud scatters less.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    phase: u32,
    stride: u32,
}

impl Noise {
    /// Steps in 2^-32 of the circle. Along one axis: the golden section, whose multiples fill a circle most evenly.
    const LINE: u32 = 0x9e37_79b9;
    /// Along two, whose pairs fill the square most evenly: the inverse of the real root of x^3 = x + 1, and its square.
    const PLANE: [u32; 2] = [0xc13f_a9a9, 0x91e1_0da6];

    /// For one axis.
    pub fn on_line<R: Rng + ?Sized>(rng: &mut R) -> Self {
        Self {
            phase: rng.next_u32(),
            stride: Self::LINE,
        }
    }

    /// For each of two axes.
    pub fn in_plane<R: Rng + ?Sized>(rng: &mut R) -> [Self; 2] {
        Self::PLANE.map(|stride| Self {
            phase: rng.next_u32(),
            stride,
        })
    }

    #[inline(always)]
    pub fn next(&mut self) -> f32 {
        self.phase = self.phase.wrapping_add(self.stride);
        normal_of(self.phase)
    }
}
