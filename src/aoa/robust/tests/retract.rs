//! Bearings that are taken back.

use super::*;

#[test]
fn what_is_taken_back_leaves_what_the_others_say() {
    const RUNS: u64 = 200;
    let (mut square, mut covered, mut fixes) = (0.0, 0, 0);
    for seed in 0..RUNS {
        let observations = drive(Track::A2, 0.0, 0.1, seed);
        let mut rng = generator(seed);
        let mut locator = Locator::<Robust<512, 64>>::new(with(independent())).unwrap();
        let mut without = locator.clone();
        for (i, observation) in (0..).zip(&observations) {
            let observation = at(1000 * i, observation);
            locator.push(&observation, &mut rng).unwrap();
            // Every sixth is to be taken back.
            if i % 6 != 2 {
                without.push(&observation, &mut rng).unwrap();
            }
        }
        for i in (0..60).filter(|i| i % 6 == 2) {
            let time_ms = 1000 * i;
            let what = Retract::Bearing {
                time_ms,
                station: 0,
            };
            let retracted = locator.retract(&what, &mut rng);
            assert_eq!((retracted.bearings, retracted.merged), (1, 0));
        }
        let (Some(with), Some(never)) = (locator.fix(), without.fix()) else {
            continue;
        };
        fixes += 1;
        let offset = [0, 1].map(|d| with.position[d] - never.position[d]);
        let Symmetric2 { xx, xy, yy } = never.covariance;
        let [x, y] = offset;
        // Half of the squared Mahalanobis distance: the mean of the squares in two directions.
        square += 0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
        covered += u32::from(with.ellipse(0.95).contains(SOURCE));
        assert_eq!(with.bearings, 50);
    }
    let rms = (square / fixes as f32).sqrt();
    std::println!("{fixes} fixes, {rms} sigmas apart, {covered} covered");
    assert!(fixes as u64 > RUNS - 4 && rms < 0.15, "{rms}");
    // 95 % of 200 has a standard deviation of 3: one false alarm in 30,000 seeds.
    assert!((178..=200).contains(&covered), "{covered}");
}

#[test]
fn means_that_cannot_be_told_apart_stay_and_are_counted() {
    let mut locator = Locator::<Robust<256, 64>>::new(Config::DEFAULT).unwrap();
    let mut rng = generator(1);
    // Ten readings at each of four stops.
    for i in 0..40_u32 {
        let place = [200.0 * (i / 10) as f32, 0.0];
        let observation = at(1000 * i, &towards(place, SOURCE, 0.0, SIGMA));
        locator.push(&observation, &mut rng).unwrap();
    }
    let of = |retracted: Retracted| (retracted.bearings, retracted.merged);
    let mut retract = |what: Retract| of(locator.retract(&what, &mut rng));
    let bearing = |time_ms| Retract::Bearing {
        time_ms,
        station: 0,
    };
    assert_eq!(retract(bearing(5_000)), (0, 10));
    assert_eq!(retract(bearing(100_000)), (0, 0));
    assert_eq!(
        retract(Retract::Bearing {
            time_ms: 5_000,
            station: 1
        }),
        (0, 0)
    );
    // The second stop, and a part of the third.
    let span = Retract::Span {
        from_ms: 10_000,
        until_ms: 25_000,
    };
    assert_eq!(retract(span), (10, 10));
    let place = Retract::Place {
        position: [590.0, 5.0],
        radius_m: 20.0,
    };
    assert_eq!(retract(place), (10, 0));
    assert_eq!(locator.state().observations().len(), 2);
}
