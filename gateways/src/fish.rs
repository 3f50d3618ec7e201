//! The gateway of a vehicle whose particles are moved by a school of fish, with the posterior kept exact.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, ShortReport, Vehicle},
    refine::FishSchool,
};

use crate::{PORTS, plain::Formats};

/// Two hundred fish, a memory of 64 bearings.
pub type Gateway = Vehicle<Clean<200, 64, FishSchool>, Formats, ShortReport, PORTS>;

/// Each fish is offered four places: steps of up to three sigmas of the cloud, and past the centre of four mates.
const MOVES: FishSchool = FishSchool::METROPOLIS;

/// The defaults, for a car, with these moves.
pub const CONFIG: Config<clean::Config<FishSchool>> =
    Config::new(clean::Config::with_refinement(MOVES));
