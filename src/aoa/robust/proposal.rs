//! Where particles are moved: to all modes, and all over the prior.

use core::f32::consts::TAU;

use super::density::Region;
use super::mode::{MODES, Mode, Modes, position};
use super::term::{SCALE, State};
use crate::aoa::core::Proposal;
use crate::math::{exp_of_weight, ln, sin_cos, sqrt};
use crate::random::{Rng, normal, uniform};

/// Scale of most draws about a mode: wider reaches tails that are not normal, for fewer that are accepted.
const NARROW: f32 = 1.15;
/// Scale of the other draws, for long tails.
const WIDE: f32 = 2.5;
/// Fraction of the other draws: more fill the tails sooner, for fewer that are accepted.
const WIDE_FRACTION: f32 = 0.2;
/// Fraction of the draws that are from the prior. Without them a particle in a mode that the search has lost would never
/// leave it, because its way back would be too unlikely; more are seldom accepted.
const ANYWHERE: f32 = 0.02;
/// What particles are drawn from: all modes, and the prior.
pub(super) struct MixtureProposal<'a, const D: usize> {
    modes: &'a Modes<D>,
    region: Region,
    /// Logarithms of the densities of one sigma's volume at the means.
    heights: [f32; MODES],
    /// That of the density of the region's.
    anywhere: f32,
}

impl<'a, const D: usize> MixtureProposal<'a, D> {
    pub(super) fn new(modes: &'a Modes<D>, region: Region) -> Self {
        let mut heights = [0.0; MODES];
        for (height, mode) in heights.iter_mut().zip(modes) {
            *height = ln((1.0 - ANYWHERE) * mode.weight) - mode.covariance.half_ln_determinant();
        }
        Self {
            modes,
            region,
            heights,
            anywhere: const { ln(TAU * ANYWHERE) } - region.log_volume(),
        }
    }

    #[inline(never)]
    fn pick<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<&'a Mode<D>> {
        let mut left = uniform(rng);
        let chosen = self.modes.iter().find(|mode| {
            left -= mode.weight;
            left < 0.0
        });
        chosen.or(self.modes.first())
    }
}

impl<const D: usize> Proposal<D> for MixtureProposal<'_, D> {
    #[inline(never)]
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> State<D> {
        let z = normals(rng);
        let anywhere = uniform(rng) < ANYWHERE;
        if !anywhere && let Some(mode) = self.pick(rng) {
            let wide = uniform(rng) < WIDE_FRACTION;
            return mode.step(&mode.mean, if wide { WIDE } else { NARROW }, z);
        }
        let r = self.region.quantile(uniform(rng));
        let (sin, cos) = sin_cos(TAU * uniform(rng));
        let [x, y] = self.region.centre;
        let mut state = z;
        (state[0], state[1]) = (x + r * cos, y + r * sin);
        state
    }

    /// But for the normal density of the prior of scale and biases at zero.
    #[inline(never)]
    fn log_density(&self, state: &State<D>) -> f32 {
        const fn height(weight: f32, scale: f32, dimension: usize) -> f32 {
            ln(weight) - dimension as f32 * ln(scale)
        }
        let narrow_height = const { height(1.0 - WIDE_FRACTION, NARROW, D) };
        let wide_height = const { height(WIDE_FRACTION, WIDE, D) };
        let others: f32 = state.iter().skip(SCALE).map(|z| z * z).sum();
        let anywhere = self.anywhere + self.region.log_density(position(state)) - 0.5 * others;
        let mut logs = [[f32::NEG_INFINITY; 2]; MODES];
        let mut largest = anywhere;
        for ((mode, height), logs) in self.modes.iter().zip(self.heights).zip(&mut logs) {
            let square = -0.5 * mode.distance(state);
            logs[0] = height + narrow_height + square * (1.0 / (NARROW * NARROW));
            logs[1] = height + wide_height + square * (1.0 / (WIDE * WIDE));
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

    #[inline(never)]
    fn walk<R: Rng + ?Sized>(&self, from: &State<D>, rng: &mut R) -> State<D> {
        match self.pick(rng) {
            Some(mode) => mode.step(from, 2.38 / sqrt(D as f32), normals(rng)),
            None => *from,
        }
    }
}

fn normals<const D: usize, R: Rng + ?Sized>(rng: &mut R) -> State<D> {
    core::array::from_fn(|_| normal(rng))
}
