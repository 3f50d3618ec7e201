//! Beacons that are not heard, and points that nobody surveyed.

use foxhunt::fingerprint::{
    Config, Encoding, Match, Matcher, Posterior, RadioMap, Reading, ReadingError,
};
use foxhunt_host::radio_map::{self, Recipe, SiteSurvey};

use crate::site::*;

/// Both maps of a survey in which beacon 7 is heard in the left half only, beacons 5 and 9 are heard everywhere.
fn half_heard() -> [Vec<u8>; 2] {
    let mut readings = vec![];
    for x in 0..20 {
        for noise in [-1.0, 1.0] {
            let mut heard = |beacon, rssi| {
                let x = f64::from(x);
                readings.push(radio_map::Reading {
                    x,
                    y: 0.0,
                    beacon,
                    rssi,
                });
            };
            heard(5, -60.0 + noise);
            if x < 10 {
                heard(7, -55.0 + noise);
            }
            heard(9, -90.0 + noise);
        }
    }
    let survey = SiteSurvey::new(readings);
    [Encoding::Moments, Encoding::Levels].map(|encoding| map(&survey, 1.0, encoding))
}

/// The weight of the left half, by each of the matchers.
fn left(maps: &[Vec<u8>; 2], config: &Config, scan: &[Reading]) -> [f32; 2] {
    let [moments, levels] = maps.each_ref().map(|map| RadioMap::new(map).unwrap());
    let mut posterior = Posterior::<20>::EMPTY;
    let mut left = |matcher: &dyn Fn(&mut Posterior<20>) -> Result<Match, ReadingError>| {
        matcher(&mut posterior).unwrap();
        posterior.weights()[..10].iter().sum()
    };
    let gaussian = Matcher::new(moments, config).unwrap();
    let table = Matcher::new(levels, config).unwrap();
    [
        left(&|posterior| gaussian.locate(scan, posterior)),
        left(&|posterior| table.locate(scan, posterior)),
    ]
}

#[test]
fn a_missing_beacon_says_something_only_if_asked() {
    let maps = half_heard();
    let moments = RadioMap::new(&maps[0]).unwrap();
    assert!(moments.moments(1, 3).is_some() && moments.moments(1, 13).is_none());
    let reading = |beacon, rssi_dbm| Reading { beacon, rssi_dbm };
    let scan = [reading(0, -60.0)];
    for (missing_beacons_count, expected) in [(false, 0.45..0.55), (true, 0.0..0.02)] {
        let config = Config {
            missing_beacons_count,
            ..UNTEMPERED
        };
        let left = left(&maps, &config, &scan);
        assert!(left.iter().all(|left| expected.contains(left)), "{left:?}");
    }
    // Where it is heard, nothing points to the half where it is not.
    let scan = [scan[0], reading(1, -55.0)];
    let left = left(&maps, &UNTEMPERED, &scan);
    assert!(left.iter().all(|left| *left > 0.99), "{left:?}");
}

#[test]
fn where_nobody_has_been_a_map_is_uncertain_and_not_impossible() {
    let gap: Vec<[f64; 2]> = line()
        .into_iter()
        .filter(|[x, _]| !(30.0..50.0).contains(x))
        .collect();
    let survey = survey(&gap);
    let bytes = map(&survey, 1.0, Encoding::Moments);
    let free = RadioMap::new(&bytes).unwrap();
    assert!((0..80).all(|point| free.is_possible(point)));
    for beacon in 0..BEACONS {
        let [known, near, far] = [20, 31, 40].map(|point| free.moments(beacon, point).unwrap());
        assert!(known.sigma_db < near.sigma_db && near.sigma_db < far.sigma_db);
    }
    let recipe = Recipe {
        spacing_m: Some(1.0),
        reach_m: Some(1.5),
        ..Recipe::default()
    };
    let bytes = survey.map(&recipe, &mut |_| ()).unwrap().bytes;
    let walled = RadioMap::new(&bytes).unwrap();
    let possible: Vec<bool> = (0..80).map(|point| walled.is_possible(point)).collect();
    assert!(possible[30] && possible[49] && !possible[31..49].contains(&true));
    assert!(!walled.is_possible(80) && !walled.is_possible(usize::MAX));
    let scan = scan([40.0, 1.75]);
    for (map, is_free) in [(free, true), (walled, false)] {
        let mut posterior = Posterior::<80>::EMPTY;
        let matcher = Matcher::new(map, &UNTEMPERED).unwrap();
        matcher.locate(&scan, &mut posterior).unwrap();
        let inside: f32 = posterior.weights()[31..49].iter().sum();
        assert_eq!(inside > 0.0, is_free, "{inside}");
        assert!((posterior.weights().iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}
