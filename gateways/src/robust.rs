//! The gateway of a vehicle in a city, with everything on: bearings may be outliers, mirrored, correlated and biased, and
//! of more than one source, any of which may drive off; places are those of an ordinary receiver.

use foxhunt::{
    aoa::{
        pursuit::{self, Pursuit},
        robust::{self, Errors},
        sources::{self, Sources},
    },
    gateway::{LONG_REPORT, Settings, Vehicle},
};

/// 256 particles for each source and a memory of 64 of its bearings.
type Track = Pursuit<256, 64>;

/// Up to three sources.
pub type Locator = Sources<3, Track>;

/// The gateway.
pub type Gateway = Vehicle<Locator, LONG_REPORT>;

/// An array that may be turned by three degrees, places that may be three metres off.
pub const ERRORS: Errors = {
    let Ok(errors) = Errors::new().bias_deviation(0.05) else {
        panic!("a small angle");
    };
    let Ok(errors) = errors.position_deviation(3.0) else {
        panic!("a small distance");
    };
    errors
};

/// The locator, by what is believed of the bearings.
pub const fn locator(bearings: robust::Settings) -> Locator {
    let track = pursuit::Settings::new(bearings);
    let tracks = [Track::new(track), Track::new(track), Track::new(track)];
    Sources::new(sources::Settings::new(), tracks)
}

/// The gateway before its first byte.
pub const fn gateway() -> Gateway {
    Vehicle::new(Settings::new(), locator(robust::Settings::new(ERRORS)))
}
