//! The gateway of a vehicle in a city, with everything on: bearings may be outliers, mirrored, correlated and biased, and of
//! more than one source, any of which may drive off; places are those of an ordinary receiver.

use foxhunt::{
    aoa::{Locate, presets},
    gateway::{Config, FullReport, Vehicle, formats::All},
};

use crate::PORTS;

/// Up to three sources.
pub type Locator = presets::City<3>;

/// The gateway.
pub type Gateway = Vehicle<Locator, All, FullReport, PORTS>;

/// The defaults, for a car in a city.
pub const CONFIG: Config<<Locator as Locate>::Config> = Config::new(presets::CITY);
