//! Where one answer becomes another.

use super::*;

#[test]
fn errors_are_consistent_within_four_sigmas_of_their_number() {
    // Of so many squares the variance is twice their number.
    for (freedom, limit) in [(2.0, 10.0), (8.0, 24.0), (50.0, 90.0)] {
        assert!(is_consistent(0.0, freedom) && is_consistent(limit - 0.01, freedom));
        assert!(!is_consistent(limit + 0.01, freedom));
    }
}

#[test]
fn a_configuration_is_checked_with_its_refinement() {
    type Refined = Clean<8, 4, FishSchool>;
    let field = |config| Refined::check(&config).map_err(|error| error.field());
    let school = FishSchool::METROPOLIS;
    let fine = Config::with_refinement(school);
    assert_eq!(field(fine), Ok(()));
    let idle = FishSchool { tries: 0, ..school };
    assert_eq!(field(Config::with_refinement(idle)), Err("tries"));
    for (config, expected) in [
        (Config { moves: 0, ..fine }, "moves"),
        (Config { moves: 17, ..fine }, "moves"),
        (
            Config {
                resample_below: 1.1,
                ..fine
            },
            "resample_below",
        ),
        (
            Config {
                relative_range_sigma: 0.009,
                ..fine
            },
            "relative_range_sigma",
        ),
    ] {
        assert_eq!(field(config), Err(expected));
    }
    for (relative_range_sigma, resample_below, moves) in [(0.01, 0.0, 1), (1.0, 1.0, 16)] {
        let ends = Config {
            relative_range_sigma,
            resample_below,
            moves,
            ..fine
        };
        assert_eq!(field(ends), Ok(()));
    }
}

#[test]
fn there_is_one_cloud_and_only_with_a_fix() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(63);
    let mut locator = Clocked::<Clean<40, 16>>::new(Config::DEFAULT);
    locator.push(observe([0.0, 0.0], 0.0), &mut rng);
    assert_eq!(locator.cloud(0), None);
    assert!(matches!(drive(&mut locator, 12, &mut rng), Answer::Fix(_)));
    let cloud = locator.cloud(0).unwrap();
    assert_eq!((cloud.east.len(), cloud.weights.len()), (40, 40));
    assert_eq!(locator.cloud(1), None);
    assert!((cloud.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
}

#[test]
fn without_some_of_its_bearings_a_source_is_located_anew() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(64);
    let mut locator = Locator::<Clean<40, 16>>::new(Config::DEFAULT).unwrap();
    for i in 0..10_u16 {
        let taken = observe([150.0 * f32::from(i), 0.0], 0.0);
        let taken = crate::aoa::testing::at(1_000 * u32::from(i), &taken);
        locator.push(&taken, &mut rng).unwrap();
    }
    let before = locator.answer();
    let span = |from_ms, until_ms| Retract::Span { from_ms, until_ms };
    let retracted = locator.retract(&span(100, 900), &mut rng);
    assert_eq!((retracted, locator.answer()), (Retracted::NOTHING, before));
    let retracted = locator.retract(&span(2_000, 4_000), &mut rng);
    assert_eq!((retracted.bearings, retracted.merged), (3, 0));
    assert_eq!(locator.fix().unwrap().bearings, 7);
    let retracted = locator.retract(&span(1_000, 9_000), &mut rng);
    assert_eq!(retracted.bearings, 6);
    let one = NotObservable::TooFewBearings { have: 1 };
    assert_eq!(locator.answer(), Answer::NotObservable(one));
}
