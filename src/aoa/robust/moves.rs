//! Metropolis-Hastings moves of the particles against the posterior of all bearings.

use core::f32::consts::TAU;

use super::density::{BLOCK, Density, Region};
use super::mode::{MODES, Mode, Modes};
use super::term::State;
use crate::math::{exp_of_weight, ln, sin_cos, sqrt};
use crate::particles::{read, write};
use crate::random::{Rng, normal, uniform, uniform_open};

/// Draws about a mode are spread a little wider than its curvature, and some much wider, for tails that are not normal.
const NARROW: f32 = 1.15;
const WIDE: f32 = 2.5;
const WIDE_SHARE: f32 = 0.2;
/// Share of the draws from the prior. Without them a particle in a mode that the search has lost would never leave it:
/// its way back would be too unlikely for any gain.
const ANYWHERE: f32 = 0.02;
/// The best scale of a random walk in three dimensions: 2.38 / sqrt(3) (Gelman, Roberts and Gilks 1996).
const WALK: f32 = 1.37;

/// What particles are drawn from: all modes, and the prior.
pub(super) struct Proposal<'a> {
    modes: &'a Modes,
    region: Region,
    /// Logarithms of the densities of one deviation's volume at the means.
    heights: [f32; MODES],
}

impl<'a> Proposal<'a> {
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

    /// The generator is drawn from the same number of times whatever comes of it.
    pub(super) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> State {
        let z = deviations(rng);
        let anywhere = uniform(rng) < ANYWHERE;
        if !anywhere && let Some(mode) = self.pick(rng) {
            let wide = uniform(rng) < WIDE_SHARE;
            return mode.step(&mode.mean, if wide { WIDE } else { NARROW }, z);
        }
        // By the quantile of 1 - 1 / (1 + r^2), in a random direction.
        let quantile = uniform_open(rng);
        let r = sqrt(quantile / ((1.0 - quantile) * self.region.inverse_square));
        let (sin, cos) = sin_cos(TAU * uniform(rng));
        let [x, y] = self.region.centre;
        [x + r * cos, y + r * sin, z[2]]
    }

    /// Log-density of a draw, but for (2 pi)^(-3/2).
    #[inline(never)]
    fn log_density(&self, state: &State) -> f32 {
        const fn height(weight: f32, scale: f32) -> f32 {
            ln(weight / (scale * scale * scale))
        }
        const NARROW_HEIGHT: f32 = height(1.0 - WIDE_SHARE, NARROW);
        const WIDE_HEIGHT: f32 = height(WIDE_SHARE, WIDE);
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
}

fn deviations<R: Rng + ?Sized>(rng: &mut R) -> [f32; 3] {
    [normal(rng), normal(rng), normal(rng)]
}

/// Moves every particle `moves` times, in turns by a draw from all modes, which may take it from one to another, and by
/// a step of a random walk.
#[inline(never)]
pub(super) fn sweep<R: Rng + ?Sized>(
    mut columns: [&mut [f32]; 3],
    density: &Density<'_>,
    modes: &Modes,
    moves: u8,
    rng: &mut R,
) {
    let proposal = Proposal::new(modes, density.region);
    let count = columns[0].len();
    for first in (0..count).step_by(BLOCK) {
        // Rows beyond the last particle are read as zero, moved in vain and written nowhere.
        let mut here: [State; BLOCK] =
            core::array::from_fn(|i| read(&columns.each_ref().map(|c| &**c), first + i));
        let mut log_density = density.log_densities(&here);
        for turn in 0..moves {
            let independent = turn % 2 == 0;
            step(
                &mut here,
                &mut log_density,
                density,
                &proposal,
                independent,
                rng,
            );
        }
        for (i, state) in here.into_iter().enumerate() {
            write(&mut columns, first + i, state);
        }
    }
}

/// One step of every particle of a block.
fn step<R: Rng + ?Sized>(
    here: &mut [State; BLOCK],
    log_density: &mut [f32; BLOCK],
    density: &Density<'_>,
    proposal: &Proposal<'_>,
    independent: bool,
    rng: &mut R,
) {
    let mut there = *here;
    // Log-density of proposing the way back, less that of the way there.
    let mut way_back = [0.0; BLOCK];
    for (state, way_back) in there.iter_mut().zip(&mut way_back) {
        if independent {
            let from = *state;
            *state = proposal.draw(rng);
            *way_back = proposal.log_density(&from) - proposal.log_density(state);
        } else if let Some(mode) = proposal.pick(rng) {
            *state = mode.step(state, WALK, deviations(rng));
        }
    }
    let there_log_density = density.log_densities(&there);
    let offers = there.iter().zip(there_log_density).zip(way_back);
    for ((state, log), ((offer, offer_log), way_back)) in
        here.iter_mut().zip(log_density).zip(offers)
    {
        // NaN is no reason to move.
        if ln(uniform_open(rng)) < offer_log - *log + way_back {
            (*state, *log) = (*offer, offer_log);
        }
    }
}
