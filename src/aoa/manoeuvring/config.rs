//! How the source is thought to move.

use crate::ConfigError;
use crate::aoa::{clean, robust};
use crate::config::{require, require_within};

/// The configuration of a [`Manoeuvring`](super::Manoeuvring) locator, with that of the stationary locator inside.
///
/// ```
/// use foxhunt::aoa::{clean, manoeuvring::Config, robust};
///
/// // A cyclist, hunted with an array that has a bias.
/// const CYCLIST: Config = foxhunt::config!(Config {
///     stationary: robust::Config::CITY,
///     speed_m_s: 5.0,
///     slowest_m_s: 3.0,
///     straight_s: 30.0,
///     ..Config::DEFAULT
/// });
/// // A car, with bearings that are never wrong.
/// const CLEAN: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config<C = robust::Config> {
    /// Configuration of the stationary locator.
    pub stationary: C,
    /// Root mean square of the source's speed while it moves, in metres a second, 0.05 to 100: of the fastest source that is
    /// thought of.
    pub speed_m_s: f32,
    /// The same of the slowest, at least 0.05 and at most as large. A quarter of all are slow.
    pub slowest_m_s: f32,
    /// Mean time for which the source is stationary, in seconds, 1 to 1e6. The longer, the more evidence it takes to
    /// believe that the source moves.
    pub stationary_s: f32,
    /// Mean time for which the source moves before it stops again, in seconds, 1 to 1e6.
    pub moving_s: f32,
    /// Mean time for which the source moves straight on before it takes another velocity, in seconds, 1 to 1e5. The more
    /// agile the source, the shorter.
    pub straight_s: f32,
}

impl<C> Config<C> {
    /// A car that is hunted by a car, with the configuration of the stationary locator.
    pub const fn new(stationary: C) -> Self {
        Self {
            stationary,
            speed_m_s: 10.0,
            slowest_m_s: 1.4,
            stationary_s: 600.0,
            moving_s: 180.0,
            straight_s: 20.0,
        }
    }

    /// Checks all fields but that of the stationary locator.
    pub(super) const fn check_own(&self) -> Result<(), ConfigError> {
        require_within!(self:
            speed_m_s 0.05..=100.0,
            slowest_m_s 0.05..=100.0,
            stationary_s 1.0..=1e6,
            moving_s 1.0..=1e6,
            straight_s 1.0..=1e5,
        );
        require!(
            self.slowest_m_s <= self.speed_m_s,
            "slowest_m_s is larger than speed_m_s"
        );
        Ok(())
    }
}

impl Config {
    /// A car, or somebody on foot, hunted by a car, with the default robust locator.
    pub const DEFAULT: Self = Self::new(robust::Config::DEFAULT);

    /// Somebody on foot, who stops as often as not.
    pub const WALKER: Self = Self {
        speed_m_s: 1.4,
        slowest_m_s: 0.7,
        stationary_s: 120.0,
        moving_s: 120.0,
        straight_s: 30.0,
        ..Self::DEFAULT
    };

    /// Somebody who walks among fixed arrays in a room, for a locator with as many biases as there are stations: stands for
    /// moments, and turns every few metres.
    pub const ROOM: Self = Self {
        stationary: robust::Config::ROOM,
        speed_m_s: 1.4,
        slowest_m_s: 0.7,
        stationary_s: 3.0,
        moving_s: 60.0,
        straight_s: 5.0,
    };
}

/// The checks of a configuration by the type of the `part` in it: `const` functions cannot be generic in that.
macro_rules! check_around {
    ($part:ident: $($type:ty),+ $(,)?) => {$(
        impl Config<$type> {
            /// Checks the fields.
            ///
            /// # Errors
            /// Names the field that is out of range.
            pub const fn check(&self) -> Result<(), $crate::ConfigError> {
                $crate::config::require_all!(self.$part);
                self.check_own()
            }
        }
    )+};
}

pub(in crate::aoa) use check_around;

check_around!(stationary: robust::Config, clean::Config);
