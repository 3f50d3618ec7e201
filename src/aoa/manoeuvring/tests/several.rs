//! One of several sources that moves.

use super::*;
use crate::aoa::{MultiTarget, multi};

/// What is said is of a source for as long as one is tracked, also while none has a fix.
#[test]
fn a_source_without_a_fix_is_still_the_one_reported() {
    const CONFIG: Config = Config::DEFAULT;
    let mut unknown = 0;
    for seed in 0..8 {
        let mut chase = Chase::random(&mut generator(seed));
        // So wide errors that there often is no fix while the source moves.
        chase.sigma = 0.12;
        let mut rng = generator(seed);
        let mut several =
            Locator::<MultiTarget<3, Subject<256, 64>>>::new(multi::Config::new(CONFIG)).unwrap();
        for step in chase.bearings(seed) {
            let answer = several.push(&step.observation, &mut rng).unwrap();
            let tracks = || several.state().tracks().map(|(_, track)| track);
            if tracks().next().is_none() || several.source(0).is_some() {
                continue;
            }
            unknown += 1;
            let said = (answer, several.hypotheses().next(), several.advice());
            let one = tracks()
                .find(|track| (track.answer(), track.hypothesis(0), track.advice(&CONFIG)) == said);
            let one = one.expect("what is said is of one of the tracks");
            assert_eq!(several.bias(), one.bias(&CONFIG));
            assert_eq!(several.rates(), one.rates(&CONFIG));
            assert!(several.rates().is_some());
            assert_eq!(
                several.classify(&step.observation).is_some(),
                one.classify(&step.observation, &CONFIG).is_some()
            );
        }
    }
    println!("{unknown} bearings without a fix");
    assert!(unknown > 20, "{unknown}");
}
