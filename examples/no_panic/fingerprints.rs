//! Radio maps, trackers of tags, and their gateway.

use core::hint::black_box;

use foxhunt::{
    fingerprint::{Config, Lattice, Matcher, Posterior, RadioMap, Reading, Zone, tracker},
    gateway,
    random::Xoshiro128PlusPlus,
};

use crate::values::{any, some};

/// With any configuration, also one that a check would refuse.
fn site(bytes: &[u8]) -> Option<tracker::Site<'_>> {
    use tracker::{Piece, Site, Walls};
    const PIECE: Piece = Piece {
        from: [0.0; 2],
        to: [1.0; 2],
        width: 1.0,
    };
    let site = Site {
        map: RadioMap::new(bytes).ok()?,
        config: any(tracker::Config::DEFAULT),
        walls: any(Walls::Corridor(&[PIECE, PIECE])),
    };
    _ = black_box(site.check());
    Some(site)
}

pub fn track(rng: &mut Xoshiro128PlusPlus) {
    use tracker::{Trackers, Workspace};
    let bytes = any([0; 200]);
    let Some(site) = site(some(&bytes)) else {
        return;
    };
    let mut workspace = any(Workspace::<50, 64>::EMPTY);
    let mut trackers = any(Trackers::<3, 50, 8>::EMPTY);
    for _ in 0..any(100) {
        let Some((tracker, _)) = trackers.of(any(0), any(0)) else {
            continue;
        };
        let packet = any(Reading {
            beacon: 0,
            rssi_dbm: 0.0,
        });
        _ = black_box(tracker.push(any(0), packet, &site, &mut workspace, rng));
        if let Some(fix) = tracker.flush(&site, &mut workspace, rng) {
            black_box((
                fix.ellipse(any(0.0)),
                fix.position_at(any(0)),
                fix.sigma_m(),
            ));
        }
        black_box(tracker.particles(&site).next());
        tracker.reset();
    }
    black_box(trackers.now_ms());
    black_box(
        trackers
            .iter()
            .next()
            .and_then(|(_, tracker)| tracker.fix()),
    );
    trackers.clear();
}

pub fn beacons() {
    use gateway::beacon::{BeaconGateway, Config, Event, Framing};
    let bytes = any([0; 200]);
    let Some(site) = site(some(&bytes)) else {
        return;
    };
    let config = Config {
        framing: any(Framing::Lines),
        seed: any(0),
        silence_ms: any(0),
        ..Config::new(site)
    };
    _ = black_box(config.check());
    let mut gateway = any(BeaconGateway::<3, 50, 64, 8>::EMPTY);
    for _ in 0..any(100) {
        black_box(gateway.push(any(0), &config));
        black_box((gateway.report(), gateway.counters(), gateway.tags().count()));
    }
    gateway.restart();
    let mut buffer = any([0; 200]);
    if let Some(Event::MapPiece(piece)) = gateway.push(any(0), &config) {
        _ = black_box(gateway.take_map(&piece, &mut buffer));
    }
}

pub fn buildings(rng: &mut Xoshiro128PlusPlus) {
    use tracker::{Building, BuildingTracker, Occupancy, Passage, Rooms, Storey, Walls, Workspace};
    let (below, above) = (any([0; 200]), any([0; 200]));
    let (Some(lowest), Ok(map)) = (site(some(&below)), RadioMap::new(some(&above))) else {
        return;
    };
    let corners = any([[0.0f32; 2]; 5]);
    let place = Zone {
        id: any(0),
        floor: any(0),
        corners: some(&corners),
    };
    let floors = any([0; 3]);
    let building = Building {
        lowest,
        above: &[Storey {
            map,
            walls: Walls::None,
        }],
        passages: &[Passage {
            place,
            floors: some(&floors),
            seconds: any(1.0),
        }],
    };
    let rooms = Rooms {
        zones: &[place],
        probability: any(0.9),
    };
    _ = black_box((building.check(), rooms.check()));
    let mut workspace = any(Workspace::<50, 64, u8>::EMPTY);
    let mut tracker = any(BuildingTracker::<50, 8>::EMPTY);
    let mut occupancy = any(Occupancy::<3>::EMPTY);
    for _ in 0..any(100) {
        let packet = Reading {
            beacon: any(0),
            rssi_dbm: any(-60.0),
        };
        _ = black_box(tracker.push(any(0), packet, &building, &mut workspace, rng));
        let said = any(0.0);
        let door = |[x, _]: [f32; 2], _| x * said;
        _ = black_box(tracker.weigh(any(0), door, &building, &mut workspace, rng));
        occupancy.update(&tracker, &building, &rooms, |passing| {
            black_box(passing);
        });
    }
    black_box((tracker.floor(), tracker.floor_probability(any(0))));
    let config = gateway::beacon::Config::new(building);
    _ = black_box(config.check());
    let mut gateway = any(gateway::beacon::BuildingGateway::<3, 50, 64, 8>::EMPTY);
    for _ in 0..any(100) {
        black_box(gateway.push(any(0), &config));
        black_box((gateway.report(), gateway.tags().count()));
    }
}

pub fn fingerprints() {
    let config = any(Config::DEFAULT);
    let scan = any([Reading {
        beacon: 0,
        rssi_dbm: 0.0,
    }; 8]);
    let scan = some(&scan);
    let mut posterior = any(Posterior::<50>::EMPTY);

    _ = black_box(Lattice::new(any([0.0; 2]), any(1.0), any(3), any(4)));

    let bytes = any([0; 200]);
    let Ok(map) = RadioMap::new(some(&bytes)).and_then(|map| map.limited(any(9), any(9))) else {
        return;
    };
    black_box((map.beacon(any(0)), map.beacon_index(any(0))));
    black_box((map.moments(any(0), any(0)), map.is_possible(any(0))));
    black_box(map.log_density(any(0), any(0.0), any(0)));
    black_box((
        map.lattice().position(any(0)),
        map.lattice().nearest(any([0.0; 2])),
    ));
    if let Ok(matcher) = Matcher::new(map, &config) {
        _ = black_box(any(matcher).locate(scan, &mut posterior));
    }
    black_box((posterior.weights(), posterior.covariance(map.lattice())));
}
