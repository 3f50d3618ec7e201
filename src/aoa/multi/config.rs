//! When tracks are initiated, and when they are deleted.

use crate::ConfigError;
use crate::aoa::manoeuvring::check_around;
use crate::aoa::{clean, manoeuvring, robust};
use crate::config::{require, require_within};

/// The configuration of a [`MultiTarget`](super::MultiTarget) locator, with that of its tracks.
///
/// ```
/// use foxhunt::aoa::multi::Config;
///
/// // A channel with many transmitters that are heard seldom.
/// const CONFIG: Config = foxhunt::config!(Config { memory_s: 3600.0, least_rate: 0.02, ..Config::DEFAULT });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config<C = robust::Config> {
    /// Configuration of the tracks.
    pub track: C,
    /// Probability that outliers, however many, ever look like one more source, 1e-9 to 0.5. The smaller, the more bearings
    /// a new source takes.
    pub false_initiation: f32,
    /// Number of later bearings after which a bearing's influence on the rates has fallen by a factor of e, 8 to 1e6.
    pub memory_bearings: f32,
    /// Seconds after which it has fallen by a factor of e, at least 1.
    pub memory_s: f32,
    /// The track of a source that has less than this fraction of the latest bearings is deleted, 0 to 0.5. Zero keeps all.
    pub least_rate: f32,
}

impl<C> Config<C> {
    /// The defaults, with the configuration of the tracks.
    pub const fn new(track: C) -> Self {
        Self {
            track,
            false_initiation: 1e-3,
            memory_bearings: 64.0,
            memory_s: 600.0,
            least_rate: 0.04,
        }
    }

    /// Checks all fields but that of the tracks.
    pub(super) const fn check_own(&self) -> Result<(), ConfigError> {
        require_within!(self:
            false_initiation 1e-9..=0.5,
            memory_bearings 8.0..=1e6,
            least_rate 0.0..=0.5,
        );
        require!(self.memory_s >= 1.0, "memory_s is less than 1");
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
