//! The tracker: packets in, the place of a tag out.
//!
//! A particle filter that weighs places by the map itself, not by a place that a match has found: a scan that fits two
//! places makes two clouds, and the walk decides between them (Cui et al. 2017 match first).
//!
//! * Packets of half a second, say, make one update. It compares their mean levels with every point of the map, and
//!   weighs the particles by interpolation between the points.
//! * Particles start from the first match, spread over all places that fit.
//! * A particle carries its place as a sample, and its velocity as the mean of a normal distribution whose variance is
//!   the same for all (Rao-Blackwellised: the motion is linear, so this is exact, and 300 particles do the work of
//!   thousands that sample the velocity as well).
//! * A tag may read otherwise than the one of the survey: its offset is estimated along with the places, and costs
//!   nothing when there is none.
//! * A reading that fits nowhere counts no more than one that is a few sigmas off, and likelihoods are tempered, because
//!   the errors of readings that follow each other are correlated.
//! * When the evidence has gone against the particles for a while, a fraction of them is drawn anew from the match.
//!
//! One [`Site`] and one [`Workspace`] serve any number of trackers: see [`Trackers`] for many tags.

mod building;
mod cloud;
mod comparison;
mod config;
mod field;
mod fix;
mod floor;
mod ground;
mod memory;
mod motion;
mod offset;
mod pending;
mod present;
mod rooms;
mod site;
mod stored;
mod tags;
mod update;
mod walls;
mod weigh;

use crate::persist;
use crate::random::Rng;
use cloud::Cloud;
use field::Field;
use memory::Memory;
use offset::OffsetBelief;
use pending::Pending;
use stored::Grain;

use super::{Reading, ReadingError};
pub use building::{Building, BuildingTracker, Passage, Storey};
pub use config::Config;
pub use fix::{Fix, State};
pub use floor::{Floor, OneFloor};
pub use ground::Ground;
pub use rooms::{Occupancy, Passing, Rooms};
pub use site::Site;
pub use stored::{Exact, OnFloor, Packed, Stored};
pub use tags::Trackers;
pub use walls::{Piece, Walls};
pub use weigh::WeighError;

/// The scratch memory of an update of `N` particles on a map of up to `P` points: 24 P + 22 N + 20 bytes, which hold nothing
/// of use between updates. One serves all trackers.
///
/// In a [`Building`], `P` counts the points of all floors, and `F` is `u8`: a byte more for each particle.
#[derive(Debug, Clone)]
pub struct Workspace<const N: usize, const P: usize, F = OneFloor> {
    field: Field<P>,
    cloud: Cloud<N, F>,
}

impl<const N: usize, const P: usize, F: Floor> Workspace<N, P, F> {
    /// Zero in all bits, for a `static`.
    pub const EMPTY: Self = Self {
        field: Field::EMPTY,
        cloud: Cloud::EMPTY,
    };
}

/// Tracks one tag with `N` particles, by up to `B` beacons, on a map of up to `D` axes.
///
/// Takes 2 (D + 1) N + 9 B + 130 bytes or so, none of which move: 2.1 kB for 300 particles in the plane, 1.5 kB where the map has
/// one row or one column and `D` is 1. Between two updates particles are rounded, see [`Packed`].
///
/// ```
/// use foxhunt::fingerprint::tracker::{Config, Site, Tracker, Workspace};
/// use foxhunt::fingerprint::{RadioMap, Reading};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// // A tunnel of 80 m with four beacons.
/// static TUNNEL: &[u8] =
///     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// let map = RadioMap::new(TUNNEL)?;
/// let site = Site::new(map, Config::TUNNEL)?;
/// let mut workspace = Workspace::<300, 81>::EMPTY;
/// let mut tracker = Tracker::<300, 4, 1>::EMPTY;
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// // Somebody walks for 30 s and is heard twice a second by each beacon, as the survey says.
/// for time_ms in (0..30_000).step_by(500) {
///     let point = 5 + time_ms as usize / 1000;
///     for beacon in 0..4 {
///         let rssi_dbm = map.moments(beacon.into(), point).unwrap().mean_dbm;
///         let packet = Reading { beacon, rssi_dbm };
///         tracker.push(time_ms, packet, &site, &mut workspace, &mut rng)?;
///     }
/// }
/// let fix = tracker.fix().unwrap();
/// assert!((fix.position_at(30_000)[0] - 35.0).abs() < 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tracker<const N: usize, const B: usize = 16, const D: usize = 2, S: Stored = Packed<D>> {
    /// Places, and the means of velocities.
    particles: [S; N],
    /// Of every particle's velocity, along x and along y.
    velocity_variance: [f32; 2],
    offset: OffsetBelief,
    memory: Memory<B>,
    /// The mean place of the last seconds, in metres.
    rest: [f32; 2],
    /// How much larger the covariance of the fix is than that of the particles.
    widening: f32,
    pending: Pending<B>,
    /// That of the fix.
    floor: S::Floor,
    /// Of the last update, if there was one.
    fix: Fix,
    has_fix: bool,
    /// Logarithm of how much better the scans fit the particles than the whole map, smoothed.
    evidence: f32,
    /// Seconds since particles were drawn anew; none if they never were.
    redrawn_s: Option<f32>,
    /// Packets in a row that were older than the last update.
    old_packets: u8,
}

impl<const N: usize, const B: usize, const D: usize, S: Stored> Tracker<N, B, D, S> {
    /// Packets in a row, older than the last update, after which they are taken for right and the update for wrong. Fewer
    /// would let a late packet end a walk; more would ignore a clock that was set back for longer.
    const OLD_PACKETS: u8 = 5;
    /// A gap of so many milliseconds ends a walk: the next packet begins another. In a longer gap a person may get
    /// anywhere.
    const GAP_MS: i32 = 60_000;

    /// Without a fix, in bits that are all zero.
    pub const EMPTY: Self = Self {
        particles: [S::EMPTY; N],
        velocity_variance: [0.0; 2],
        offset: OffsetBelief::EMPTY,
        memory: Memory::EMPTY,
        rest: [0.0; 2],
        widening: 0.0,
        pending: Pending::EMPTY,
        floor: S::Floor::LOWEST,
        fix: Fix::EMPTY,
        has_fix: false,
        evidence: 0.0,
        redrawn_s: None,
        old_packets: 0,
    };

    /// Forgets all.
    pub fn reset(&mut self) {
        self.offset = OffsetBelief::EMPTY;
        self.memory = Memory::EMPTY;
        self.pending.clear();
        self.has_fix = false;
        self.evidence = 0.0;
        self.redrawn_s = None;
        self.old_packets = 0;
    }

    /// Where the tag was at the last update; none before the first.
    pub const fn fix(&self) -> Option<Fix> {
        if self.has_fix { Some(self.fix) } else { None }
    }

    /// Places in metres and velocities in metres a second: x, y, vx, vy; none before the first fix.
    pub fn particles<G: Ground>(
        &self,
        site: &G,
    ) -> impl Iterator<Item = [f32; 4]> + use<'_, G, N, B, D, S> {
        let lattice = *site.lattice();
        let grain = Grain::of(&lattice, site.config());
        let count = if self.has_fix { N } else { 0 };
        self.particles.iter().take(count).map(move |particle| {
            let place = [particle.place::<0>(&grain), particle.place::<1>(&grain)];
            let [x, y] = lattice.place_of(place);
            let second = if lattice.is_plane() {
                particle.velocity::<1>(&grain)
            } else {
                0.0
            };
            let [vx, vy] = lattice.along_axes([particle.velocity::<0>(&grain), second]);
            [x, y, lattice.spacing() * vx, lattice.spacing() * vy]
        })
    }

    /// Takes a packet with its time in milliseconds. The clock may overflow, because only differences count.
    ///
    /// Returns the fix if the packet led to an update. That is by the packets before it, because this packet is the first of
    /// another window (see [`Config::window_ms`]) and waits for the next; with a window of 0 each packet leads to an update.
    ///
    /// # Errors
    /// [`ReadingError::Beacon`], [`ReadingError::Strength`], [`ReadingError::Points`], [`ReadingError::Axes`] or
    /// [`ReadingError::TooOld`].
    pub fn push<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        packet: Reading,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Result<Option<Fix>, ReadingError> {
        self.push_doubting(time_ms, packet, &[], site, workspace, rng)
    }

    /// The same, of beacons whose readings have these variances in dB^2, by number, beyond what the map says.
    pub(crate) fn push_doubting<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        packet: Reading,
        doubts_db2: &[f32],
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Result<Option<Fix>, ReadingError> {
        if usize::from(packet.beacon) >= site.map(0).beacons().min(B) {
            return Err(ReadingError::Beacon);
        }
        if !site.config().accepts(packet.rssi_dbm) {
            return Err(ReadingError::Strength);
        }
        if site.points() > P {
            return Err(ReadingError::Points);
        }
        if site.lattice().axes() > S::AXES {
            return Err(ReadingError::Axes);
        }
        self.check_time(time_ms)?;
        let window_ms = site.config().window_ms;
        let mut fix = None;
        if window_ms > 0 && self.pending.is_due(time_ms, window_ms) {
            fix = self.flush_doubting(doubts_db2, site, workspace, rng);
        }
        self.pending.add(time_ms, packet);
        if window_ms == 0 {
            fix = self.flush_doubting(doubts_db2, site, workspace, rng);
        }
        Ok(fix)
    }

    /// Updates by the packets that wait, if there are any: at the end of a walk or of a whole scan, or for a query.
    pub fn flush<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Option<Fix> {
        self.flush_doubting(&[], site, workspace, rng)
    }

    /// The same, of beacons that are doubted.
    pub(crate) fn flush_doubting<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        doubts_db2: &[f32],
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Option<Fix> {
        let room = site.points() <= P && site.lattice().axes() <= S::AXES;
        if self.pending.is_empty() || !room {
            return None;
        }
        let pending = self.pending.take();
        let scan = pending.levels(doubts_db2);
        self.update(pending.time_ms(), &scan, site, workspace, rng);
        self.fix()
    }

    /// Refuses a time before the last update, unless a few in a row are; forgets the tag after a gap.
    fn check_time(&mut self, time_ms: u32) -> Result<(), ReadingError> {
        let Some(fix) = self.fix() else {
            return Ok(());
        };
        let since = time_ms.wrapping_sub(fix.time_ms) as i32;
        if since < 0 {
            self.old_packets = self.old_packets.saturating_add(1);
            if self.old_packets < Self::OLD_PACKETS {
                return Err(ReadingError::TooOld);
            }
        }
        self.old_packets = 0;
        if !(0..Self::GAP_MS).contains(&since) {
            self.reset();
        }
        Ok(())
    }
}

persist!(
    impl[const N: usize, const B: usize, const D: usize, S: Stored] Tracker<N, B, D, S> as "Tracker"(N, B)
    { particles, velocity_variance, offset, memory, rest, widening, pending, floor, fix, has_fix, evidence, redrawn_s, old_packets }
);

#[cfg(test)]
pub(crate) mod tests;
