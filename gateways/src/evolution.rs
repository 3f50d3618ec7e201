//! The gateway of a vehicle whose particles are moved by differential evolution, with the posterior kept exact.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, ShortReport, Vehicle},
    refine::DifferentialEvolution,
};

use crate::{PORTS, plain::Formats};

/// Two hundred particles, a memory of 64 bearings.
pub type Gateway = Vehicle<Clean<200, 64, DifferentialEvolution>, Formats, ShortReport, PORTS>;

/// Four generations move the particles.
const MOVES: DifferentialEvolution = DifferentialEvolution::METROPOLIS;

/// The defaults, for a car, with these moves.
pub const CONFIG: Config<clean::Config<DifferentialEvolution>> =
    Config::new(clean::Config::with_refinement(MOVES));
