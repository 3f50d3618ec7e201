//! A log on the page leads to what it leads to on the host.

use foxhunt::aoa::Locate;
use foxhunt_gateways::{plain, robust};
use foxhunt_host::{drive, replay::FullReplay, scripts::Script};
use foxhunt_wasm::{Log, LogOptions};

fn page(bytes: &[u8], robust: bool) -> Vec<[u32; 5]> {
    let mut log = Log::new(LogOptions { robust }).unwrap();
    for piece in bytes.chunks(1000) {
        log.push(piece);
    }
    let sources = log.state().answer.sources.into_iter();
    let numbers = sources.map(|source| {
        let [xx, xy, yy] = source.covariance;
        [source.x, source.y, xx, xy, yy].map(f32::to_bits)
    });
    numbers.collect()
}

fn host<L: Locate>(replay: &FullReplay<L>) -> Vec<[u32; 5]> {
    let locator = replay.gateway().locator();
    let fixes = (0..).map_while(|index| Some(locator.source(index)?.fix));
    let numbers = fixes.map(|fix| {
        let ([x, y], covariance) = (fix.position, fix.covariance);
        [x, y, covariance.xx, covariance.xy, covariance.yy].map(f32::to_bits)
    });
    numbers.collect()
}

#[test]
fn every_source_is_the_same_to_the_last_bit() {
    let two = Script::TwoSources.scene(1).drive;
    for (drive, count) in [(drive::example(drive::EXAMPLE_SEED), 1), (two, 2)] {
        let mut replay = FullReplay::<robust::Locator>::new(robust::CONFIG).unwrap();
        replay.push(drive.bytes());
        assert_eq!(host(&replay).len(), count);
        assert_eq!(page(drive.bytes(), true), host(&replay));

        let mut replay = FullReplay::<plain::Locator>::new(plain::CONFIG).unwrap();
        replay.push(drive.bytes());
        assert_eq!(page(drive.bytes(), false), host(&replay));
    }
}
