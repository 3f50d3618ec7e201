//! The gateway of a vehicle whose particles are moved by a school of fish, with the posterior kept exact.

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
    refine::FishSchool,
};

/// Two hundred fish, a memory of 64 bearings.
pub type Gateway = Vehicle<Locator<200, 64, FishSchool>>;

/// The gateway before its first byte.
///
/// Each fish is offered four places: steps of up to three sigmas of the cloud, and past the centre of four mates.
pub const fn gateway() -> Gateway {
    let locator = Locator::with_refinement(locator::Settings::new(), FishSchool::METROPOLIS);
    Vehicle::new(Settings::new(), locator)
}
