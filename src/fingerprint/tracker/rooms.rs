//! In which rooms a tag is, and when it enters and leaves them.

use super::{Floor, Ground, Stored, Tracker};
use crate::ConfigError;
use crate::config::{require, require_all, require_within};
use crate::fingerprint::Zone;
use crate::math::sqrt;
use crate::persist;

/// Rooms that are watched, and how sure it must be that a tag is in one or not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rooms<'a> {
    /// The rooms, each with a name of its own. They may overlap.
    pub zones: &'a [Zone<'a>],
    /// A tag has entered a room when it is there with this probability, and has left it when it is elsewhere with this
    /// probability: 0.51 to 0.999. Fixes between the two change nothing.
    pub probability: f32,
}

impl Rooms<'_> {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self: probability 0.51..=0.999);
        let mut zone = 0;
        while zone < self.zones.len() {
            require_all!(self.zones[zone]);
            let mut other = 0;
            while other < zone {
                require!(
                    self.zones[other].id != self.zones[zone].id,
                    "zones must have different ids"
                );
                other += 1;
            }
            zone += 1;
        }
        Ok(())
    }
}

/// What a tag has done.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Passing {
    /// It has entered a room.
    Entered {
        /// The name of the room.
        zone: u16,
        /// The probability that it is there.
        probability: f32,
    },
    /// It has left a room.
    Left {
        /// The name of the room.
        zone: u16,
        /// The probability that it is elsewhere.
        probability: f32,
    },
}

/// In which of up to `Z` rooms a tag is: `Z` bytes.
///
/// ```
/// use foxhunt::fingerprint::tracker::{Config, Occupancy, Passing, Rooms, Site, Tracker, Workspace};
/// use foxhunt::fingerprint::{RadioMap, Reading, Zone};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// const ROOMS: Rooms<'static> = foxhunt::config!(Rooms {
///     zones: &[
///         Zone { id: 1, floor: 0, corners: &[[0.0, -2.0], [20.0, -2.0], [20.0, 2.0], [0.0, 2.0]] },
///         Zone { id: 2, floor: 0, corners: &[[20.0, -2.0], [80.0, -2.0], [80.0, 2.0], [20.0, 2.0]] },
///     ],
///     probability: 0.9,
/// });
/// # static TUNNEL: &[u8] =
/// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// # let map = RadioMap::new(TUNNEL)?;
/// # let site = Site::new(map, Config::TUNNEL)?;
/// # let mut workspace = Workspace::<300, 81>::EMPTY;
/// # let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut tracker = Tracker::<300, 4, 1>::EMPTY;
/// let mut occupancy = Occupancy::<2>::EMPTY;
/// let mut passed = Vec::new();
/// // Somebody walks from 5 to 35 m in half a minute.
/// for time_ms in (0..30_000).step_by(500) {
///     for beacon in 0..4 {
///         let rssi_dbm = map.moments(beacon.into(), 5 + time_ms as usize / 1000).unwrap().mean_dbm;
///         let packet = Reading { beacon, rssi_dbm };
///         if tracker.push(time_ms, packet, &site, &mut workspace, &mut rng)?.is_some() {
///             occupancy.update(&tracker, &site, &ROOMS, |passing| passed.push(passing));
///         }
///     }
/// }
/// assert!(matches!(passed[0], Passing::Entered { zone: 1, .. }));
/// assert!(passed.iter().any(|passing| matches!(passing, Passing::Left { zone: 1, .. })));
/// assert!(matches!(passed.last(), Some(Passing::Entered { zone: 2, .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Occupancy<const Z: usize> {
    is_inside: [bool; Z],
}

impl<const Z: usize> Occupancy<Z> {
    /// In no room, in bits that are all zero.
    pub const EMPTY: Self = Self {
        is_inside: [false; Z],
    };

    /// Calls `tell` for every room that the tag has left or entered since the last call. Rooms beyond `Z` are not watched;
    /// without a fix nothing changes.
    ///
    /// Work: particles by corners of the rooms.
    pub fn update<const N: usize, const B: usize, const D: usize, S: Stored, G: Ground>(
        &mut self,
        tracker: &Tracker<N, B, D, S>,
        site: &G,
        rooms: &Rooms<'_>,
        mut tell: impl FnMut(Passing),
    ) {
        for (is_inside, zone) in self.is_inside.iter_mut().zip(rooms.zones) {
            let Some(inside) = tracker.probability_in(zone, site) else {
                return;
            };
            let id = zone.id;
            let outside = 1.0 - inside;
            if *is_inside && outside >= rooms.probability {
                *is_inside = false;
                tell(Passing::Left {
                    zone: id,
                    probability: outside,
                });
            } else if !*is_inside && inside >= rooms.probability {
                *is_inside = true;
                tell(Passing::Entered {
                    zone: id,
                    probability: inside,
                });
            }
        }
    }

    /// The names of the rooms that it is in.
    pub fn zones(&self, rooms: &Rooms<'_>) -> impl Iterator<Item = u16> {
        let zones = self.is_inside.iter().zip(rooms.zones);
        zones.filter_map(|(is_inside, zone)| is_inside.then_some(zone.id))
    }
}

persist!(impl[const Z: usize] Occupancy<Z> as "Occupancy"(Z) { is_inside });

impl<const N: usize, const B: usize, const D: usize, S: Stored> Tracker<N, B, D, S> {
    /// The probability that the tag was in a zone at the last update; none before the first.
    ///
    /// The fraction of the particles that are in it, spread about their mean as the covariance of the fix says.
    pub fn probability_in<G: Ground>(&self, zone: &Zone<'_>, site: &G) -> Option<f32> {
        let fix = self.fix()?;
        let spread = sqrt(self.widening);
        let [mx, my] = fix.position;
        let places = self.particles.iter().zip(self.particles(site));
        let inside = places.filter(|(particle, [x, y, ..])| {
            particle.floor().number() == zone.floor
                && zone.contains([mx + spread * (x - mx), my + spread * (y - my)])
        });
        Some(inside.count() as f32 / N as f32)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::fingerprint::tracker::tests::map_at_rest;
    use crate::fingerprint::tracker::{Config, Site, Workspace};
    use crate::fingerprint::{RadioMap, Reading};
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use std::vec::Vec;

    /// A room of so many metres of the tunnel.
    fn room(id: u16, corners: &[[f32; 2]; 4]) -> Zone<'_> {
        Zone {
            id,
            floor: 0,
            corners,
        }
    }

    fn corners(from: f32, to: f32) -> [[f32; 2]; 4] {
        [[from, -1.0], [to, -1.0], [to, 1.0], [from, 1.0]]
    }

    #[test]
    fn a_wrong_field_is_named() {
        let (first, second) = (corners(0.0, 10.0), corners(10.0, 40.0));
        let zones = [room(1, &first), room(1, &second)];
        let rooms = Rooms {
            zones: &zones,
            probability: 0.9,
        };
        assert_eq!(rooms.check().unwrap_err().field(), "zones");
        let zones = [room(1, &first), room(2, &second)];
        for probability in [0.5, 1.0, f32::NAN] {
            let rooms = Rooms {
                zones: &zones,
                probability,
            };
            assert_eq!(rooms.check().unwrap_err().field(), "probability");
        }
        let rooms = Rooms {
            zones: &zones,
            ..rooms
        };
        assert_eq!(rooms.check(), Ok(()));
    }

    #[test]
    fn rooms_that_meet_share_the_probability_and_events_alternate() {
        let bytes = map_at_rest(300);
        // So uncertain at rest that its region is wider than its particles are.
        let site = Site::new(RadioMap::new(&bytes).unwrap(), Config::TUNNEL).unwrap();
        let (first, second) = (corners(-100.0, 20.0), corners(20.0, 140.0));
        let zones = [room(1, &first), room(2, &second)];
        let rooms = Rooms {
            zones: &zones,
            probability: 0.8,
        };
        let mut tag = Tracker::<200, 4, 1>::EMPTY;
        let mut workspace = Workspace::<200, 64, _>::EMPTY;
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
        let mut occupancy = Occupancy::<2>::EMPTY;
        let mut events = Vec::new();
        assert_eq!(tag.probability_in(&zones[0], &site), None);
        // To and fro.
        for half in 0..480u32 {
            let x = 20.0 + 15.0 * crate::math::sin_cos(0.05 * half as f32).0;
            for beacon in 0..4 {
                let rssi_dbm = crate::fingerprint::tracker::tests::level(beacon, x);
                let packet = Reading { beacon, rssi_dbm };
                tag.push(500 * half, packet, &site, &mut workspace, &mut rng)
                    .unwrap();
            }
            let [a, b] = zones.map(|zone| tag.probability_in(&zone, &site).unwrap_or(0.5));
            assert!((a + b - 1.0).abs() < 1e-6, "{a} {b}");
            occupancy.update(&tag, &site, &rooms, |passing| events.push(passing));
        }
        assert!(events.len() > 10, "{events:?}");
        let mut is_inside = [false; 2];
        for event in events {
            let (zone, enters, probability) = match event {
                Passing::Entered { zone, probability } => (zone, true, probability),
                Passing::Left { zone, probability } => (zone, false, probability),
            };
            let was_inside = &mut is_inside[usize::from(zone) - 1];
            assert!(*was_inside != enters && probability >= 0.8);
            *was_inside = enters;
        }
        let inside: Vec<u16> = occupancy.zones(&rooms).collect();
        assert_eq!(is_inside, [1, 2].map(|id| inside.contains(&id)));
    }
}
