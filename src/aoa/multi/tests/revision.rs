//! Earlier bearings in the light of later ones.

use super::stops::{ROOM, stop};
use super::*;

/// What bearings are off by at each stop, if it is the same for all sources or if each has its own; radians.
const STOP_SIGMA: f32 = 0.09;

/// RMSE of the places of four sources heard once from each of 21 stops, and the mean of the variance that is learned.
fn errors(stop_error: impl Fn(&mut Xoshiro128PlusPlus) -> [f32; 4]) -> [f32; 2] {
    const RUNS: u64 = 12;
    let (mut square, mut variance) = (0.0, 0.0);
    for seed in 0..RUNS {
        let places = (0..84).map(|i| stop(i / 4));
        let sights = bearings(places, &ROOM, |_, i| Some(i % 4), seed);
        let mut rng = generator(!seed);
        let mut turns = [0.0; 4];
        let mut sources = Locator::<MultiTarget<6, One>>::new(Config::DEFAULT).unwrap();
        let mut locate = generator(seed);
        for (i, sight) in sights.iter().enumerate() {
            if i % 4 == 0 {
                turns = stop_error(&mut rng);
            }
            let turned = observe(
                i,
                sight.position(),
                sight.bearing().radians() + turns[i % 4],
            );
            sources.push(&turned, &mut locate).unwrap();
        }
        for truth in ROOM {
            let nearest = |a: f32, one: &Source| a.min(off(&one.fix, truth));
            let nearest = all(&sources).iter().fold(3.0, nearest);
            square += nearest * nearest;
        }
        variance += sources.state().revision.variance;
    }
    let runs = RUNS as f32;
    [(square / (4.0 * runs)).sqrt(), variance / runs]
}

#[test]
fn what_all_sources_are_off_by_at_a_stop_is_taken_off() {
    let [in_common, learned] = errors(|rng| [STOP_SIGMA * normal(rng); 4]);
    let [each, nothing] = errors(|rng| [0; 4].map(|_| STOP_SIGMA * normal(rng)));
    assert!(in_common < 0.6 * each, "{in_common} {each}");
    let truth = STOP_SIGMA * STOP_SIGMA;
    assert!((0.6..1.2).contains(&(learned / truth)), "{learned} {truth}");
    assert!(nothing < 0.1 * truth, "{nothing}");
}

#[test]
fn where_there_is_no_such_error_none_is_learned() {
    let [_, learned] = errors(|_| [0.0; 4]);
    assert!(learned < 0.2 * SIGMA * SIGMA, "{learned}");
}

/// Two tracks, each of the bearings on one of two sources, of which the first has one of the other's, too.
#[test]
fn a_bearing_goes_to_the_source_that_explains_it_better() {
    const PLACES: [[f32; 2]; 2] = [[900.0, 900.0], [2300.0, 500.0]];
    let mut sources = Three::EMPTY;
    let mut rng = generator(3);
    for place in 0..2 {
        let sights = bearings((0..50).map(corner), &PLACES, |_, _| Some(place), 3);
        for sight in &sights {
            sources.tracks[place]
                .push(sight, &STRAIGHT, &mut rng)
                .unwrap();
        }
        sources.slots[place].identity = Some(place as u16);
        sources.slots[place].of = 101.0;
        sources.slots[place].heard = 50.0;
    }
    let [x, y] = PLACES[1];
    let wrong = observe(1000, [0.0, 0.0], y.atan2(x));
    sources.tracks[0].push(&wrong, &STRAIGHT, &mut rng).unwrap();
    sources.slots[0].heard += 1.0;
    let config = Config::new(STRAIGHT);
    let beliefs = One::beliefs(&STRAIGHT);
    let held = |sources: &Three| {
        let has = |track: &One| track.entries().iter().any(|entry| entry.holds(&wrong));
        [0, 1].map(|place| has(&sources.tracks[place]))
    };
    assert_eq!(held(&sources), [true, false]);
    for _ in 0..10 {
        sources.revise(&config, &beliefs);
    }
    assert_eq!(held(&sources), [false, true]);
    assert_eq!(sources.slots[0].heard, 50.0);
    assert_eq!(sources.slots[1].heard, 51.0);
}
