//! The gateway of a vehicle whose particles are moved by differential evolution, with the posterior kept exact.

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
    refine::{Acceptance, DifferentialEvolution},
};

/// Two hundred particles, a memory of 64 bearings.
pub type Gateway = Vehicle<Locator<200, 64, DifferentialEvolution>>;

/// The gateway before its first byte.
///
/// Four generations move the particles.
pub const fn gateway() -> Gateway {
    let Ok(evolution) = DifferentialEvolution::new().generations(4) else {
        panic!("four are some");
    };
    let locator = Locator::with_refinement(
        locator::Settings::new(),
        evolution.acceptance(Acceptance::Metropolis),
    );
    Vehicle::new(Settings::new(), locator)
}
