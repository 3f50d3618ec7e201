//! The gateway of a vehicle whose particles are moved by a swarm of fireflies, with the posterior kept exact.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, Vehicle},
    refine::{Acceptance, Firefly, Lengths},
};

/// Two hundred fireflies, a memory of 64 bearings.
pub type Gateway = Vehicle<Clean<200, 64, Firefly>>;

/// Each firefly is offered four places, towards the brightest of the other half or away from it.
const MOVES: Firefly = {
    let Ok(swarm) = Firefly::improved(Lengths::Relative, 0.1, 4.0) else {
        panic!("absorption and flutter are positive");
    };
    let Ok(swarm) = swarm.iterations(4) else {
        panic!("four are some");
    };
    swarm.acceptance(Acceptance::Metropolis)
};

/// The defaults, for a car, with these moves.
pub const CONFIG: Config<clean::Config<Firefly>> =
    Config::new(clean::Config::with_refinement(MOVES));
