//! The gateway of a vehicle on a real board: as `plain`, but it reads every format.

use foxhunt::aoa::clean;
use foxhunt::gateway::{Config, ShortReport, Vehicle, formats::All};

use crate::{PORTS, plain::Locator};

/// The gateway.
pub type Gateway = Vehicle<Locator, All, ShortReport, PORTS>;

/// The defaults, for a car.
pub const CONFIG: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
