//! The gateway of a vehicle whose particles are moved by a swarm of fireflies, with the posterior kept exact.

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
    refine::{Acceptance, Firefly, Lengths},
};

/// Two hundred fireflies, a memory of 64 bearings.
pub type Gateway = Vehicle<Locator<200, 64, Firefly>>;

/// The gateway before its first byte.
///
/// Each firefly is offered four places, towards the brightest of the other half or away from it.
pub const fn gateway() -> Gateway {
    let Ok(swarm) = Firefly::improved(Lengths::Relative, 0.1, 4.0) else {
        panic!("absorption and flutter are positive");
    };
    let Ok(swarm) = swarm.iterations(4) else {
        panic!("four are some");
    };
    let locator = Locator::with_refinement(
        locator::Settings::new(),
        swarm.acceptance(Acceptance::Metropolis),
    );
    Vehicle::new(Settings::new(), locator)
}
