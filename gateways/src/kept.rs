//! The gateway of a vehicle in a city that goes on after a reset.
//!
//! As `robust`, but for up to two stationary sources. Two snapshots of all that `robust` knows would take it beyond 96 KiB.

use foxhunt::{
    aoa::{Locate, MultiTarget, Robust, multi, robust},
    gateway::{Config, FullReport, Vehicle, formats::All},
};

use crate::PORTS;

/// Up to two sources.
pub type Locator = MultiTarget<2, Robust<256, 64>, 64>;

/// The gateway.
pub type Gateway = Vehicle<Locator, All, FullReport, PORTS>;

/// The defaults, for a car in a city.
pub const CONFIG: Config<<Locator as Locate>::Config> =
    Config::new(multi::Config::new(robust::Config::CITY));
