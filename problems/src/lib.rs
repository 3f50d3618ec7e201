//! The problems of the published experiments, ready to run.
//!
//! Each simulates itself from any generator and hands out, step by step, the dynamics of the step, the true state
//! and the measurement as a likelihood:
//!
//! ```
//! use foxhunt::filter::ParticleFilter;
//! use foxhunt_problems::growth;
//! use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
//! use foxhunt::resample::Scheme;
//!
//! let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
//! let mut filter = ParticleFilter::<1, 50>::new();
//! filter.initialise(&mut rng, |_| [growth::START]);
//! let mut squares = 0.0;
//! for (dynamics, truth, measurement) in growth::simulate(&mut nature).take(50) {
//!     filter.predict(&dynamics, 1.0, &mut rng);
//!     filter.update(&measurement).unwrap();
//!     squares += (filter.mean()[0] - truth).powi(2);
//!     filter.resample(Scheme::Systematic, &mut rng);
//! }
//! assert!((squares / 50.0).sqrt() < 8.0);
//! ```

#![no_std]

pub mod bearings;
pub mod gamma;
pub mod growth;
