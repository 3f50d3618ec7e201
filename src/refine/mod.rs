//! Refinements: ways to move particles to better places, by swarms and by evolution.
//!
//! A refinement is a configuration, checked once, that is applied to a cloud of equally weighted particles
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
//! use foxhunt::refine::{DifferentialEvolution, Memory};
//! use foxhunt::resample::Scheme;
//!
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut filter = ParticleFilter::<2, 200>::new();
//! let mut memory = Memory::EMPTY;
//! let prior = |[x, y]: &[f32; 2]| -0.5 * (x * x + y * y);
//! let likelihood = |[x, y]: &[f32; 2]| -0.5 * ((x * y - 1.0) / 0.1).powi(2);
//! let posterior = |state: &[f32; 2]| prior(state) + likelihood(state);
//!
//! filter.initialise(&mut rng, |rng| [normal(rng), normal(rng)]);
//! filter.update(&likelihood).unwrap();
//! filter.resample(Scheme::Systematic, &mut rng);
//! // Few particles were left, with many copies of each: move them apart.
//! let report = filter.refine(&DifferentialEvolution::METROPOLIS, &posterior, &mut memory, &mut rng);
//! assert!(report.moves > 100);
//! ```

mod evolution;
mod firefly;
mod fish;
mod lengths;
mod neighbours;
mod population;
mod refinement;
#[cfg(test)]
mod tests;

pub use evolution::DifferentialEvolution;
pub use firefly::Firefly;
pub use fish::FishSchool;
pub use lengths::Lengths;
pub use population::Report;
pub use refinement::{Acceptance, Memory, Refinement};
