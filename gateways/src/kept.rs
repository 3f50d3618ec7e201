//! The gateway of a vehicle in a city that goes on after a reset.
//!
//! As `robust`, but for up to two sources that stay where they are. Two snapshots of all that `robust` knows would take it
//! beyond 96 KiB.

use foxhunt::{
    aoa::{
        robust::{self, Errors, RobustLocator},
        sources::{self, Sources},
    },
    gateway::{LONG_REPORT, Settings, Vehicle},
};

/// 256 particles for each source and a memory of 64 of its bearings.
type Track = RobustLocator<256, 64>;

/// The gateway.
pub type Gateway = Vehicle<Sources<2, Track>, LONG_REPORT>;

/// An array that may be turned by three degrees, places that may be three metres off.
const ERRORS: Errors = {
    let Ok(errors) = Errors::new().bias_deviation(0.05) else {
        panic!("a small angle");
    };
    let Ok(errors) = errors.position_deviation(3.0) else {
        panic!("a small distance");
    };
    errors
};

const TRACK: Track = RobustLocator::new(robust::Settings::new(ERRORS));

/// The gateway before its first byte.
pub const fn gateway() -> Gateway {
    let sources = Sources::new(sources::Settings::new(), [TRACK; 2]);
    Vehicle::new(Settings::new(), sources)
}
