//! The gateway of a vehicle whose particles are moved by differential evolution, with the posterior kept exact.

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
    refine::DifferentialEvolution,
};

/// Two hundred particles, a memory of 64 bearings.
pub type Gateway = Vehicle<Locator<200, 64, DifferentialEvolution>>;

/// The gateway before its first byte.
///
/// Four generations move the particles.
pub const fn gateway() -> Gateway {
    let locator =
        Locator::with_refinement(locator::Settings::new(), DifferentialEvolution::METROPOLIS);
    Vehicle::new(Settings::new(), locator)
}
