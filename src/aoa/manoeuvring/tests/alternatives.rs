//! Readings of several bearings that exclude each other.

use super::*;
use crate::aoa::Alternative;

/// Of a chase in which the most probable bearing of every reading is that of a reflector.
#[test]
fn less_probable_bearings_tell_of_the_source() {
    let mut known = [0, 0];
    for seed in 0..10 {
        let mut chase = Chase::random(&mut generator(seed));
        chase.outliers = 0.0;
        let mut locators = [subject(), subject()];
        let mut rng = generator(seed);
        for step in chase.bearings(seed) {
            let right = step.observation;
            let wrong = Observation::new(
                right.time_ms(),
                right.position(),
                Bearing::from_radians(TAU * uniform(&mut rng)),
                right.sigma_rad(),
            );
            let reading = [
                Alternative::new(wrong.unwrap(), 0.55).unwrap(),
                Alternative::new(right, 0.45).unwrap(),
            ];
            let [both, best] = &mut locators;
            both.push_alternatives(&reading, &mut rng).unwrap();
            best.push(reading[0].observation(), &mut rng).unwrap();
            if step.time >= 150.0 && step.time % 10.0 == 0.0 {
                for (known, locator) in known.iter_mut().zip(&locators) {
                    let near = |fix: Fix| fix.ellipse(0.95).contains(step.source);
                    *known += u32::from(locator.fix().is_some_and(near));
                }
            }
        }
    }
    println!("{known:?} of 210");
    assert!(known[0] > 168 && known[1] < 63, "{known:?}");
}
