//! Metropolis-Hastings moves of particles against the posterior of all bearings.

use crate::math::ln;
use crate::model::Likelihood;
use crate::random::{Rng, uniform_open};

/// Particles that are moved together, to evaluate each bearing on a short column of them: a longer one needs more stack,
/// a shorter one more passes over the bearings.
pub(in crate::aoa) const BLOCK: usize = 16;

/// States of some particles, one column per dimension.
pub(in crate::aoa) type Block<const D: usize> = [[f32; BLOCK]; D];

/// The posterior of all bearings.
pub(in crate::aoa) trait Target<const D: usize> {
    /// Log-densities of several states, up to the same constant.
    fn log_densities(&self, states: &Block<D>) -> [f32; BLOCK];
}

/// Where particles are moved.
pub(in crate::aoa) trait Proposal<const D: usize> {
    /// A state that does not depend on where the particle is. RNG consumption is constant.
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> [f32; D];

    /// Log-density of a draw, up to a constant.
    fn log_density(&self, state: &[f32; D]) -> f32;

    /// A step of a random walk.
    fn walk<R: Rng + ?Sized>(&self, from: &[f32; D], rng: &mut R) -> [f32; D];
}

/// What draws of a proposal are worth, as a likelihood: the density of the target over that of the proposal.
pub(in crate::aoa) struct Importance<'a, T, P> {
    pub(in crate::aoa) target: &'a T,
    pub(in crate::aoa) proposal: &'a P,
}

impl<const D: usize, T: Target<D>, P: Proposal<D>> Likelihood<D> for Importance<'_, T, P> {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        let [log_density, ..] = self.target.log_densities(&state.map(|x| [x; BLOCK]));
        log_density - self.proposal.log_density(state)
    }

    #[inline(never)]
    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        for (place, out) in out.chunks_mut(BLOCK).enumerate() {
            let states = columns.map(|column| block(column, BLOCK * place));
            let log_densities = self.target.log_densities(&states);
            for (i, (out, log_density)) in out.iter_mut().zip(log_densities).enumerate() {
                let state = states.each_ref().map(|column| column[i]);
                *out = log_density - self.proposal.log_density(&state);
            }
        }
    }
}

/// Moves every particle `moves` times: in turns by a draw, which forgets where it was, and by a step of a random walk,
/// which finds its way where the posterior is not normal. RNG consumption is constant.
#[inline(never)]
pub(in crate::aoa) fn sweep<const D: usize, R: Rng + ?Sized>(
    mut columns: [&mut [f32]; D],
    target: &impl Target<D>,
    proposal: &impl Proposal<D>,
    moves: u8,
    rng: &mut R,
) {
    let count = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    for first in (0..count).step_by(BLOCK) {
        let mut here = columns.each_ref().map(|column| block(column, first));
        let mut log_density = target.log_densities(&here);
        for turn in 0..moves {
            let independent = turn % 2 == 0;
            step(
                &mut here,
                &mut log_density,
                target,
                proposal,
                independent,
                rng,
            );
        }
        for (from, to) in here.iter().zip(&mut columns) {
            transfer(from, to.get_mut(first..).unwrap_or_default());
        }
    }
}

/// A block of a column. A short one is filled up with its first particle, which then moves in vain.
fn block(column: &[f32], first: usize) -> [f32; BLOCK] {
    let from = column.get(first..).unwrap_or_default();
    let mut to = [from.first().copied().unwrap_or(0.0); BLOCK];
    transfer(from, &mut to);
    to
}

/// Copies as much as there is room for.
fn transfer(from: &[f32], to: &mut [f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// One step of every particle of a block.
fn step<const D: usize, R: Rng + ?Sized>(
    here: &mut Block<D>,
    log_density: &mut [f32; BLOCK],
    target: &impl Target<D>,
    proposal: &impl Proposal<D>,
    independent: bool,
    rng: &mut R,
) {
    let mut there = *here;
    // Log-density of proposing the way back, less that of the way there.
    let mut way_back = [0.0; BLOCK];
    for i in 0..BLOCK {
        let from = here.each_ref().map(|column| column[i]);
        let to = if independent {
            let to = proposal.draw(rng);
            way_back[i] = proposal.log_density(&from) - proposal.log_density(&to);
            to
        } else {
            proposal.walk(&from, rng)
        };
        for (column, to) in there.iter_mut().zip(to) {
            column[i] = to;
        }
    }
    let offered = target.log_densities(&there);
    for i in 0..BLOCK {
        let log_ratio = offered[i] - log_density[i] + way_back[i];
        // NaN is no reason to move.
        if ln(uniform_open(rng)) < log_ratio {
            for (here, there) in here.iter_mut().zip(&there) {
                here[i] = there[i];
            }
            log_density[i] = offered[i];
        }
    }
}
