//! What moves the particles of a locator when they have become too few.

use core::fmt::Debug;

use super::posterior::{Posterior, mode};
use super::proposal::ModeProposal;
use crate::ConfigError;
use crate::aoa::core::sweep;
use crate::filter::ParticleFilter;
use crate::random::Rng;
use crate::refine::{Memory, Refinement};
use crate::resample::Scheme;

/// The moves of a locator that was not given a refinement: draws about the mode of the posterior and steps of a random
/// walk, in turns, accepted by Metropolis and Hastings. They need no memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ModeMoves;

/// What may move the particles of a locator: [`ModeMoves`], or any [`Refinement`] of a position.
pub trait Moves<const N: usize>: Rejuvenate<N> + Copy + PartialEq + Debug {}

impl<const N: usize, M: Rejuvenate<N> + Copy + PartialEq + Debug> Moves<N> for M {}

/// Sealed implementation detail.
pub trait Rejuvenate<const N: usize> {
    /// What it works in.
    type Memory: Debug + Clone;

    /// An unused memory.
    const EMPTY: Self::Memory;

    /// Checks the configuration.
    fn check(&self) -> Result<(), ConfigError>;

    /// Resamples the particles and moves them by what the bearings say.
    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        memory: &mut Self::Memory,
        rng: &mut R,
    );
}

impl<const N: usize> Rejuvenate<N> for ModeMoves {
    type Memory = ();

    const EMPTY: () = ();

    fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }

    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        (): &mut (),
        rng: &mut R,
    ) {
        let mean = filter.mean();
        let proposal = mode(posterior.bearings(), mean)
            .ok()
            .or_else(|| ModeProposal::new(mean, filter.covariance()));
        filter.resample(Scheme::Systematic, rng);
        if let Some(proposal) = proposal {
            sweep(filter.columns_mut(), posterior, &proposal, moves, rng);
        }
    }
}

/// A refinement moves particles by the differences between them. Where they are worth fewer than this, copies of a single
/// one would stay together for ever, and the moves about the mode part them first: less leaves copies, more takes time.
const COMPANY: f32 = 8.0;

impl<const N: usize, F: Refinement<2>> Rejuvenate<N> for F {
    type Memory = Memory<2, N>;

    const EMPTY: Self::Memory = Memory::EMPTY;

    fn check(&self) -> Result<(), ConfigError> {
        Refinement::check(self)
    }

    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        memory: &mut Self::Memory,
        rng: &mut R,
    ) {
        if filter.effective_sample_size() < COMPANY {
            ModeMoves.rejuvenate(filter, posterior, moves, &mut (), rng);
        } else {
            filter.resample(Scheme::Systematic, rng);
        }
        filter.refine(self, posterior, memory, rng);
    }
}
