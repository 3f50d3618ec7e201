//! The gateway of a vehicle in a city, with everything on: bearings may be wild, mirrored, correlated and biased, and
//! places are those of an ordinary receiver.

use foxhunt::{
    aoa::robust::{self, Errors, RobustLocator},
    gateway::{LONG_REPORT, Settings, Vehicle},
};

/// 256 particles, a memory of 64 bearings.
pub type Gateway = Vehicle<RobustLocator<256, 64>, LONG_REPORT>;

/// An array that may be turned by three degrees, places that may be three metres off.
pub const fn gateway() -> Gateway {
    let Ok(errors) = Errors::new().bias_deviation(0.05) else {
        panic!("a small angle");
    };
    let Ok(errors) = errors.position_deviation(3.0) else {
        panic!("a small distance");
    };
    let locator = RobustLocator::new(robust::Settings::new(errors));
    Vehicle::new(Settings::new(), locator)
}
