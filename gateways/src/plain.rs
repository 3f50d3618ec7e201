//! The gateway of a vehicle: one stationary source, and every bearing is right but for its error.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, Vehicle},
};

/// Two hundred particles, a memory of 64 bearings.
pub type Locator = Clean<200, 64>;

/// The gateway.
pub type Gateway = Vehicle<Locator>;

/// The defaults, for a car.
pub const CONFIG: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
