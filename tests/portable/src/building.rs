//! A building of three floors, and a tunnel: everything that the tracker says of tags there.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use foxhunt::{
    fingerprint::{
        RadioMap, Reading, Zone,
        tracker::{
            Building, Config, Exact, Fix, Ground, Occupancy, OnFloor, Packed, Passage, Passing,
            Piece, Rooms, Site, Stored, Storey, Tracker, Walls, WeighError, Workspace,
        },
    },
    random::{SeedableRng, Xoshiro128PlusPlus, uniform},
    snapshot::{restore, save},
};

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    (
        "building::who_takes_the_stairs_and_the_lift_is_followed",
        who_takes_the_stairs_and_the_lift_is_followed,
    ),
    (
        "building::particles_that_are_not_rounded_follow_too",
        particles_that_are_not_rounded_follow_too,
    ),
    (
        "building::rooms_of_a_tunnel_are_entered_in_their_order",
        rooms_of_a_tunnel_are_entered_in_their_order,
    ),
];

/// 31 points by 7, 2.5 m apart, and four beacons.
static HALL: &[u8; 1836] = include_bytes!("../data/hall.moments");
static TUNNEL: &[u8] = include_bytes!("../data/tunnel.moments");
static MIDDLE: [u8; 1836] = storey([30, 30, 0, 0], None);
/// Nobody was ever in its pillar.
static TOP: [u8; 1836] = storey([30, 0, 0, 30], Some(4 * 31 + 26));

/// The hall behind ceilings that take so many halves of a dB off each beacon, without one point.
const fn storey(losses: [u8; 4], pillar: Option<usize>) -> [u8; 1836] {
    const SURVEYED: usize = 44 + 4 * 6;
    const POINTS: usize = 31 * 7;
    let mut bytes = *HALL;
    if let Some(point) = pillar {
        bytes[SURVEYED + point / 8] &= !(1 << (point % 8));
    }
    let mut entry = 0;
    while entry < 4 * POINTS {
        let mean = SURVEYED + POINTS.div_ceil(8) + 2 * entry + 1;
        bytes[mean] = bytes[mean].saturating_sub(losses[entry / POINTS]);
        entry += 1;
    }
    let (content, sum) = bytes.split_last_chunk_mut().expect("it has a checksum");
    *sum = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC)
        .checksum(content)
        .to_le_bytes();
    bytes
}

const fn zone<'a>(id: u16, floor: u8, corners: &'a [[f32; 2]]) -> Zone<'a> {
    Zone { id, floor, corners }
}

const STAIRS: Passage<'static> = Passage {
    place: zone(0, 0, &[[3.0, 2.0], [12.0, 3.0], [11.0, 8.0], [2.0, 7.0]]),
    floors: &[0, 1],
    seconds: 2.0,
};
const LIFT: Passage<'static> = Passage {
    place: zone(
        0,
        0,
        &[[56.0, 9.0], [64.0, 10.0], [64.0, 15.0], [55.0, 15.0]],
    ),
    floors: &[0, 1, 2],
    seconds: 3.0,
};
const CORRIDOR: &[Piece] = &[
    Piece {
        from: [4.0, 4.5],
        to: [58.0, 3.5],
        width: 6.0,
    },
    Piece {
        from: [58.0, 3.5],
        to: [60.5, 13.0],
        width: 5.0,
    },
];
const ZONES: [Zone<'static>; 3] = [
    zone(
        1,
        0,
        &[
            [1.0, 1.0],
            [20.0, 2.0],
            [16.0, 8.0],
            [21.0, 14.0],
            [1.0, 13.0],
        ],
    ),
    zone(2, 1, &[[20.0, 0.5], [50.0, 0.5], [50.0, 9.0], [20.0, 8.0]]),
    zone(
        3,
        2,
        &[[52.0, 7.0], [74.5, 4.0], [75.5, 16.0], [52.5, 15.5]],
    ),
];
const ROOMS: Rooms<'static> = foxhunt::config!(Rooms {
    zones: &ZONES,
    probability: 0.7,
});

fn open(bytes: &'static [u8]) -> RadioMap<'static> {
    RadioMap::new(bytes).expect("the map is whole")
}

/// A tag, what it was heard by, and what was said of it.
struct Walk<const N: usize, const P: usize, const D: usize, S: Stored> {
    tag: Tracker<N, 4, D, S>,
    workspace: Workspace<N, P, S::Floor>,
    occupancy: Occupancy<3>,
    rng: Xoshiro128PlusPlus,
    time_ms: u32,
    /// By how many dB it is louder than the tag of the survey.
    louder_db: f32,
    /// Rooms that were entered, and negative ones that were left.
    passed: heapless::Vec<i32, 16>,
    digest: Digest,
}

impl<const N: usize, const P: usize, const D: usize, S: Stored> Walk<N, P, D, S> {
    fn new(louder_db: f32) -> Self {
        Self {
            louder_db,
            tag: Tracker::EMPTY,
            workspace: Workspace::EMPTY,
            occupancy: Occupancy::EMPTY,
            rng: Xoshiro128PlusPlus::seed_from_u64(5),
            time_ms: u32::MAX - 9_000,
            passed: heapless::Vec::new(),
            digest: Digest::new(),
        }
    }

    /// Says everything of the last update.
    fn say<G: Ground>(&mut self, fix: &Fix, site: &G, rooms: &Rooms<'_>) {
        let Self { tag, digest, .. } = self;
        digest.add(&fix.position);
        digest.add(&fix.velocity);
        digest.add(fix.covariance.rows().as_flattened());
        digest.add(&[fix.offset_db, fix.effective_sample_size, fix.sigma_m()]);
        digest.add(&fix.position_at(fix.time_ms.wrapping_add(700)));
        let ahead = fix.position.map(|metres| metres + fix.sigma_m());
        let is_ahead = u8::from(fix.contains(ahead, 0.6));
        digest.add_bytes(&[
            fix.state as u8,
            is_ahead,
            tag.floor().expect("it has a fix"),
        ]);
        digest.add_bytes(&fix.time_ms.to_le_bytes());
        let floors = [0, 1, 2].map(|floor| tag.floor_probability(floor));
        assert!((floors.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        digest.add(&floors);
        for zone in rooms.zones {
            digest.add(&[tag.probability_in(zone, site).expect("it has a fix")]);
        }
        let (digest, passed) = (&mut self.digest, &mut self.passed);
        self.occupancy.update(tag, site, rooms, |passing| {
            let (number, probability) = match passing {
                Passing::Entered { zone, probability } => (i32::from(zone), probability),
                Passing::Left { zone, probability } => (-i32::from(zone), probability),
            };
            passed.push(number).expect("it goes through few rooms");
            digest.add(&[probability]);
        });
        for id in self.occupancy.zones(rooms) {
            self.digest.add_bytes(&id.to_le_bytes());
        }
    }

    /// For so many seconds it goes straight from one place on a floor to another, and is heard eight times a second.
    fn go<G: Ground<Floor = S::Floor>>(
        &mut self,
        (map, seconds): (RadioMap<'_>, u32),
        [from, to]: [[f32; 2]; 2],
        site: &G,
        rooms: &Rooms<'_>,
    ) {
        for packet in 0..8 * seconds {
            let fraction = packet as f32 / (8 * seconds) as f32;
            let place = [0, 1].map(|axis| from[axis] + fraction * (to[axis] - from[axis]));
            let beacon = (packet % 4) as u8;
            let there = map.moments(beacon.into(), map.lattice().nearest(place));
            let noise = 4.0 * uniform(&mut self.rng) - 2.0;
            let packet = Reading {
                beacon,
                rssi_dbm: there.expect("surveyed").mean_dbm + self.louder_db + noise,
            };
            let (room, rng) = (&mut self.workspace, &mut self.rng);
            let fix = (self.tag).push(self.time_ms, packet, site, room, rng);
            if let Some(fix) = fix.expect("it can be used") {
                self.say(&fix, site, rooms);
            }
            self.time_ms = self.time_ms.wrapping_add(125);
        }
    }

    /// Uses what waits, of which there is nothing afterwards.
    fn flush<G: Ground<Floor = S::Floor>>(&mut self, site: &G, rooms: &Rooms<'_>) {
        let (room, rng) = (&mut self.workspace, &mut self.rng);
        let fix = self.tag.flush(site, room, rng).expect("packets wait");
        assert_eq!(self.tag.flush(site, room, rng), None);
        self.say(&fix, site, rooms);
    }

    /// Lets milliseconds pass and takes evidence of another kind.
    fn weigh<G: Ground<Floor = S::Floor>>(
        &mut self,
        after_ms: u32,
        ln_likelihood: impl Fn([f32; 2], u8) -> f32,
        site: &G,
        rooms: &Rooms<'_>,
    ) -> Result<Fix, WeighError> {
        self.time_ms = self.time_ms.wrapping_add(after_ms);
        let (room, rng) = (&mut self.workspace, &mut self.rng);
        let fix = (self.tag).weigh(self.time_ms, ln_likelihood, site, room, rng)?;
        self.say(&fix, site, rooms);
        Ok(fix)
    }

    /// Ends with the particles, and goes on with what a snapshot brings back.
    fn store<G: Ground<Floor = S::Floor>>(&mut self, site: &G) {
        let mut buffer = [0; 8192];
        let bytes = save(&self.tag, &mut buffer).expect("it is large enough");
        self.digest.add_bytes(bytes);
        self.tag = Tracker::EMPTY;
        restore(&mut self.tag, bytes).expect("it is one of these");
        for particle in self.tag.particles(site) {
            self.digest.add(&particle);
        }
    }
}

/// Down the hall, up the stairs, along a corridor, up with the lift, to a corner.
fn through_the_building<S: Stored<Floor = u8>>(config: Config, louder_db: f32) -> Digest {
    let [below, middle, top] = [HALL.as_slice(), &MIDDLE, &TOP].map(open);
    let above = [
        Storey {
            map: middle,
            walls: Walls::Corridor(CORRIDOR),
        },
        Storey {
            map: top,
            walls: Walls::None,
        },
    ];
    let building = Building {
        lowest: Site {
            map: below,
            config,
            walls: Walls::Box {
                least: [1.0, 1.0],
                most: [70.0, 14.0],
            },
        },
        above: &above,
        passages: &[STAIRS, LIFT],
    };
    building.check().expect("it is right");
    let mut walk = Walk::<201, 651, 2, S>::new(louder_db);
    walk.go((below, 12), [[27.0, 9.0], [8.0, 5.0]], &building, &ROOMS);
    walk.flush(&building, &ROOMS);
    // Who is at the stairs has shown a badge below. NaN is no probability at all.
    let badge = |[x, y]: [f32; 2], floor| {
        let [dx, dy] = [x - 8.0, y - 5.0];
        match floor {
            0 if dx > 0.0 => f32::NAN,
            0 => -0.1 * (dx * dx + dy * dy),
            _ => -4.0,
        }
    };
    let fix = walk
        .weigh(400, badge, &building, &ROOMS)
        .expect("it is possible");
    assert!((fix.position[0] - 8.0).abs() < 3.0 && walk.tag.floor() == Some(0));
    walk.store(&building);
    walk.go((middle, 4), [[8.0, 5.0]; 2], &building, &ROOMS);
    walk.go((middle, 34), [[8.0, 5.0], [58.0, 4.0]], &building, &ROOMS);
    walk.go((middle, 7), [[58.0, 4.0], [60.0, 12.0]], &building, &ROOMS);
    walk.go((top, 5), [[60.0, 12.0]; 2], &building, &ROOMS);
    walk.go((top, 9), [[60.0, 12.0], [73.0, 13.5]], &building, &ROOMS);
    // There it rests. Beyond the map it cannot be, however little is known.
    walk.go((top, 6), [[73.0, 13.5]; 2], &building, &ROOMS);
    let anywhere = |_: [f32; 2], _: u8| 0.0;
    for after_ms in [900, 2_000] {
        let known = walk.weigh(after_ms, anywhere, &building, &ROOMS);
        known.expect("it is possible");
    }
    walk.store(&building);
    assert_eq!(walk.tag.floor(), Some(2));
    assert!(walk.tag.floor_probability(2) > 0.9);
    let fix = walk.tag.fix().expect("it was heard");
    assert!(
        (fix.position[0] - 73.0).abs() < 5.0 && (fix.position[1] - 13.5).abs() < 5.0,
        "{fix:?}"
    );
    assert_eq!(walk.passed, [1, -1, 2, -2, 3]);
    walk.digest
}

/// A brisk walk.
const BRISK: Config = Config {
    velocity_sigma_m_s: 1.5,
    velocity_memory_s: 20.0,
    ..Config::DEFAULT
};

fn who_takes_the_stairs_and_the_lift_is_followed() -> Digest {
    through_the_building::<OnFloor<Packed<2>>>(BRISK, -2.5)
}

fn particles_that_are_not_rounded_follow_too() -> Digest {
    through_the_building::<OnFloor<Exact>>(
        Config {
            offset_probability: 0.0,
            ..BRISK
        },
        0.0,
    )
}

fn rooms_of_a_tunnel_are_entered_in_their_order() -> Digest {
    let map = open(TUNNEL);
    let zones = [
        zone(
            1,
            0,
            &[[10.0, -2.0], [30.0, -2.0], [30.0, 5.0], [10.0, 5.0]],
        ),
        zone(
            2,
            0,
            &[[30.0, -2.0], [50.0, -2.0], [50.0, 5.0], [30.0, 5.0]],
        ),
        zone(
            3,
            0,
            &[[50.0, -2.0], [70.0, -2.0], [70.0, 5.0], [50.0, 5.0]],
        ),
    ];
    let rooms = Rooms {
        zones: &zones,
        probability: 0.8,
    };
    let site = Site::new(map, Config::TUNNEL).expect("moments");
    let mut walk = Walk::<151, 80, 1, Packed<1>>::new(0.0);
    let y = map.lattice().origin()[1];
    walk.go((map, 40), [[20.0, y], [75.0, y]], &site, &rooms);
    walk.flush(&site, &rooms);
    assert_eq!(walk.passed, [1, -1, 2, -2, 3, -3]);
    // At the end of the tunnel somebody looks for it 2 s later, and sees nobody within 3 m.
    let unseen = |[x, _]: [f32; 2], _| if (x - 78.0).abs() < 3.0 { -3.0 } else { 0.0 };
    let fix = walk
        .weigh(2_000, unseen, &site, &rooms)
        .expect("it is possible");
    assert!(fix.position[0] < 79.0);
    walk.store(&site);
    walk.digest
}
