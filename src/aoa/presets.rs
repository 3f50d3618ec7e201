//! Locators for common situations, with their configurations.
//!
//! ```
//! use foxhunt::aoa::{Locator, presets};
//!
//! let locator = Locator::<presets::City<3>>::new(presets::CITY)?;
//! # Ok::<(), foxhunt::ConfigError>(())
//! ```

use super::manoeuvring::{self, Manoeuvring};
use super::multi::{self, MultiTarget};
use super::robust::{self, Robust};

/// Up to `K` sources in a city, any of which may drive off: 256 particles for each and a memory of 64 of its bearings.
pub type City<const K: usize> = MultiTarget<K, Manoeuvring<Robust<256, 64>>, 64>;

/// The configuration of [`City`]: bearings with outliers, mirrored and correlated ones, of an array that may be turned by
/// three degrees; places of an ordinary receiver.
pub const CITY: multi::Config<manoeuvring::Config> =
    multi::Config::new(manoeuvring::Config::new(robust::Config::CITY));
