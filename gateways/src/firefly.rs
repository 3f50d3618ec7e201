//! The gateway of a vehicle whose particles are moved by a swarm of fireflies, with the posterior kept exact.

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
    refine::Firefly,
};

/// Two hundred fireflies, a memory of 64 bearings.
pub type Gateway = Vehicle<Locator<200, 64, Firefly>>;

/// The gateway before its first byte.
///
/// Each firefly is offered four places, towards the brightest of the other half or away from it.
pub const fn gateway() -> Gateway {
    let locator = Locator::with_refinement(locator::Settings::new(), Firefly::METROPOLIS);
    Vehicle::new(Settings::new(), locator)
}
