//! One of several sources that moves.

use super::*;
use crate::aoa::locate::Locate;
use crate::aoa::sources::{self, Sources};

/// What is said is of a source for as long as one is tracked, also while none has a fix.
#[test]
fn a_source_without_a_fix_is_still_the_one_spoken_of() {
    const TRACK: Pursuit<256, 64> =
        Pursuit::new(Settings::new(robust::Settings::new(Errors::new())));
    let mut lost = 0;
    for seed in 0..8 {
        let chase = Chase::random(&mut generator(seed));
        let mut rng = generator(seed);
        let mut several = Sources::<3, _>::new(sources::Settings::new(), [TRACK; 3]);
        for step in chase.bearings(seed) {
            let answer = several.push_after(step.observation, 1.0, &mut rng);
            if several.tracks().next().is_none() || several.source(0).is_some() {
                continue;
            }
            lost += 1;
            let one = several.tracks().map(|(_, track)| track).find(|track| {
                (
                    track.answer(),
                    Locate::hypothesis(*track, 0),
                    track.advice(),
                ) == (answer, several.hypothesis(0), several.advice())
            });
            let one = one.expect("what is said is of one of the tracks");
            assert_eq!(several.bias(), one.bias());
            assert_eq!(several.shares(), one.shares());
            assert!(several.shares().is_some());
            assert_eq!(
                several.classify(&step.observation).is_some(),
                one.classify(&step.observation).is_some()
            );
        }
    }
    println!("{lost} bearings without a fix");
    assert!(lost > 20, "{lost}");
}
