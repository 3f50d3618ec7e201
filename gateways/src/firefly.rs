//! The gateway of a vehicle whose particles are moved by a swarm of fireflies, with the posterior kept exact.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, ShortReport, Vehicle},
    refine::Firefly,
};

use crate::{PORTS, plain::Formats};

/// Two hundred fireflies, a memory of 64 bearings.
pub type Gateway = Vehicle<Clean<200, 64, Firefly>, Formats, ShortReport, PORTS>;

/// Each firefly is offered four places, towards the brightest of the other half or away from it.
const MOVES: Firefly = Firefly::METROPOLIS;

/// The defaults, for a car, with these moves.
pub const CONFIG: Config<clean::Config<Firefly>> =
    Config::new(clean::Config::with_refinement(MOVES));
