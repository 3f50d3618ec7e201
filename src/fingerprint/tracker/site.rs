//! Where tags are tracked, and how.

use super::{Settings, Walls};
use crate::fingerprint::{Encoding, MapError, RadioMap};

/// Where tags are tracked, and how: what all trackers share and none changes.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    pub(super) map: RadioMap<'a>,
    pub(super) walls: Walls<'a>,
    pub(super) settings: Settings,
}

impl<'a> Site<'a> {
    /// With no walls but the edges of the map.
    ///
    /// # Errors
    /// [`MapError::Encoding`] unless the map holds [`Encoding::Moments`], [`MapError::Lattice`] for a single column of
    /// points: a line has to be a row.
    pub const fn new(map: RadioMap<'a>, settings: Settings) -> Result<Self, MapError> {
        if map.lattice().columns() < 2 {
            return Err(MapError::Lattice);
        }
        if !matches!(map.encoding(), Encoding::Moments) {
            return Err(MapError::Encoding);
        }
        Ok(Self {
            map,
            walls: Walls::None,
            settings,
        })
    }

    /// Particles do not pass them.
    pub const fn with_walls(mut self, walls: Walls<'a>) -> Self {
        self.walls = walls;
        self
    }

    /// As given.
    pub const fn map(&self) -> &RadioMap<'a> {
        &self.map
    }

    /// As given.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }
}
