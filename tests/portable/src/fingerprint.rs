use foxhunt::{
    fingerprint::{
        Config, Match, Matcher, Posterior, RadioMap, Reading,
        tracker::{self, Site, State, Tracker, Workspace},
    },
    random::{SeedableRng, Xoshiro128PlusPlus, uniform},
};

use super::{Case, Digest, assert_normal};

pub const CASES: &[Case] = &[
    ("fingerprint::scans", scans),
    ("fingerprint::a_walk_is_tracked", a_walk_is_tracked),
];

static MOMENTS: &[u8] = include_bytes!("../data/tunnel.moments");
static LEVELS: &[u8] = include_bytes!("../data/tunnel.levels");
static HALL: &[u8] = include_bytes!("../data/hall.moments");

fn open(bytes: &'static [u8]) -> RadioMap<'static> {
    RadioMap::new(bytes).expect("the map is whole")
}

fn add(digest: &mut Digest, found: Match, weights: &[f32]) {
    assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    digest.add(&found.position);
    digest.add(&found.mean);
    digest.add(&[found.log_likelihood]);
    digest.add(weights);
}

fn scans() -> Digest {
    let (moments, levels) = (open(MOMENTS), open(LEVELS));
    let mut digest = Digest::new();
    let mut posterior = Posterior::<80>::EMPTY;
    for missing_beacons_count in [false, true] {
        let config = Config {
            missing_beacons_count,
            ..Config::DEFAULT
        };
        let gaussian = Matcher::new(moments, &config).expect("moments");
        let table = Matcher::new(levels, &config).expect("levels");
        for point in (0..80).step_by(7) {
            let scan = [0, 1, 2, 3].map(|beacon: u8| {
                let there = moments.moments(beacon.into(), point).expect("surveyed");
                Reading {
                    beacon,
                    rssi_dbm: there.mean_dbm + 2.0,
                }
            });
            for scan in [&scan[..], &scan[1..3]] {
                let found = gaussian.locate(scan, &mut posterior).expect("matches");
                if scan.len() == 4 {
                    let [x, _] = moments.lattice().position(point);
                    assert!((found.position[0] - x).abs() < 5.0, "{found:?} {x}");
                }
                add(&mut digest, found, posterior.weights());
                let found = table.locate(scan, &mut posterior).expect("matches");
                add(&mut digest, found, posterior.weights());
                digest.add(
                    posterior
                        .covariance(moments.lattice())
                        .rows()
                        .as_flattened(),
                );
            }
        }
    }
    digest
}

/// Somebody walks the tunnel, is carried off, and walks on with a louder tag; another crosses the hall.
fn a_walk_is_tracked() -> Digest {
    let mut digest = Digest::new();
    // Seconds, and points of the map at their beginning and at their end.
    for (bytes, seconds, ways) in [
        (MOMENTS, 20, [(0, 20, 0.0), (60, 79, 0.0), (79, 60, 9.0)]),
        (HALL, 15, [(2, 16, 0.0), (48, 62, 0.0), (94, 110, 0.0)]),
    ] {
        let map = open(bytes);
        let site = Site::new(map, tracker::Config::DEFAULT).expect("moments");
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut workspace = Workspace::<300, 256>::EMPTY;
        let mut tracker = Tracker::<300, 4>::EMPTY;
        let mut was_lost = false;
        let ways = ways.into_iter().enumerate();
        for (number, (from, to, offset)) in ways {
            for packet in 0..8 * seconds {
                let fraction = packet as f32 / (8 * seconds) as f32;
                let point = (from as f32 + fraction * (to as f32 - from as f32)) as usize;
                let beacon = (packet % 4) as u8;
                let there = map.moments(beacon.into(), point).expect("surveyed");
                let noise = 6.0 * uniform(&mut rng) - 3.0;
                let rssi = (there.mean_dbm + offset + noise) as i8;
                let time_ms = 125 * (packet + 8 * seconds * number as u32);
                let packet = Reading {
                    beacon,
                    rssi_dbm: rssi.into(),
                };
                let fix = tracker
                    .push(time_ms, packet, &site, &mut workspace, &mut rng)
                    .expect("it can be used");
                let Some(fix) = fix else { continue };
                was_lost |= fix.state == State::Lost;
                digest.add(&fix.position);
                digest.add(&fix.velocity);
                digest.add(fix.covariance.rows().as_flattened());
                digest.add(&[fix.offset_db, fix.effective_sample_size]);
                digest.add_bytes(&[fix.state as u8]);
            }
        }
        for particle in tracker.particles(&site) {
            assert_normal(&[&particle]);
            digest.add(&particle);
        }
        // In the hall it is carried no further than it is uncertain.
        assert!(was_lost || map.lattice().rows() > 1, "it was carried off");
    }
    digest
}
