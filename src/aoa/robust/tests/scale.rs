//! Tests of the scale of stated sigmas.

use super::*;

/// The scale that is learned of bearings whose errors are so many times as large as stated, and the locator's answer.
fn learned_scale(scale_sigma: f32, times: f32, seed: u64) -> SigmaScale {
    let mut observations = drive(Track::A2, 0.0, 0.1, seed);
    for observation in &mut observations {
        *observation = observation.with_sigma(observation.sigma_rad() / times);
    }
    let errors = Errors {
        scale_sigma,
        ..independent()
    };
    let locator: Clocked<Robust<256, 64>> = locate(errors, &observations, seed);
    fix(locator.answer());
    locator.sigma_scale().unwrap()
}

#[test]
fn scale_of_sigmas_is_learned() {
    for (times, seed) in [(1.0 / 3.0, 11), (1.0, 12), (3.0, 13)] {
        let learned = learned_scale(Errors::DEFAULT.scale_sigma, times, seed);
        // Of some 54 bearings the scale is known to a tenth.
        assert!(
            (0.05..0.14).contains(&(learned.sigma / learned.mean)),
            "{learned:?}"
        );
        let off = (learned.mean / times).ln().abs();
        assert!(off < 0.35, "{times}: {learned:?}");
    }
    let kept = learned_scale(0.0, 2.0, 14);
    assert!((kept.mean - 1.0).abs() < 1e-6 && kept.sigma == 0.0);
}

#[test]
fn scale_before_a_fix_is_that_which_is_stated() {
    let locator = Clocked::<Robust<256, 64>>::new(Config::DEFAULT);
    let scale = locator.sigma_scale().unwrap();
    assert!((scale.mean - 1.0).abs() < 1e-6);
    assert!((scale.sigma / Errors::DEFAULT.scale_sigma - 1.0).abs() < 1e-6);
}

#[test]
fn rates_that_weigh_as_much_as_a_million_bearings_are_not_learned() {
    let counts = Mixture {
        direct: 2.0,
        mirrored: 3.0,
        outlier: 5.0,
    };
    let learned = |prior_bearings| {
        let errors = Errors {
            prior_bearings,
            ..Errors::DEFAULT
        };
        errors.learned_rates(&counts)
    };
    for weight in [2e6, f32::INFINITY] {
        assert_eq!(learned(weight), Mixture::ZERO);
    }
    // Ten that were expected, and ten that came.
    let half = learned(10.0);
    assert!((half.direct - 0.5).abs() < 1e-6 && (half.outlier - 0.31).abs() < 1e-6);
    assert!((half.mirrored - 0.19).abs() < 1e-6);
}
