//! Tests of the scale of stated sigmas.

use super::super::errors::Counts;
use super::*;

/// The scale that is learned of bearings whose errors are so many times as large as stated, and the locator's answer.
fn learned_scale(scale_bearings: f32, times: f32, seed: u64) -> SigmaScale {
    let mut observations = drive(Track::A2, 0.0, 0.1, seed);
    for observation in &mut observations {
        *observation = observation.with_sigma(observation.sigma_rad() / times);
    }
    let errors = Errors {
        scale_bearings,
        ..independent()
    };
    let locator: Clocked<Robust<256, 64>> = locate(errors, &observations, seed);
    fix(locator.answer());
    locator.sigma_scale().unwrap()
}

#[test]
fn scale_of_sigmas_is_learned() {
    for (times, seed) in [(0.5, 11), (1.0, 12), (2.0, 13)] {
        let learned = learned_scale(2.0, times, seed);
        // Of 54 bearings the scale is known to a tenth.
        assert!((learned.sigma / learned.mean - 0.1).abs() < 0.02);
        let off = (learned.mean / times).ln().abs();
        assert!(off < 0.3, "{times}: {learned:?}");
    }
    let kept = learned_scale(f32::INFINITY, 2.0, 14);
    assert_eq!((kept.mean, kept.sigma), (1.0, 0.0));
}

#[test]
fn scale_of_few_bearings_is_that_which_is_stated() {
    let mut counts = Counts::NONE;
    let errors = Errors {
        scale_bearings: 10.0,
        ..Errors::DEFAULT
    };
    let learned = errors.learned(&counts).sigma_scale;
    assert_eq!(learned.mean, 1.0);
    // Three bearings that fit without any error.
    counts.bearings = 3.0;
    let learned = errors.learned(&counts).sigma_scale;
    assert!(learned.mean > 0.87, "{learned:?}");
}
