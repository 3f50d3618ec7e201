//! What a tracker asks of the site that tags are on.

use super::floor::{Floor, OneFloor};
use super::{Config, Site, Walls};
use crate::fingerprint::{Lattice, RadioMap};
use crate::random::Rng;

/// Where tags are: a [`Site`] of one floor, or a [`Building`](super::Building). Nobody else implements it.
///
/// All floors have the same lattice.
pub trait Ground {
    /// What a particle knows of its floor.
    type Floor: Floor;

    /// How tags are tracked.
    #[doc(hidden)]
    fn config(&self) -> &Config;

    /// The number of floors.
    #[doc(hidden)]
    fn floors(&self) -> u8;

    /// The map of a floor.
    #[doc(hidden)]
    fn map(&self, floor: u8) -> &RadioMap<'_>;

    /// The walls of a floor.
    #[doc(hidden)]
    fn walls(&self, floor: u8) -> &Walls<'_>;

    /// Lets particles at these places, in steps of the lattice, change their floor in `dt` seconds.
    #[doc(hidden)]
    fn change_floors<const N: usize, R: Rng + ?Sized>(
        &self,
        places: &[[f32; N]; 2],
        floors: &mut [Self::Floor; N],
        dt: f32,
        rng: &mut R,
    );

    /// The lattice of every floor.
    #[doc(hidden)]
    #[inline(always)]
    fn lattice(&self) -> &Lattice {
        self.map(0).lattice()
    }

    /// The points of all floors.
    #[doc(hidden)]
    #[inline(always)]
    fn points(&self) -> usize {
        usize::from(self.floors()) * self.lattice().points()
    }
}

impl Ground for Site<'_> {
    type Floor = OneFloor;

    #[inline(always)]
    fn config(&self) -> &Config {
        &self.config
    }

    #[inline(always)]
    fn floors(&self) -> u8 {
        1
    }

    #[inline(always)]
    fn map(&self, _: u8) -> &RadioMap<'_> {
        &self.map
    }

    #[inline(always)]
    fn walls(&self, _: u8) -> &Walls<'_> {
        &self.walls
    }

    #[inline(always)]
    fn change_floors<const N: usize, R: Rng + ?Sized>(
        &self,
        _: &[[f32; N]; 2],
        _: &mut [OneFloor; N],
        _: f32,
        _: &mut R,
    ) {
    }
}
