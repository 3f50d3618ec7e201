//! Where tags are tracked, and how.

use super::{Config, Walls};
use crate::ConfigError;
use crate::config::require_all;
use crate::fingerprint::{Encoding, RadioMap};

/// Where tags are tracked, and how: lent to every call of a tracker.
///
/// ```
/// use foxhunt::fingerprint::tracker::{Config, Site, Walls};
/// # use foxhunt::fingerprint::RadioMap;
/// # const BYTES: &[u8] =
/// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// # const MAP: RadioMap<'static> = match RadioMap::new(BYTES) {
/// #     Ok(map) => map,
/// #     Err(_) => panic!("damaged"),
/// # };
///
/// const SITE: Site<'static> = foxhunt::config!(Site {
///     map: MAP,
///     config: Config::TUNNEL,
///     walls: Walls::None,
/// });
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    /// What was surveyed, in [`Encoding::Moments`].
    pub map: RadioMap<'a>,
    /// How tags are tracked.
    pub config: Config,
    /// What particles do not pass.
    pub walls: Walls<'a>,
}

impl<'a> Site<'a> {
    /// A site without walls except the edges of the map.
    ///
    /// # Errors
    /// As [`Site::check`].
    pub const fn new(map: RadioMap<'a>, config: Config) -> Result<Self, ConfigError> {
        let site = Self {
            map,
            config,
            walls: Walls::None,
        };
        require_all!(site);
        Ok(site)
    }

    /// Checks the encoding of the map, and the configuration.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_all!(self.config);
        self.map.check_encoding(Encoding::Moments)
    }
}
