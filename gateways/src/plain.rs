//! The gateway of a vehicle: one source at rest, and every bearing is right but for its error.

use foxhunt::{
    aoa::locator,
    gateway::{Settings, Vehicle},
};

/// Two hundred particles, a memory of 64 bearings, the settings for a car.
pub type Locator = locator::Locator<200, 64>;

/// The gateway.
pub type Gateway = Vehicle<Locator>;

/// The gateway before its first byte.
pub const fn gateway() -> Gateway {
    Vehicle::new(Settings::new(), Locator::new(locator::Settings::new()))
}
