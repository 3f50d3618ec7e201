//! All that locators of clean bearings and of several channels say of a drive.

use core::fmt::Write;

use foxhunt::{
    aoa::{
        Answer, Bearing, Channels, Clean, Locate, Locator, Manoeuvring, MultiTarget, Observation,
        Retract, Robust, clean, manoeuvring, multi, robust,
    },
    math,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
};

use super::{Case, Digest, aoa::drive, assert_normal};

pub const CASES: &[Case] = &[
    (
        "answers::bearings_are_averaged_and_taken_back",
        bearings_are_averaged_and_taken_back,
    ),
    ("answers::reasons_are_told", reasons_are_told),
    (
        "answers::tracks_of_clean_bearings",
        tracks_of_clean_bearings,
    ),
    (
        "answers::every_channel_has_its_source",
        every_channel_has_its_source,
    ),
];

/// Adds all that a locator knows, and what it takes the last bearing for.
pub fn add_all<L: Locate>(digest: &mut Digest, locator: &Locator<L>, last: &Observation) {
    digest.add_shown(&locator.answer());
    if let Answer::NotObservable(reason) = locator.answer() {
        let written = write!(digest, "{reason}: {}", reason.help());
        written.expect("a digest takes all");
    }
    for index in 0..4 {
        digest.add_shown(&locator.source(index));
        if let Some(cloud) = locator.cloud(index) {
            let columns = [cloud.east, cloud.north, cloud.weights];
            assert_normal(&columns);
            for column in columns {
                digest.add(column);
            }
        }
    }
    for place in locator.candidates().chain(locator.hypotheses()) {
        digest.add_shown(&place);
    }
    digest.add_shown(&(locator.bias(), locator.rates(), locator.sigma_scale()));
    digest.add_shown(&(locator.advice(), locator.classify(last)));
}

/// The bearings of the drive by two arrays, which head where they please.
fn by_two_arrays() -> [Observation; 40] {
    let mut all = drive();
    for (i, observation) in all.iter_mut().enumerate() {
        let heading = Bearing::from_radians(0.7 * i as f32);
        let station = u8::from(i % 5 == 2);
        *observation = observation.from_station(station).with_heading(heading);
    }
    all
}

/// The bearing on another place, taken where and when this one was.
fn on([x, y]: [f32; 2], one: &Observation) -> Observation {
    let [east, north] = one.position();
    let bearing = Bearing::from_radians(math::atan2(y - north, x - east));
    Observation::new(one.time_ms(), one.position(), bearing, 0.02).expect("in range")
}

fn bearings_are_averaged_and_taken_back() -> Digest {
    let mut digest = Digest::new();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(5);
    let mut locator = Locator::<Clean<48, 16>>::new(clean::Config::DEFAULT).expect("in range");
    let all = by_two_arrays();
    // Two come late.
    let order = (0..40).map(|i| if (18..20).contains(&i) { 37 - i } else { i });
    for observation in order.filter_map(|i| all.get(i)) {
        locator.push(observation, &mut rng).expect("in order");
        add_all(&mut digest, &locator, observation);
    }
    digest.add_shown(&locator.push(&all[39], &mut rng));
    for observation in locator.state().observations() {
        digest.add_shown(observation);
    }
    let last = all[39];
    for what in [
        Retract::Bearing {
            time_ms: last.time_ms(),
            station: last.station(),
        },
        Retract::Bearing {
            time_ms: 5_000,
            station: 0,
        },
        Retract::Span {
            from_ms: 30_000,
            until_ms: 36_500,
        },
        Retract::Place {
            position: [1_850.0, 0.0],
            radius_m: 55.0,
        },
        Retract::Place {
            position: [0.0, 900.0],
            radius_m: 100.0,
        },
    ] {
        digest.add_shown(&locator.retract(&what, &mut rng));
        add_all(&mut digest, &locator, &last);
    }
    // Another source than before, which the particles must be led to.
    for (i, one) in all.iter().enumerate().step_by(4) {
        let mirrored = on([900.0, -700.0], one);
        let late = Observation::new(
            60_000 + 500 * i as u32,
            mirrored.position(),
            mirrored.bearing(),
            0.02,
        )
        .expect("in range");
        locator.push(&late, &mut rng).expect("in order");
        add_all(&mut digest, &locator, &late);
    }
    locator.reset();
    assert_eq!(locator.fix(), None);
    digest
}

/// Bearings that are parallel, that part, that meet far away.
fn reasons_are_told() -> Digest {
    let mut digest = Digest::new();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(6);
    let turn: [fn(f32) -> f32; 4] = [
        |_| 1.2,
        |east| 1.0 - 2e-3 * east,
        |east| 1.0 + 4e-5 * east,
        |east| 0.5 + 2e-3 * east,
    ];
    for turn in turn {
        let mut robust = Locator::<Robust<64, 16>>::new(robust::Config::DEFAULT).expect("in range");
        let mut clean = Locator::<Clean<48, 16>>::new(clean::Config::DEFAULT).expect("in range");
        for one in drive().iter().step_by(3) {
            let bearing = Bearing::from_radians(turn(one.position()[0]));
            let seen = Observation::new(one.time_ms(), one.position(), bearing, 0.03);
            let seen = seen.expect("in range");
            clean.push(&seen, &mut rng).expect("in order");
            add_all(&mut digest, &clean, &seen);
            robust.push(&seen, &mut rng).expect("in order");
            add_all(&mut digest, &robust, &seen);
        }
    }
    digest
}

/// A source that drives off, and two sources, by locators of clean bearings.
fn tracks_of_clean_bearings() -> Digest {
    type One = Clean<48, 16>;
    let mut digest = Digest::new();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(7);
    let config = manoeuvring::Config::new(clean::Config::DEFAULT);
    let mut pursuer = Locator::<Manoeuvring<One>>::new(config).expect("in range");
    let config = multi::Config::new(clean::Config::DEFAULT);
    let mut several = Locator::<MultiTarget<2, One, 16>>::new(config).expect("in range");
    for (i, one) in drive().iter().chain(&drive()).enumerate() {
        let time_ms = 2_000 * i as u32;
        let driven = if i < 40 {
            0.0
        } else {
            15.0 * (i as f32 - 40.0)
        };
        let places = [
            [1_200.0 - driven, 800.0 + driven],
            [[1_200.0, 800.0], [700.0, -900.0]][usize::from(i % 3 == 1)],
        ];
        let [moving, either] = places.map(|place| {
            let exact = on(place, one);
            let radians = exact.bearing().radians() + 0.02 * normal(&mut rng);
            let bearing = Bearing::from_radians(radians);
            Observation::new(time_ms, one.position(), bearing, 0.02).expect("in range")
        });
        pursuer.push(&moving, &mut rng).expect("in order");
        several.push(&either, &mut rng).expect("in order");
        digest.add_shown(&pursuer.state().motion());
        if i % 4 == 3 {
            add_all(&mut digest, &pursuer, &moving);
            add_all(&mut digest, &several, &either);
        }
    }
    let what = Retract::Span {
        from_ms: 150_000,
        until_ms: 160_000,
    };
    digest.add_shown(&pursuer.retract(&what, &mut rng));
    digest.add_shown(&several.retract(&what, &mut rng));
    assert!(several.source(1).is_some());
    digest
}

/// Four channels share three places, so that the one that is silent for longest loses its own.
fn every_channel_has_its_source() -> Digest {
    const PLACES: [[f32; 2]; 4] = [
        [900.0, 900.0],
        [1_100.0, -700.0],
        [300.0, 600.0],
        [1_400.0, 800.0],
    ];
    let mut digest = Digest::new();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(8);
    let mut robust =
        Locator::<Channels<3, Robust<64, 16>>>::new(robust::Config::DEFAULT).expect("in range");
    let mut clean =
        Locator::<Channels<3, Clean<48, 16>>>::new(clean::Config::DEFAULT).expect("in range");
    let all = drive();
    for (i, one) in all.iter().enumerate() {
        let channel = if i < 30 {
            [2, 0, 1][i % 3]
        } else {
            [3, 0][i % 2]
        };
        let exact = on(PLACES[usize::from(channel)], one);
        let bearing = Bearing::from_radians(exact.bearing().radians() + 0.02 * normal(&mut rng));
        let heard = Observation::new(one.time_ms(), one.position(), bearing, 0.02);
        let heard = heard.expect("in range").on_channel(channel);
        robust.push(&heard, &mut rng).expect("in order");
        clean.push(&heard, &mut rng).expect("in order");
        if i % 3 == 2 {
            add_all(&mut digest, &robust, &heard);
            add_all(&mut digest, &clean, &heard.on_channel(0));
        }
    }
    for channel in clean.state().channels().chain(robust.state().channels()) {
        digest.add_bytes(&[channel]);
    }
    let what = Retract::Span {
        from_ms: 20_000,
        until_ms: 34_500,
    };
    for retracted in [
        robust.retract(&what, &mut rng),
        clean.retract(&what, &mut rng),
    ] {
        assert!(retracted.bearings > 0);
        digest.add_shown(&retracted);
    }
    add_all(&mut digest, &robust, &all[39]);
    add_all(&mut digest, &clean, &all[39]);
    digest
}
