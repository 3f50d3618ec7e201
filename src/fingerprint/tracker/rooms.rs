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
        let spread = sqrt(self.widening(fix.position, site.config().tempering));
        let [mx, my] = fix.position;
        let places = self.particles.iter().zip(self.particles(site));
        let inside = places.filter(|(particle, [x, y, ..])| {
            particle.floor().number() == zone.floor
                && zone.contains([mx + spread * (x - mx), my + spread * (y - my)])
        });
        Some(inside.count() as f32 / N as f32)
    }
}
