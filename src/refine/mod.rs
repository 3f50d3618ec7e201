//! Refinements: ways to move particles to better places, by swarms and by evolution.
//!
//! A refinement is a value, made and checked once, that is applied to a cloud of equally weighted particles
//! and a log-density, the target. Any works with any model and any dimension, in place, with a number of
//! evaluations of the density that it states beforehand.
//!
//! | refinement | moves a particle | evaluations per particle and iteration |
//! |---|---|---|
//! | [`FishSchool`] | to better places in sight, to the centre of its mates, to the best of them | up to tries + 2 |
//! | [`Firefly`] | towards all that are brighter, or the brightest | 1 |
//! | [`DifferentialEvolution`] | by differences of others | 1 |
//!
//! # Two forms of each
//!
//! Published swarms optimise: they draw the cloud together at the modes of the target, and what they leave
//! is too narrow to be a posterior. [`Acceptance::Greedy`] is that form, to be applied to the predicted cloud
//! before [`crate::filter::ParticleFilter::update`].
//!
//! [`Acceptance::Metropolis`] makes of the same ideas moves that leave the target invariant: particles that are
//! drawn from it are still drawn from it afterwards, only elsewhere, so that copies part. It belongs after
//! [`crate::filter::ParticleFilter::resample`], with the posterior as the target, prior included.
//!
//! ```
//! use foxhunt::filter::ParticleFilter;
//! use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
//! use foxhunt::refine::{Acceptance, DifferentialEvolution, Memory};
//! use foxhunt::resample::Scheme;
//!
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut filter = ParticleFilter::<2, 200>::new();
//! let mut memory = Memory::new();
//! let prior = |[x, y]: &[f32; 2]| -0.5 * (x * x + y * y);
//! let likelihood = |[x, y]: &[f32; 2]| -0.5 * ((x * y - 1.0) / 0.1).powi(2);
//! let posterior = |state: &[f32; 2]| prior(state) + likelihood(state);
//!
//! filter.initialise(&mut rng, |rng| [normal(rng), normal(rng)]);
//! filter.update(&likelihood).unwrap();
//! filter.resample(Scheme::Systematic, &mut rng);
//! // Few particles were left, with many copies of each: move them apart.
//! let evolution = DifferentialEvolution::new().acceptance(Acceptance::Metropolis);
//! let report = filter.refine(&evolution, &posterior, &mut memory, &mut rng);
//! assert!(report.moves > 500);
//! ```

mod acceptance;
pub mod evolution;
pub mod firefly;
pub mod fish;
mod lengths;
mod neighbours;
mod population;

pub use acceptance::Acceptance;
pub use evolution::DifferentialEvolution;
pub use firefly::Firefly;
pub use fish::FishSchool;
pub use lengths::Lengths;

use crate::model::Likelihood;
use crate::random::Rng;
use neighbours::{CELLS, Grid, Mate};

/// A way to move particles by a log-density.
pub trait Refinement<const D: usize> {
    /// Moves equally weighted particles, one column per dimension of their state, by the density `target`.
    ///
    /// A state whose density is NaN or plus infinity is impossible, like one of minus infinity: no particle moves
    /// there. Particles beyond the workspace stay where they are.
    fn refine<R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        workspace: &mut Workspace<'_, D>,
        rng: &mut R,
    ) -> Report;

    /// The most evaluations of the density that a refinement of so many particles takes.
    fn evaluations(&self, particles: usize) -> usize;
}

/// What a refinement did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// Iterations, or generations; fewer than were asked for if it stopped early.
    pub iterations: usize,
    /// Evaluations of the density.
    pub evaluations: usize,
    /// Places that particles were offered.
    pub proposals: usize,
    /// Places that they took.
    pub moves: usize,
}

/// What a refinement of `N` particles of `D` dimensions works in: 4 N (2 D + 3) + 1028 bytes, which hold nothing of
/// use between calls. One serves any number of filters and refinements. `N` is at most 65,536, as in a filter.
#[derive(Debug, Clone)]
pub struct Memory<const D: usize, const N: usize> {
    log_densities: [f32; N],
    mates: [Mate<D>; N],
    cells: [u32; CELLS + 1],
}

impl<const D: usize, const N: usize> Memory<D, N> {
    /// Memory in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(N <= 1 << 16, "up to 65,536 particles");
        Self {
            log_densities: [0.0; N],
            mates: [Mate::NONE; N],
            cells: [0; CELLS + 1],
        }
    };

    /// [`Memory::EMPTY`].
    pub const fn new() -> Self {
        Self::EMPTY
    }

    /// The memory without its size, as refinements take it.
    pub const fn workspace(&mut self) -> Workspace<'_, D> {
        Workspace {
            log_densities: &mut self.log_densities,
            grid: Grid {
                mates: &mut self.mates,
                cells: &mut self.cells,
            },
        }
    }
}

impl<const D: usize, const N: usize> Default for Memory<D, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Borrowed [`Memory`] of any size.
#[derive(Debug)]
pub struct Workspace<'a, const D: usize> {
    log_densities: &'a mut [f32],
    grid: Grid<'a, D>,
}

#[cfg(test)]
mod tests;
