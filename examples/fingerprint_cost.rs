//! What matching by fingerprints costs: a scan of four beacons in a tunnel of 80 points, and a packet for each
//! particle.
//!
//! Run by the tasks in the emulator like `cost`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod board {
    pub mod semihosting;
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    target::scans();
    target::particles();
    board::semihosting::exit(true)
}

#[cfg(target_os = "none")]
mod target {
    use core::{
        hint::black_box,
        sync::atomic::{Ordering, compiler_fence},
    };

    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        fingerprint::{
            GaussianMatcher, Matcher, Packet, PacketModel, Posterior, RadioMap, Reading, Settings,
            TableMatcher,
        },
        model::Likelihood,
        random::{SeedableRng, Xoshiro128PlusPlus, uniform},
    };

    static MOMENTS: &[u8] = include_bytes!("../tests/data/tunnel.moments");
    static LEVELS: &[u8] = include_bytes!("../tests/data/tunnel.levels");
    static HALL: &[u8] = include_bytes!("../tests/data/hall.moments");

    /// Marks the beginning and the end of a region.
    #[inline(never)]
    fn region_edge() {
        compiler_fence(Ordering::SeqCst);
        cortex_m::asm::nop();
    }

    /// A region whose cost is divided by `items`. Regions of one name are added up.
    fn region<T>(name: &str, items: usize, work: impl FnOnce() -> T) -> T {
        hprintln!("region\t{}\t{}", name, items);
        region_edge();
        let result = black_box(work());
        region_edge();
        result
    }

    fn open(bytes: &'static [u8]) -> RadioMap<'static> {
        RadioMap::new(black_box(bytes)).expect("the map is whole")
    }

    /// Whole scans, with the posterior and its moments.
    pub fn scans() {
        let (moments, levels) = (open(MOMENTS), open(LEVELS));
        let settings = Settings::new();
        let gaussian = black_box(GaussianMatcher::new(moments, &settings).expect("moments"));
        let table = black_box(TableMatcher::new(levels, &settings).expect("levels"));
        let mut posterior = black_box(Posterior::<80>::new());
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

    /// One packet for a cloud.
    pub fn particles() {
        const N: usize = 300;
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut x = [0.0; N];
        x.fill_with(|| 80.0 * uniform(&mut rng));
        let y = x.map(|x| 0.2 * x);
        let mut out = [0.0; N];
        let model = black_box(PacketModel::new(&Settings::new()));
        let packet = black_box(Packet {
            beacon: 1,
            rssi_dbm: -63,
        });
        for (name, bytes) in [
            ("m4f.fingerprint.packet.line", MOMENTS),
            ("m4f.fingerprint.packet.plane", HALL),
        ] {
            let map = open(bytes);
            region(name, N, || {
                let likelihood = map.packet_likelihood(packet, 1.5, &model).expect("known");
                likelihood.log_likelihoods(&[&x, &y], &mut out);
                black_box(&mut out);
            });
        }
    }
}
