//! The trait of refinements, and the memory that they work in.

use super::neighbours::Grid;
use super::population::Report;
use crate::ConfigError;
use crate::model::Likelihood;
use crate::random::Rng;

/// Whether particles gather at the modes of the target or stay a sample of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Acceptance {
    /// As published: fish and fireflies go where their rules send them, evolution keeps the better of two. The
    /// cloud shrinks towards the modes; means profit from it at times, credible regions never.
    ///
    /// In a [`Clean`](crate::aoa::Clean) locator it draws the particles together at the mode: the ellipse is too small and
    /// holds the source far less often than it says, and the effective sample size no longer tells when the particles must
    /// move. With lengths relative to the cloud, fish and fireflies that have gathered cannot follow the mode, and the fix
    /// stays behind by many sigmas. Give them [`Lengths::Absolute`](crate::refine::Lengths::Absolute) of the accuracy that
    /// is hoped for, which is then what the ellipse shows, and have them move after every bearing, with
    /// [`resample_below`](crate::aoa::clean::Config::resample_below) at 1.
    #[default]
    Greedy,
    /// As Metropolis-Hastings proposals, with the probability of the way back where it is another than that of
    /// the way there: the target stays invariant, whatever the number of particles and iterations.
    Metropolis,
}

/// A way to move particles by a log-density.
pub trait Refinement<const D: usize> {
    /// Moves equally weighted particles, one column per dimension of their state, by the density `target`.
    ///
    /// A state whose density is NaN or plus infinity is impossible, like one of minus infinity: no particle moves
    /// there. Particles for which there is no memory stay where they are.
    fn refine<const N: usize, R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report;

    /// The most evaluations of the density that a refinement of so many particles takes.
    fn evaluations(&self, particles: usize) -> usize;

    /// Checks the configuration.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    fn check(&self) -> Result<(), ConfigError>;
}

/// What a refinement of `N` particles of `D` dimensions works in: 4 N (2 D + 3) + 1028 bytes, which hold nothing of
/// use between calls. One serves any number of filters and refinements. `N` is at most 65,536, as in a filter.
#[derive(Debug, Clone)]
pub struct Memory<const D: usize, const N: usize> {
    pub(super) log_densities: [f32; N],
    pub(super) grid: Grid<D, N>,
}

impl<const D: usize, const N: usize> Memory<D, N> {
    /// Memory in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(N <= 1 << 16, "up to 65,536 particles");
        Self {
            log_densities: [0.0; N],
            grid: Grid::EMPTY,
        }
    };
}
