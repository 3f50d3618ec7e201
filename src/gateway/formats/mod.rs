//! The forms of lines that a gateway reads: each is a small type in a file of its own.
//!
//! Firmware names its formats as a tuple, such as `(Nmea, Agrelo)`, and links no others; [`All`] is the default. The first
//! byte of a line says which format it has, or the second where two begin with the same. A line of a direction finder that
//! is not in the tuple is unparsable.

pub mod agrelo;
pub mod aprs;
pub(super) mod format;
pub mod kn5r;
pub mod kraken;
pub mod nmea;
pub mod ublox;
mod ubx;

pub use agrelo::Agrelo;
pub use aprs::Aprs;
pub use format::Formats;
pub use kn5r::Kn5r;
pub use kraken::{Kraken, KrakenSpectrum};
pub use nmea::Nmea;
pub use ublox::Ublox;
pub use ubx::Ubx;

use crate::ConfigError;
use crate::config::require_all;

/// Direction in which the angles of a direction finder grow: builds of the KrakenSDR differ, and so do mountings of a
/// u-blox board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sense {
    /// Clockwise, as on a compass.
    #[default]
    Clockwise,
    /// Counter-clockwise, as in mathematics.
    CounterClockwise,
}

/// Lists the direction finders: what a program may choose from, their configurations, and the tuple of all formats.
macro_rules! finders {
    ($($(#[$doc:meta])* $module:ident: $format:ident,)+) => {
        /// A kind of direction finder.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[non_exhaustive]
        pub enum Finder {
            $($(#[$doc])* $format,)+
        }

        impl Finder {
            /// Every kind.
            pub const ALL: &[Self] = &[$(Self::$format),+];

            /// The name of the kind in options: that of its module.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$format => stringify!($module),)+
                }
            }

            /// A line, without its end.
            pub const fn example(self) -> &'static str {
                match self {
                    $(Self::$format => $module::EXAMPLE,)+
                }
            }
        }

        /// What the formats are told.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct Config {
            /// The only direction finder that is heard, where others are on the line, too; `None` for every one.
            pub finder: Option<Finder>,
            /// Receivers and compasses.
            pub nmea: nmea::Config,
            $($(#[$doc])* pub $module: $module::Config,)+
        }

        impl Config {
            /// Every direction finder is heard.
            pub const DEFAULT: Self = Self {
                finder: None,
                nmea: nmea::Config::DEFAULT,
                $($module: $module::Config::DEFAULT,)+
            };

            /// Checks all fields.
            ///
            /// # Errors
            /// Names the field that is out of range.
            pub const fn check(&self) -> Result<(), ConfigError> {
                require_all!($(self.$module),+);
                Ok(())
            }
        }

        /// Every format.
        pub type All = (Nmea, Ubx, $($format),+);
    };
}

finders! {
    /// An Agrelo: `%BBB/Q`.
    agrelo: Agrelo,
    /// A KrakenSDR, in its app format.
    kraken: Kraken,
    /// A u-blox board: `+UUDF:`.
    ublox: Ublox,
    /// A KN5R-RDF: `C` and 25 digits.
    kn5r: Kn5r,
    /// A station of APRS: `/BRG/NRQ` in the report of its position.
    aprs: Aprs,
}

impl Default for Config {
    fn default() -> Self {
        Self::DEFAULT
    }
}

#[cfg(test)]
mod tests;
