//! When tracks are initiated, and when they are deleted.

use crate::ConfigError;
use crate::aoa::manoeuvring::check_around;
use crate::aoa::{clean, manoeuvring, robust};
use crate::config::require_within;

/// The configuration of a [`MultiTarget`](super::MultiTarget) locator, with that of its tracks.
///
/// ```
/// use foxhunt::aoa::multi::Config;
///
/// // Transmitters that pause for long.
/// const CONFIG: Config = foxhunt::config!(Config { false_deletion: 1e-9, ..Config::DEFAULT });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config<C = robust::Config> {
    /// Configuration of the tracks.
    pub track: C,
    /// Probability that outliers, however many, ever look like one more source, 1e-9 to 0.5. The smaller, the more bearings
    /// a new source takes.
    pub false_initiation: f32,
    /// Probability that the track of a source is deleted though the source is still heard as often as before, 1e-9 to 0.5. The
    /// smaller, the longer a source has to be silent.
    pub false_deletion: f32,
}

impl<C> Config<C> {
    /// The defaults, with the configuration of the tracks.
    pub const fn new(track: C) -> Self {
        Self {
            track,
            false_initiation: 1e-4,
            false_deletion: 1e-4,
        }
    }

    /// Checks all fields but that of the tracks.
    pub(super) const fn check_own(&self) -> Result<(), ConfigError> {
        require_within!(self:
            false_initiation 1e-9..=0.5,
            false_deletion 1e-9..=0.5,
        );
        Ok(())
    }
}

impl Config {
    /// Stationary sources, with the default robust locator for each.
    pub const DEFAULT: Self = Self::new(robust::Config::DEFAULT);
}

check_around!(track:
    robust::Config,
    clean::Config,
    manoeuvring::Config<robust::Config>,
    manoeuvring::Config<clean::Config>
);
