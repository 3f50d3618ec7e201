//! Where a gateway tracks, and how it treats its messages.

use crate::ConfigError;
use crate::config::{require_all, require_within};
use crate::fingerprint::tracker::{Building, Site};

/// How messages come over the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Framing {
    /// `$PFOXB` sentences.
    Lines,
    /// Binary frames, stuffed so that a zero ends each: a third of the bytes, and a better checksum.
    Frames,
}

/// Where a [`BeaconGateway`](super::BeaconGateway) tracks, and how it treats its messages: `G` is a [`Site`] of one floor, or a
/// [`Building`].
#[derive(Debug, Clone, Copy)]
pub struct Config<G> {
    /// The map, or the maps of all floors, and how tags are tracked on it.
    pub site: G,
    /// How messages come. Reports are sentences in either case.
    pub framing: Framing,
    /// Seeds the particles; the same bytes with the same seed give the same reports.
    pub seed: u64,
    /// A radio that has heard nothing for so many milliseconds while others have, a second to an hour, is reported as
    /// silent.
    pub silence_ms: u32,
}

impl<G: Copy> Config<G> {
    /// Sentences, and five seconds until a radio is silent.
    pub const fn new(site: G) -> Self {
        Self {
            site,
            framing: Framing::Lines,
            seed: 1,
            silence_ms: 5_000,
        }
    }

    const fn check_own(&self) -> Result<(), ConfigError> {
        require_within!(self: silence_ms 1_000..=3_600_000);
        Ok(())
    }
}

/// The check of a configuration by the type of the site: `const` functions cannot be generic in that.
macro_rules! check_on {
    ($($site:ty),+) => {$(
        impl Config<$site> {
            /// Checks every field.
            ///
            /// # Errors
            /// The first field that is out of its range.
            pub const fn check(&self) -> Result<(), ConfigError> {
                require_all!(self.site);
                self.check_own()
            }
        }
    )+};
}

check_on!(Site<'_>, Building<'_>);
