//! The gateway of a vehicle whose particles are moved by differential evolution, with the posterior kept exact.

use foxhunt::{
    gateway::{Settings, Vehicle},
    refine::{Acceptance, DifferentialEvolution},
};

/// Two hundred particles, a memory of 64 bearings.
pub type Gateway = Vehicle<200, 64, DifferentialEvolution>;

/// Four generations.
pub const fn gateway() -> Gateway {
    let Ok(evolution) = DifferentialEvolution::new().generations(4) else {
        panic!("four are some");
    };
    Vehicle::with_refinement(
        Settings::new(),
        evolution.acceptance(Acceptance::Metropolis),
    )
}
