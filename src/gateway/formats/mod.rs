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
pub use format::Sense;
pub use kn5r::Kn5r;
pub use kraken::Kraken;
pub use nmea::Nmea;
pub use ublox::Ublox;
pub use ubx::Ubx;

use crate::ConfigError;
use crate::config::require_all;
use crate::gateway::sigma::SigmaTable;
use format::{Format, Set, Told};

/// A set of formats: a tuple of up to twelve, such as [`All`] or `(Nmea, Agrelo)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no set of formats",
    note = "a set is a tuple of one to twelve formats: see `sets!` for more"
)]
pub trait Formats: Set<Config> {}

impl<S: Set<Config>> Formats for S {}

/// Compiles for sets alone.
const fn is_a_set<F: Formats>() {}

/// Lists the direction finders: what a program may choose from, their configurations, and the tuple of all formats.
macro_rules! finders {
    ($($(#[$doc:meta])* $module:ident: $format:ident $(<$kept:ident>)?,)+) => {
        /// A kind of direction finder.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
        #[cfg_attr(feature = "serde", derive(serde::Serialize))]
        pub struct Config {
            /// The only direction finder that is heard, where others are on the line, too; `None` for every one.
            pub finder: Option<Finder>,
            /// Whether places, courses and headings are used that a simulator made or that were entered by hand, as the
            /// receiver of a fixed station may send them: GGA of quality 7 or 8; RMC, VTG and THS of mode `M` or `S`.
            pub simulated: bool,
            $($(#[$doc])* pub $module: $module::Config,)+
        }

        impl Config {
            /// Every direction finder is heard.
            pub const DEFAULT: Self = Self {
                finder: None,
                simulated: Nmea::DEFAULT,
                $($module: <$format as Format>::DEFAULT,)+
            };

            /// The standard deviations that a direction finder's part tells, by the quality; `None` takes those of
            /// [`gateway::Config`](crate::gateway::Config).
            pub const fn sigmas_mut(&mut self, of: Finder) -> &mut Option<&'static SigmaTable> {
                match of {
                    $(Finder::$format => &mut self.$module.sigmas,)+
                }
            }

            /// Checks all fields.
            ///
            /// # Errors
            /// Names the field that is out of range.
            pub const fn check(&self) -> Result<(), ConfigError> {
                require_all!($(self.$module),+);
                Ok(())
            }
        }

        $(impl$(<$kept: $module::$kept>)? Told<Config> for $format$(<$kept>)? {
            fn told(all: &Config) -> Option<&Self::Config> {
                let is_heard = all.finder.is_none() || all.finder == Some(Finder::$format);
                is_heard.then_some(&all.$module)
            }
        })+

        /// Every format.
        pub type All = (Nmea, Ubx, $($format),+);

        const _: () = is_a_set::<All>();
    };
}

finders! {
    /// An Agrelo: `%BBB/Q`, bearing and quality.
    agrelo: Agrelo,
    /// A KrakenSDR, in its app format: `1756823719250, 297.0, 7.35, ...`.
    kraken: Kraken<Kept>,
    /// A u-blox board: `+UUDF:6C1DEBA4241B,-65,26,...`.
    ublox: Ublox,
    /// A KN5R-RDF: `C3469960084001663117493011`.
    kn5r: Kn5r,
    /// A direction finder that reports by APRS: `/BRG/NRQ` in the report of its position.
    aprs: Aprs,
}

impl Told<Config> for Nmea {
    fn told(all: &Config) -> Option<&bool> {
        Some(&all.simulated)
    }
}

impl Told<Config> for Ubx {
    fn told(_all: &Config) -> Option<&()> {
        Some(&())
    }
}

#[cfg(test)]
mod tests;
