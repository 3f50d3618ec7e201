//! The gateway of a vehicle in a city that goes on after a reset.
//!
//! As `robust`, but for up to two stationary sources. Two snapshots of all that `robust` knows would take it beyond 96 KiB.

use foxhunt::{
    aoa::{Locate, presets},
    gateway::{Config, FullReport, Vehicle, formats::All},
};

use crate::PORTS;

/// Up to two sources.
pub type Locator = presets::StationaryCity<2>;

/// The gateway.
pub type Gateway = Vehicle<Locator, All, FullReport, PORTS>;

/// The defaults, for a car in a city.
pub const CONFIG: Config<<Locator as Locate>::Config> = Config::new(presets::STATIONARY_CITY);
