//! What it costs that a source might move which does not.

use super::*;
use crate::aoa::testing::{Track, simulate};

/// Sum of squares, and runs that are covered.
struct Score {
    square: f64,
    covered: u32,
    fixes: u32,
}

fn score(answer: Answer, source: [f32; 2], score: &mut Score) {
    if let Answer::Fix(fix) = answer {
        score.square += f64::from(distance(fix.position, source).powi(2));
        score.covered += u32::from(fix.ellipse(0.95).contains(source));
        score.fixes += 1;
    }
}

#[test]
fn a_source_that_never_moves_is_located_as_well() {
    const RUNS: u32 = 300;
    for track in [Track::A1, Track::A2] {
        let mut scores = [(); 2].map(|()| Score {
            square: 0.0,
            covered: 0,
            fixes: 0,
        });
        let mut alarms = 0;
        for seed in 0..RUNS {
            let mut rng = generator(u64::from(seed));
            let bearings: Vec<Observation> = simulate(track, &mut rng).collect();
            let mut wrapped = subject();
            let mut alone = Locator::<Robust<256, 64>>::new(STRAIGHT).unwrap();
            let mut alarm = false;
            for (i, observation) in (0..).zip(&bearings) {
                // At 13 metres a second or more, one after the other.
                let observation = at(2000 * i, observation);
                wrapped.push(&observation, &mut rng).unwrap();
                alone.push(&observation, &mut rng).unwrap();
                alarm |= wrapped
                    .state()
                    .motion()
                    .is_some_and(|motion| motion.moving > 0.5);
            }
            alarms += u32::from(alarm);
            score(wrapped.answer(), track.source(), &mut scores[0]);
            score(alone.answer(), track.source(), &mut scores[1]);
        }
        let [with, without] = scores.map(|score| {
            let fixes = f64::from(score.fixes);
            let root = (score.square / fixes).sqrt();
            (root, f64::from(score.covered) / fixes, score.fixes)
        });
        println!("{track:?}: {with:?}, {without:?} if it cannot move; {alarms} false alarms");
        assert_eq!(with.2, RUNS);
        assert!(with.0 < 1.03 * without.0);
        assert!((with.1 - without.1).abs() < 0.02);
    }
}
