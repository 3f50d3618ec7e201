//! The gateway of a vehicle in a city, with everything on: bearings may be wild, mirrored, correlated and biased, and of
//! more than one source; places are those of an ordinary receiver.

use foxhunt::{
    aoa::{
        robust::{self, Errors, RobustLocator},
        sources::{self, Sources},
    },
    gateway::{LONG_REPORT, Settings, Vehicle},
};

/// 256 particles for each source and a memory of 64 of its bearings.
type Track = RobustLocator<256, 64>;

/// Up to three sources.
pub type Gateway = Vehicle<Sources<3, Track>, LONG_REPORT>;

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

pub const fn gateway() -> Gateway {
    let sources = Sources::new(sources::Settings::new(), [TRACK; 3]);
    Vehicle::new(Settings::new(), sources)
}
