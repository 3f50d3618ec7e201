//! Where particles are moved: to all modes, and all over the prior.

use core::f32::consts::TAU;

use super::density::Region;
use super::mode::{MODES, Mode, Modes};
use super::term::State;
use crate::aoa::core::Proposal;
use crate::math::{exp_of_weight, ln, sin_cos, sqrt};
use crate::random::{Rng, normal, uniform, uniform_open};

/// Scale of most draws about a mode: wider reaches tails that are not normal, for fewer that are accepted.
const NARROW: f32 = 1.15;
/// Scale of the other draws, for long tails.
const WIDE: f32 = 2.5;
/// Fraction of the other draws: more fill the tails sooner, for fewer that are accepted.
const WIDE_FRACTION: f32 = 0.2;
/// Fraction of the draws that are from the prior. Without them a particle in a mode that the search has lost would never
/// leave it, because its way back would be too unlikely; more are seldom accepted.
const ANYWHERE: f32 = 0.02;
/// The best scale of a random walk in three dimensions: 2.38 / sqrt(3) (Gelman, Roberts and Gilks 1996).
const WALK: f32 = 1.37;

/// What particles are drawn from: all modes, and the prior.
pub(super) struct MixtureProposal<'a> {
    modes: &'a Modes,
    region: Region,
    /// Logarithms of the densities of one sigma's volume at the means.
    heights: [f32; MODES],
}

impl<'a> MixtureProposal<'a> {
    pub(super) fn new(modes: &'a Modes, region: Region) -> Self {
        let mut heights = [0.0; MODES];
        for (height, mode) in heights.iter_mut().zip(modes) {
            *height = ln((1.0 - ANYWHERE) * mode.weight) - mode.covariance.half_ln_determinant();
        }
        Self {
            modes,
            region,
            heights,
        }
    }

    fn pick<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<&'a Mode> {
        let mut left = uniform(rng);
        let chosen = self.modes.iter().find(|mode| {
            left -= mode.weight;
            left < 0.0
        });
        chosen.or(self.modes.first())
    }
}

impl Proposal<3> for MixtureProposal<'_> {
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> State {
        let z = normals(rng);
        let anywhere = uniform(rng) < ANYWHERE;
        if !anywhere && let Some(mode) = self.pick(rng) {
            let wide = uniform(rng) < WIDE_FRACTION;
            return mode.step(&mode.mean, if wide { WIDE } else { NARROW }, z);
        }
        // By the quantile of 1 - 1 / (1 + r^2), in a random direction.
        let quantile = uniform_open(rng);
        let r = sqrt(quantile / ((1.0 - quantile) * self.region.inverse_square));
        let (sin, cos) = sin_cos(TAU * uniform(rng));
        let [x, y] = self.region.centre;
        [x + r * cos, y + r * sin, z[2]]
    }

    /// But for (2 pi)^(-3/2).
    #[inline(never)]
    fn log_density(&self, state: &State) -> f32 {
        const fn height(weight: f32, scale: f32) -> f32 {
            ln(weight / (scale * scale * scale))
        }
        const NARROW_HEIGHT: f32 = height(1.0 - WIDE_FRACTION, NARROW);
        const WIDE_HEIGHT: f32 = height(WIDE_FRACTION, WIDE);
        let anywhere = ln(2.0 * ANYWHERE * self.region.inverse_square);
        let anywhere = anywhere + self.region.log_density(state);
        let mut logs = [[f32::NEG_INFINITY; 2]; MODES];
        let mut largest = anywhere;
        for ((mode, height), logs) in self.modes.iter().zip(self.heights).zip(&mut logs) {
            let square = -0.5 * mode.distance(state);
            logs[0] = height + NARROW_HEIGHT + square * (1.0 / (NARROW * NARROW));
            logs[1] = height + WIDE_HEIGHT + square * (1.0 / (WIDE * WIDE));
            for log in logs {
                if *log > largest {
                    largest = *log;
                }
            }
        }
        let logs = logs.as_flattened().iter();
        let sum: f32 = logs.map(|log| exp_of_weight(log - largest)).sum();
        largest + ln(sum + exp_of_weight(anywhere - largest))
    }

    fn walk<R: Rng + ?Sized>(&self, from: &State, rng: &mut R) -> State {
        match self.pick(rng) {
            Some(mode) => mode.step(from, WALK, normals(rng)),
            None => *from,
        }
    }
}

fn normals<R: Rng + ?Sized>(rng: &mut R) -> [f32; 3] {
    [normal(rng), normal(rng), normal(rng)]
}
