//! A site of several floors.

use super::floor::Floor;
use super::ground::Ground;
use super::{Config, OnFloor, Packed, Site, Stored, Tracker, Walls};
use crate::ConfigError;
use crate::config::{require, require_all, require_within};
use crate::fingerprint::{Encoding, Lattice, RadioMap, Zone};
use crate::math::exp;
use crate::random::{Rng, uniform};

/// A floor above the lowest one.
#[derive(Debug, Clone, Copy)]
pub struct Storey<'a> {
    /// What was surveyed on it: of the same beacons in the same order as on the lowest floor, on the same lattice.
    pub map: RadioMap<'a>,
    /// What particles do not pass.
    pub walls: Walls<'a>,
}

/// Where tags go from floor to floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage<'a> {
    /// Where it is: on every floor that it joins, whichever floor the zone states.
    pub place: Zone<'a>,
    /// The floors, counted from 0, from each of which a tag may get to each other one. Stairs join two that follow each
    /// other: three floors have two passages. A lift joins all.
    pub floors: &'a [u8],
    /// How often a tag in that place changes the floor: once in so many seconds, 0.5 to 3600, on average. Of stairs, a third
    /// of the time that it takes to climb them: on the way it is heard as on either floor, and longer makes the tracker too
    /// sure of one (`cargo xtask papers floors`: 2 to 5 for 12 to 18 s).
    pub seconds: f32,
}

impl Passage<'_> {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_all!(self.place);
        require!(self.floors.len() >= 2, "floors must be two or more");
        require_within!(self: seconds 0.5..=3_600.0);
        Ok(())
    }

    /// Where a tag gets from a floor: another one at random. None if it is not joined.
    fn from<R: Rng + ?Sized>(&self, floor: u8, rng: &mut R) -> Option<u8> {
        let from = self.floors.iter().position(|joined| *joined == floor)?;
        let others = self.floors.len().saturating_sub(1);
        let number = (uniform(rng) * others as f32) as usize;
        let number = number.min(others.saturating_sub(1));
        let number = if number < from { number } else { number + 1 };
        self.floors.get(number).copied()
    }
}

/// A site of several floors, and how tags are tracked on it: lent to every call of a [`BuildingTracker`].
///
/// Every particle is on a floor, which it changes only where there are stairs or a lift. A tag that is on another floor than
/// its particles is found as one that was lost: particles are drawn anew on all floors.
///
/// Work: as on one floor, by the points about the particles of each; and passages by particles.
///
/// ```
/// use foxhunt::fingerprint::tracker::{
///     Building, BuildingTracker, Config, Passage, Site, Storey, Walls, Workspace,
/// };
/// use foxhunt::fingerprint::{RadioMap, Reading, Zone};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// # static TUNNEL: &[u8] =
/// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// # let maps = [TUNNEL, TUNNEL];
/// let [cellar, hall] = maps.map(|bytes| RadioMap::new(bytes).unwrap());
/// let building = Building {
///     lowest: Site::new(cellar, Config::TUNNEL)?,
///     above: &[Storey { map: hall, walls: Walls::None }],
///     passages: &[Passage {
///         place: Zone { id: 0, floor: 0, corners: &[[0.0, -2.0], [6.0, -2.0], [6.0, 2.0], [0.0, 2.0]] },
///         floors: &[0, 1],
///         seconds: 5.0,
///     }],
/// };
/// building.check()?;
/// let mut workspace = Workspace::<300, 162, u8>::EMPTY; // room for the points of both floors
/// let mut tracker = BuildingTracker::<300, 4, 1>::EMPTY;
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let packet = Reading { beacon: 0, rssi_dbm: -50.0 };
/// tracker.push(0, packet, &building, &mut workspace, &mut rng)?;
/// tracker.push(600, packet, &building, &mut workspace, &mut rng)?;
/// // The place is that on the likeliest floor. Here both floors sound the same.
/// assert!(tracker.fix().is_some());
/// assert!((tracker.floor_probability(1) - 0.5).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Building<'a> {
    /// The lowest floor, and how tags are tracked on all.
    pub lowest: Site<'a>,
    /// The floors above it, from the lowest to the highest.
    pub above: &'a [Storey<'a>],
    /// The stairs and lifts.
    pub passages: &'a [Passage<'a>],
}

impl<'a> Building<'a> {
    /// The most floors.
    pub const MAX_FLOORS: usize = 64;

    /// Checks every field, that floors have the same lattice and the same beacons, and that passages join floors that there
    /// are.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_all!(self.lowest);
        let map = &self.lowest.map;
        let floors = self.above.len() + 1;
        require!(
            floors <= Self::MAX_FLOORS && floors * map.lattice().points() <= Lattice::MAX_POINTS,
            "above must be 63 floors at most, of 65536 points with the lowest"
        );
        let mut floor = 0;
        while floor < self.above.len() {
            let above = &self.above[floor].map;
            if let Err(error) = above.check_encoding(Encoding::Moments) {
                return Err(error);
            }
            require!(
                above.lattice().is_same(map.lattice()),
                "above must have the lattice of the lowest floor"
            );
            require!(
                above.has_beacons_of(map),
                "above must have the beacons of the lowest floor, in their order"
            );
            floor += 1;
        }
        let mut passage = 0;
        while passage < self.passages.len() {
            let joined = self.passages[passage].floors;
            require_all!(self.passages[passage]);
            let mut floor = 0;
            while floor < joined.len() {
                require!(
                    (joined[floor] as usize) < floors,
                    "passages must join floors that there are"
                );
                floor += 1;
            }
            passage += 1;
        }
        Ok(())
    }

    fn storey(&self, floor: u8) -> Option<&Storey<'a>> {
        self.above.get(usize::from(floor).checked_sub(1)?)
    }
}

/// Tracks one tag on the floors of a [`Building`]: a byte or two for each particle more than a [`Tracker`] on one floor.
pub type BuildingTracker<const N: usize, const B: usize = 16, const D: usize = 2> =
    Tracker<N, B, D, OnFloor<Packed<D>>>;

impl Ground for Building<'_> {
    type Floor = u8;

    fn config(&self) -> &Config {
        &self.lowest.config
    }

    fn floors(&self) -> u8 {
        (self.above.len() + 1) as u8
    }

    fn map(&self, floor: u8) -> &RadioMap<'_> {
        match self.storey(floor) {
            Some(storey) => &storey.map,
            None => &self.lowest.map,
        }
    }

    fn walls(&self, floor: u8) -> &Walls<'_> {
        match self.storey(floor) {
            Some(storey) => &storey.walls,
            None => &self.lowest.walls,
        }
    }

    fn change_floors<const N: usize, R: Rng + ?Sized>(
        &self,
        [x, y]: &[[f32; N]; 2],
        floors: &mut [u8; N],
        dt: f32,
        rng: &mut R,
    ) {
        let lattice = self.lattice();
        for passage in self.passages {
            let chance = 1.0 - exp(-dt / passage.seconds);
            for (floor, (x, y)) in floors.iter_mut().zip(x.iter().zip(y)) {
                let place = lattice.place_of([*x, *y]);
                if passage.place.contains(place)
                    && uniform(rng) < chance
                    && let Some(other) = passage.from(*floor, rng)
                {
                    *floor = other;
                }
            }
        }
    }
}

impl<const N: usize, const B: usize, const D: usize, S: Stored> Tracker<N, B, D, S> {
    /// The likeliest floor at the last update, counted from 0; none before the first. The fix is the place on it.
    pub fn floor(&self) -> Option<u8> {
        self.fix().map(|_| self.floor.number())
    }

    /// The probability of a floor at the last update: 0 before the first.
    pub fn floor_probability(&self, floor: u8) -> f32 {
        if self.fix().is_none() {
            return 0.0;
        }
        let on_floor = |particle: &&S| particle.floor().number() == floor;
        self.particles.iter().filter(on_floor).count() as f32 / N as f32
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::fingerprint::Reading;
    use crate::fingerprint::tracker::tests::{level, map, map_behind};
    use crate::fingerprint::tracker::{State, Workspace};
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use crate::snapshot;
    use std::vec::Vec;

    /// What the ceiling takes off each beacon, on each floor: two beacons hang on each.
    const LOSS_DB: [[f32; 4]; 2] = [[0.0, 0.0, 15.0, 15.0], [15.0, 15.0, 0.0, 0.0]];
    const STAIRS: Passage = Passage {
        place: Zone {
            id: 0,
            floor: 0,
            corners: &[[17.0, -1.0], [23.0, -1.0], [23.0, 1.0], [17.0, 1.0]],
        },
        floors: &[0, 1],
        seconds: 10.0,
    };

    type Tag = BuildingTracker<200, 4, 1>;

    /// Two floors of one row, and stairs between them.
    fn in_building<T>(maps: &[Vec<u8>; 2], go: impl FnOnce(&Building<'_>) -> T) -> T {
        let [below, above] = maps.each_ref().map(|map| RadioMap::new(map).unwrap());
        let above = [Storey {
            map: above,
            walls: Walls::None,
        }];
        let building = Building {
            lowest: Site::new(below, Config::DEFAULT).unwrap(),
            above: &above,
            passages: &[STAIRS],
        };
        building.check().unwrap();
        go(&building)
    }

    /// A tag that is heard on two floors of one row.
    struct Walk {
        maps: [Vec<u8>; 2],
        tag: Tag,
        workspace: Workspace<200, 82, u8>,
        rng: Xoshiro128PlusPlus,
        time_ms: u32,
    }

    impl Walk {
        fn new(seed: u64) -> Self {
            Self {
                maps: LOSS_DB.map(|loss_db| map_behind(loss_db, 1)),
                tag: Tag::EMPTY,
                workspace: Workspace::EMPTY,
                rng: Xoshiro128PlusPlus::seed_from_u64(seed),
                time_ms: 0,
            }
        }

        /// For so many seconds, two packets of each beacon a second.
        fn go(&mut self, floor: usize, seconds: u32, path: impl Fn(f32) -> f32) -> Vec<State> {
            let mut states = Vec::new();
            in_building(&self.maps, |building| {
                for half in 0..2 * seconds {
                    for beacon in 0..4 {
                        let loss_db = LOSS_DB[floor][usize::from(beacon)];
                        let rssi_dbm = level(beacon, path(0.5 * half as f32)) - loss_db;
                        let packet = Reading { beacon, rssi_dbm };
                        let (room, rng) = (&mut self.workspace, &mut self.rng);
                        let fix = self.tag.push(self.time_ms, packet, building, room, rng);
                        states.extend(fix.unwrap().map(|fix| fix.state));
                    }
                    self.time_ms += 500;
                }
            });
            states
        }
    }

    /// Half a second on stairs that are taken once in so many. The number that take them is binomial: of 4,000, five standard
    /// deviations are 0.017, which a correct program exceeds once in a million seeds.
    #[test]
    fn stairs_are_taken_as_often_as_they_say() {
        const N: usize = 4_000;
        let maps = LOSS_DB.map(|loss_db| map_behind(loss_db, 1));
        let [first, _, third, _] = STAIRS.place.corners else {
            panic!("the stairs have four corners")
        };
        let middle = [0, 1].map(|axis| 0.5 * (first[axis] + third[axis]));
        let places = middle.map(|middle| [middle; N]);
        let (mut floors, mut rng) = ([0; N], Xoshiro128PlusPlus::seed_from_u64(4));
        in_building(&maps, |building| {
            building.change_floors(&places, &mut floors, 0.5, &mut rng);
        });
        let taken = floors.iter().filter(|floor| **floor == 1).count() as f32 / N as f32;
        let expected = 1.0 - (-0.5 / STAIRS.seconds).exp();
        assert!((taken - expected).abs() < 0.017, "{taken} {expected}");
    }

    #[test]
    fn who_climbs_the_stairs_is_followed() {
        for seed in 0..10 {
            let mut walk = Walk::new(seed);
            walk.go(0, 15, |t| 5.0 + t);
            assert_eq!(walk.tag.floor(), Some(0));
            assert!(walk.tag.floor_probability(0) > 0.9, "{seed}");
            walk.go(0, 5, |_| 20.0);
            walk.go(1, 5, |_| 20.0);
            let states = walk.go(1, 15, |t| 20.0 + t);
            assert_eq!(walk.tag.floor(), Some(1));
            assert!(walk.tag.floor_probability(1) > 0.9, "{seed}");
            let [x, _] = walk.tag.fix().unwrap().position_at(walk.time_ms);
            assert!((x - 35.0).abs() < 2.5, "{seed} {x}");
            assert!(!states.contains(&State::Lost), "{seed}");
        }
    }

    #[test]
    fn nobody_changes_the_floor_elsewhere_and_who_was_carried_there_is_found_again() {
        let mut lost = 0;
        for seed in 0..10 {
            let mut walk = Walk::new(seed);
            walk.go(0, 20, |_| 5.0);
            let states = walk.go(1, 40, |_| 5.0);
            lost += usize::from(states.contains(&State::Lost));
            assert_eq!(walk.tag.floor(), Some(1), "{seed}");
        }
        assert!(lost >= 8, "{lost}");
    }

    #[test]
    fn a_snapshot_holds_the_floors() {
        let mut walk = Walk::new(3);
        walk.go(1, 10, |t| 18.0 + 0.2 * t);
        let mut buffer = std::vec![0; snapshot::largest::<Tag>()];
        let saved = snapshot::save(&walk.tag, &mut buffer).unwrap();
        let mut other = Walk::new(3);
        snapshot::restore(&mut other.tag, saved).unwrap();
        (other.rng, other.time_ms) = (walk.rng.clone(), walk.time_ms);
        let ends = [&mut walk, &mut other].map(|walk| {
            walk.go(1, 5, |_| 20.0);
            (walk.tag.fix(), walk.tag.floor_probability(1))
        });
        assert_eq!(ends[0], ends[1]);
    }

    #[test]
    fn a_wrong_field_is_named() {
        let (low, other) = (map(1), map(2));
        let [low, other] = [&low, &other].map(|bytes| RadioMap::new(bytes).unwrap());
        let storey = |map| Storey {
            map,
            walls: Walls::None,
        };
        let lowest = Site::new(low, Config::DEFAULT).unwrap();
        let field = |above: &[Storey<'_>], passage: Passage<'_>| {
            let building = Building {
                lowest,
                above,
                passages: &[passage],
            };
            building.check().map_err(|error| error.field())
        };
        let right = [storey(low)];
        assert_eq!(field(&right, STAIRS), Ok(()));
        assert_eq!(field(&[storey(other)], STAIRS), Err("above"));
        assert_eq!(field(&[storey(low); 64], STAIRS), Err("above"));
        assert_eq!(field(&[], STAIRS), Err("passages"));
        for floors in [&[0u8][..], &[0, 2]] {
            let passage = Passage { floors, ..STAIRS };
            assert!(field(&right, passage).is_err());
        }
        let passage = Passage {
            seconds: 0.0,
            ..STAIRS
        };
        assert_eq!(field(&right, passage), Err("seconds"));
        // Other beacons.
        let mut bytes = map(1);
        bytes[44] = 9;
        let end = bytes.len() - 4;
        let sum = crate::checksum::crc32(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        let map = RadioMap::new(&bytes).unwrap();
        assert_eq!(field(&[storey(map)], STAIRS), Err("above"));
    }
}
