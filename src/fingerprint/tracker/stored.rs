//! How the particles of a tag lie in memory between two updates.

use super::Config;
use super::floor::{Floor, OneFloor};
use crate::fingerprint::Lattice;
use crate::persist;
use crate::snapshot::Persist;

/// A particle between two updates: [`Packed`], [`OnFloor`] where there are several floors, or [`Exact`] for comparison.
///
/// There are no weights, because every update ends with resampling. Nobody else implements it.
pub trait Stored: Copy + Persist {
    /// The axes of the maps that it has room for.
    #[doc(hidden)]
    const AXES: usize;
    /// In bits that are all zero.
    #[doc(hidden)]
    const EMPTY: Self;

    /// What it knows of its floor.
    #[doc(hidden)]
    type Floor: Floor;

    /// Of a place in steps of the lattice, a velocity in steps a second, and a floor.
    #[doc(hidden)]
    fn pack(places: [f32; 2], velocities: [f32; 2], floor: Self::Floor, grain: &Grain) -> Self;

    /// The floor.
    #[doc(hidden)]
    fn floor(&self) -> Self::Floor;

    /// The place along an axis, in steps of the lattice.
    #[doc(hidden)]
    fn place<const AXIS: usize>(&self, grain: &Grain) -> f32;

    /// The velocity along an axis, in steps a second.
    #[doc(hidden)]
    fn velocity<const AXIS: usize>(&self, grain: &Grain) -> f32;
}

/// What the integers of [`Packed`] count.
#[derive(Debug, Clone, Copy)]
pub struct Grain {
    /// Units of a place in a step of the lattice, a power of two, and its inverse.
    units: [f32; 2],
    /// The largest velocity, in steps a second, and its inverse.
    velocity: [f32; 2],
}

impl Grain {
    /// Most points along an axis: a unit is then an eighth of a step.
    pub const MAX_POINTS: usize = 8_192;
    /// Velocities reach to so many of their prior sigmas. Fewer would hold back who runs; at more, the 128 units of the
    /// plane become coarser than what half a second changes.
    const SIGMAS: f32 = 8.0;

    /// On this map, with these walks. The whole map fits into 16 bits.
    pub(super) fn of(lattice: &Lattice, config: &Config) -> Self {
        let last = lattice.columns().max(lattice.rows()).saturating_sub(1);
        let bits = u16::try_from(last).map_or(0, u16::leading_zeros);
        let units = (1u32 << (bits & 15)) as f32;
        let velocity = Self::SIGMAS * config.velocity_sigma_m_s * lattice.per_metre();
        Self {
            units: [units, 1.0 / units],
            velocity: [velocity, 1.0 / velocity],
        }
    }
}

/// A particle on a map of `D` axes in 2 (D + 1) bytes: 16 bits a place, and 16 for the velocity, or 8 along each of two
/// axes.
///
/// A place is rounded to a power of two of the lattice's step, of which 2^15 to 2^16 reach over the map; the velocity to a
/// 128th of eight times its prior sigma, on a map of one row to a 32,768th.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packed<const D: usize> {
    places: [u16; D],
    velocity: u16,
}

impl<const D: usize> Packed<D> {
    /// The largest velocity, in units.
    const LARGEST: i32 = if D == 1 { 0x7fff } else { 0x7f };

    /// In units, rounded to the nearest one.
    #[inline(always)]
    fn units(velocity: f32, grain: &Grain) -> u16 {
        let [_, inverse] = grain.velocity;
        let units = velocity * (inverse * Self::LARGEST as f32);
        // The conversion rounds towards zero and saturates.
        let above = (units + (Self::LARGEST as f32 + 1.5)) as u32;
        let most = 2 * Self::LARGEST as u32 + 1;
        let above = above.min(most);
        above.wrapping_sub(Self::LARGEST as u32 + 1) as u16
    }
}

impl<const D: usize> Stored for Packed<D> {
    type Floor = OneFloor;

    const AXES: usize = D;
    const EMPTY: Self = {
        assert!(D == 1 || D == 2, "one axis or two");
        Self {
            places: [0; D],
            velocity: 0,
        }
    };

    #[inline(always)]
    fn floor(&self) -> OneFloor {
        OneFloor
    }

    #[inline(always)]
    fn pack(places: [f32; 2], velocities: [f32; 2], _: OneFloor, grain: &Grain) -> Self {
        let mut packed = Self::EMPTY;
        for (packed, place) in packed.places.iter_mut().zip(places) {
            let units = (place * grain.units[0] + 0.5) as u32;
            *packed = if units < 0xffff { units as u16 } else { 0xffff };
        }
        let [x, y] = velocities;
        packed.velocity = if D == 1 {
            Self::units(x, grain)
        } else {
            Self::units(x, grain) & 0xff | Self::units(y, grain) << 8
        };
        packed
    }

    #[inline(always)]
    fn place<const AXIS: usize>(&self, grain: &Grain) -> f32 {
        let units = self.places.get(AXIS).copied().unwrap_or(0);
        f32::from(units) * grain.units[1]
    }

    #[inline(always)]
    fn velocity<const AXIS: usize>(&self, grain: &Grain) -> f32 {
        let units = match (D, AXIS) {
            (1, _) => self.velocity as i16,
            (_, 0) => i16::from(self.velocity as i8),
            _ => self.velocity as i16 >> 8,
        };
        f32::from(units) * (grain.velocity[0] * (1.0 / Self::LARGEST as f32))
    }
}

persist!(impl[const D: usize] Packed<D> as "Packed"(D) { places, velocity });

/// A particle that is not rounded, in 16 bytes: to see what rounding costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    places: [f32; 2],
    velocities: [f32; 2],
}

impl Stored for Exact {
    type Floor = OneFloor;

    const AXES: usize = 2;
    const EMPTY: Self = Self {
        places: [0.0; 2],
        velocities: [0.0; 2],
    };

    #[inline(always)]
    fn floor(&self) -> OneFloor {
        OneFloor
    }

    #[inline(always)]
    fn pack(places: [f32; 2], velocities: [f32; 2], _: OneFloor, _: &Grain) -> Self {
        Self { places, velocities }
    }

    #[inline(always)]
    fn place<const AXIS: usize>(&self, _: &Grain) -> f32 {
        self.places[AXIS & 1]
    }

    #[inline(always)]
    fn velocity<const AXIS: usize>(&self, _: &Grain) -> f32 {
        self.velocities[AXIS & 1]
    }
}

persist!(Exact { places, velocities });

/// A particle on one of several floors: a byte more, and another that keeps it aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OnFloor<S> {
    stored: S,
    floor: u8,
}

impl<S: Stored<Floor = OneFloor>> Stored for OnFloor<S> {
    type Floor = u8;

    const AXES: usize = S::AXES;
    const EMPTY: Self = Self {
        stored: S::EMPTY,
        floor: 0,
    };

    #[inline(always)]
    fn floor(&self) -> u8 {
        self.floor
    }

    #[inline(always)]
    fn pack(places: [f32; 2], velocities: [f32; 2], floor: u8, grain: &Grain) -> Self {
        Self {
            stored: S::pack(places, velocities, OneFloor, grain),
            floor,
        }
    }

    #[inline(always)]
    fn place<const AXIS: usize>(&self, grain: &Grain) -> f32 {
        self.stored.place::<AXIS>(grain)
    }

    #[inline(always)]
    fn velocity<const AXIS: usize>(&self, grain: &Grain) -> f32 {
        self.stored.velocity::<AXIS>(grain)
    }
}

persist!(impl[S: Persist] OnFloor<S> as "OnFloor"() { stored, floor });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_is_too_fast_is_as_fast_as_can_be_packed() {
        let grain = Grain {
            units: [256.0, 1.0 / 256.0],
            velocity: [8.0, 0.125],
        };
        let line = Packed::<1>::pack([0.0; 2], [100.0, 0.0], OneFloor, &grain);
        let plane = Packed::<2>::pack([0.0; 2], [100.0, 9.0], OneFloor, &grain);
        for velocity in [
            line.velocity::<0>(&grain),
            plane.velocity::<0>(&grain),
            plane.velocity::<1>(&grain),
        ] {
            assert!((velocity - 8.0).abs() < 1e-5, "{velocity}");
        }
    }

    #[test]
    fn particles_are_unpacked_as_they_were_packed() {
        let grain = Grain {
            units: [256.0, 1.0 / 256.0],
            velocity: [8.0, 0.125],
        };
        let (places, velocities) = ([3.25, 7.5], [2.0, -4.0]);
        let exact = Exact::pack(places, velocities, OneFloor, &grain);
        let upstairs = OnFloor::<Exact>::pack(places, velocities, 3, &grain);
        assert_eq!(upstairs.floor(), 3);
        for (place, velocity) in [
            (
                [exact.place::<0>(&grain), exact.place::<1>(&grain)],
                [exact.velocity::<0>(&grain), exact.velocity::<1>(&grain)],
            ),
            (
                [upstairs.place::<0>(&grain), upstairs.place::<1>(&grain)],
                [
                    upstairs.velocity::<0>(&grain),
                    upstairs.velocity::<1>(&grain),
                ],
            ),
        ] {
            assert_eq!((place, velocity), (places, velocities));
        }
    }
}
