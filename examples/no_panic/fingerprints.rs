//! Radio maps, trackers of tags, and their gateway.

use core::hint::black_box;

use foxhunt::{
    fingerprint::{
        GaussianMatcher, KernelDensity, Lattice, Matcher, Missing, Neighbours, Packet, PacketModel,
        Posterior, RadioMap, Reading, Samples, TableMatcher, tracker,
    },
    gateway,
    model::Likelihood,
    random::Xoshiro128PlusPlus,
};

use crate::values::{any, some, some_mut};

fn site(bytes: &[u8]) -> Option<tracker::Site<'_>> {
    use tracker::{Channel, Motion, Offset, Piece, Settings, Walls};
    let settings = Settings::new()
        .with_motion(any(Motion::new()))
        .and_then(|settings| settings.with_channel(any(Channel::new())))
        .and_then(|settings| settings.with_offset(any(Offset::new())))
        .and_then(|settings| settings.with_window_ms(any(0)))
        .and_then(|settings| settings.with_recovery(any(0.5)))
        .and_then(|settings| settings.with_uncertain_m(any(5.0)));
    const PIECE: Piece = Piece {
        from: [0.0; 2],
        to: [1.0; 2],
        width: 1.0,
    };
    let site = tracker::Site::new(RadioMap::new(bytes).ok()?, settings.ok()?).ok()?;
    Some(site.with_walls(any(Walls::Corridor(&[PIECE, PIECE]))))
}

pub fn track(rng: &mut Xoshiro128PlusPlus) {
    use tracker::{Heard, Tag, Trackers, Workspace};
    let bytes = any([0; 200]);
    let Some(site) = site(some(&bytes)) else {
        return;
    };
    let mut workspace = any(Workspace::<50, 64>::new());
    let mut trackers = any(Trackers::<3, 50, 8>::new());
    let scan = any([Heard {
        beacon: 0,
        mean_dbm: 0.0,
        packets: 1,
    }; 8]);
    for _ in 0..any(100) {
        let (tracker, _) = trackers.of(Tag(any(0)), any(0));
        let (time, beacon, rssi) = any((0, 0, 0.0));
        _ = black_box(tracker.push(time, beacon, rssi, &site, &mut workspace, rng));
        _ = black_box(tracker.scan(time, some(&scan), &site, &mut workspace, rng));
        if let Some(fix) = tracker.flush(&site, &mut workspace, rng) {
            black_box((
                fix.ellipse(any(0.0)),
                fix.position_at(any(0)),
                fix.deviation(),
            ));
        }
        black_box(tracker.particles().get(any(0)));
        tracker.reset();
    }
    black_box(trackers.get(Tag(any(0))).and_then(|tracker| tracker.fix()));
    trackers.clear();
}

pub fn beacons() {
    use gateway::beacon::{BeaconGateway, Framing, Settings};
    let bytes = any([0; 200]);
    let Some(site) = site(some(&bytes)) else {
        return;
    };
    let settings = Settings::new()
        .with_framing(any(Framing::Lines))
        .with_seed(any(0))
        .with_silence_ms(any(0));
    let Ok(settings) = settings else { return };
    let mut gateway = any(BeaconGateway::<3, 50, 64, 8>::new(site, settings));
    for _ in 0..any(100) {
        black_box(gateway.push(any(0)));
        black_box((gateway.report(), gateway.counters(), gateway.tags().count()));
    }
    gateway.restart();
}

pub fn fingerprints() {
    use foxhunt::fingerprint::Settings;
    let settings = Settings::new()
        .with_missing(any(Missing::Modelled))
        .with_inflation_db(any(4.0))
        .and_then(|settings| settings.with_outliers(any(0.001)))
        .and_then(|settings| settings.with_tempering(any(0.5)))
        .and_then(|settings| settings.with_range_dbm(any([-120.0, 0.0])));
    let Ok(settings) = settings else { return };
    let scan = any([Reading {
        beacon: 0,
        rssi_dbm: 0.0,
    }; 8]);
    let scan = some(&scan);
    let mut posterior = any(Posterior::<50>::new());

    let lattice = Lattice::new(any([0.0; 2]), any(1.0), any(3), any(4));
    let values = any([0; 200]);
    if let Ok(samples) = lattice.and_then(|lattice| Samples::new(lattice, any(2), some(&values))) {
        black_box(samples.of(any(0), any(0)));
        if let Ok(matcher) = KernelDensity::new(samples, any(4.0), &settings) {
            _ = black_box(matcher.locate(scan, &mut posterior));
        }
    }

    let bytes = any([0; 200]);
    let Ok(map) = RadioMap::new(some(&bytes)).and_then(|map| map.limited(any(9), any(9))) else {
        return;
    };
    black_box((map.beacon(any(0)), map.beacon_index(any(0))));
    black_box((map.moments(any(0), any(0)), map.is_surveyed(any(0))));
    black_box(map.log_density(any(0), any(0.0), any(0)));
    black_box(map.lattice().position(any(0)));
    if let Ok(matcher) = GaussianMatcher::new(map, &settings) {
        _ = black_box(matcher.locate(scan, &mut posterior));
    }
    if let Ok(matcher) = TableMatcher::new(map, &settings) {
        _ = black_box(matcher.locate(scan, &mut posterior));
    }
    if let Ok(matcher) = Neighbours::new(map, any(3), &settings) {
        _ = black_box(matcher.locate(scan, &mut posterior));
    }
    black_box((posterior.weights(), posterior.covariance(map.lattice())));
    let model = any(PacketModel::new(&settings));
    let packet = any(Packet {
        beacon: 0,
        rssi_dbm: 0,
    });
    if let Ok(likelihood) = map.packet_likelihood(packet, any(0.0), &model) {
        let (x, y, mut out) = (any([0.0; 20]), any([0.0; 20]), any([0.0; 20]));
        likelihood.log_likelihoods(&[some(&x), some(&y)], some_mut(&mut out));
        black_box(likelihood.log_likelihood(&any([0.0; 4])));
    }
}
