//! What fingerprints cost: a scan of four beacons in a tunnel of 80 points, and updates of the
//! tracker, there and on a floor of 440 points with twelve beacons.
//!
//! Run by the tasks in the emulator like `cost`.

#![cfg_attr(target_os = "none", no_std, no_main)]

foxhunt_emulated::program!(target::run);

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        fingerprint::{
            Config, Matcher, Posterior, RadioMap, Reading,
            tracker::{self, Site, Tracker, Workspace},
        },
        random::{SeedableRng, Xoshiro128PlusPlus, uniform},
    };
    use foxhunt_emulated::{map, region::region};

    static MOMENTS: &[u8] = include_bytes!("../tests/portable/data/tunnel.moments");
    static LEVELS: &[u8] = include_bytes!("../tests/portable/data/tunnel.levels");

    fn open(bytes: &'static [u8]) -> RadioMap<'static> {
        RadioMap::new(black_box(bytes)).expect("the map is whole")
    }

    /// Runs all regions.
    pub fn run() {
        scans();
        updates();
        sizes();
    }

    /// Whole scans, with the posterior and its moments.
    fn scans() {
        let (moments, levels) = (open(MOMENTS), open(LEVELS));
        let config = Config::DEFAULT;
        let gaussian = black_box(Matcher::new(moments, &config).expect("moments"));
        let table = black_box(Matcher::new(levels, &config).expect("levels"));
        let mut posterior = black_box(Posterior::<80>::EMPTY);
        for point in [0, 17, 40, 63, 79] {
            let scan = black_box([0, 1, 2, 3].map(|beacon| {
                Reading {
                    beacon,
                    rssi_dbm: moments
                        .moments(beacon.into(), point)
                        .map_or(-90.0, |moments| moments.mean_dbm + 3.0),
                }
            }));
            region("m4f.fingerprint.match.gaussian", 1, || {
                _ = black_box(&gaussian.locate(&scan, &mut posterior));
            });
            region("m4f.fingerprint.match.table", 1, || {
                _ = black_box(&table.locate(&scan, &mut posterior));
            });
        }
    }

    /// Updates of a tracker in the middle of a walk: scans by the half second, of two packets of every beacon.
    fn updates() {
        let mut floor = [0; FLOOR_BYTES];
        write_floor(&mut floor);
        follow::<80, 1>("m4f.tracker.n300.update", open(MOMENTS), [0.5, 0.0]);
        let floor = RadioMap::new(black_box(&floor)).expect("it was just written");
        follow::<440, 2>("m4f.tracker.n300.plane.update", floor, [0.2, 0.25]);
    }

    /// Updates before the cost is taken, and those of which it is.
    const UPDATES: [u32; 2] = [8, 8];

    fn follow<const P: usize, const D: usize>(name: &str, map: RadioMap<'_>, step: [f32; 2]) {
        let site = black_box(Site::new(map, tracker::Config::DEFAULT).expect("moments"));
        let mut workspace = black_box(Workspace::<300, P>::EMPTY);
        let mut tracker = black_box(Tracker::<300, 16, D>::EMPTY);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let lattice = map.lattice();
        for update in 0..UPDATES[0] + UPDATES[1] {
            let [column, row] = step.map(|step| (step * update as f32) as usize);
            let point = (row + 3) % lattice.rows() * lattice.columns() + column + 5;
            let noise = [(); BEACONS].map(|()| 8.0 * uniform(&mut rng) - 4.0);
            for (beacon, noise) in noise.into_iter().enumerate().take(map.beacons()) {
                let there = map.moments(beacon, point);
                let packet = black_box(Reading {
                    beacon: beacon as u8,
                    rssi_dbm: noise + there.map_or(0.0, |moments| moments.mean_dbm),
                });
                for _ in 0..2 {
                    let pushed =
                        tracker.push(500 * update, packet, &site, &mut workspace, &mut rng);
                    assert_eq!(pushed, Ok(None));
                }
            }
            let mut run = || {
                let fix = tracker.flush(&site, &mut workspace, &mut rng);
                assert!(black_box(fix).is_some());
            };
            if update < UPDATES[0] {
                run();
            } else {
                region(name, 1, run);
            }
        }
    }

    const COLUMNS: usize = 22;
    const POINTS: usize = 440;
    const BEACONS: usize = 12;
    const FLOOR_BYTES: usize = map::bytes(BEACONS, POINTS);

    /// The map of a floor, 22 by 20 points, whose beacons stand in three rows.
    fn write_floor(bytes: &mut [u8; FLOOR_BYTES]) {
        map::write(
            bytes,
            [BEACONS as u8, COLUMNS as u8, 20],
            1.0,
            |beacon, point| {
                let [x, y] = [point % COLUMNS, point / COLUMNS];
                let [dx, dy] = [x.abs_diff(beacon % 4 * 7), y.abs_diff(beacon / 4 * 9)];
                [12 + (point % 7) as u8, 150 - 3 * (dx + dy) as u8]
            },
        );
    }

    fn sizes() {
        for (name, bytes) in [
            ("tracker.n300.plane", size_of::<Tracker<300, 16, 2>>()),
            ("tracker.n300", size_of::<Tracker<300, 16, 1>>()),
            ("fingerprint.map.moments", MOMENTS.len()),
            ("fingerprint.map.levels", LEVELS.len()),
        ] {
            hprintln!("figure\t{}.bytes\t{}\tbytes", name, bytes);
        }
    }
}
