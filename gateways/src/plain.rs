//! The gateway of a vehicle: one stationary source, and every bearing is right but for its error.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{
        Config, ShortReport, Vehicle,
        formats::{Agrelo, Kraken, Nmea},
    },
};

use crate::PORTS;

/// Two hundred particles, a memory of 64 bearings.
pub type Locator = Clean<200, 64>;

/// What the firmware reads; it links no other formats.
pub type Formats = (Nmea, Agrelo, Kraken);

/// The gateway.
pub type Gateway = Vehicle<Locator, Formats, ShortReport, PORTS>;

/// The defaults, for a car.
pub const CONFIG: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
