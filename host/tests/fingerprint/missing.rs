//! Beacons that are not heard, and points that nobody surveyed.

use foxhunt::fingerprint::{
    Config, Encoding, Match, Matcher, Posterior, RadioMap, Reading, ReadingError,
};
use foxhunt_host::radio_map::{self, Options, SiteSurvey};

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
    let lattice = survey.lattice(1.0).unwrap();
    [Encoding::Moments, Encoding::Levels].map(|encoding| {
        survey
            .radio_map(&lattice, encoding, &Options::default())
            .unwrap()
    })
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
fn points_far_from_the_survey_are_left_out() {
    let gap: Vec<[f64; 2]> = line()
        .into_iter()
        .filter(|[x, _]| !(30.0..50.0).contains(x))
        .collect();
    let survey = survey(&gap);
    let lattice = survey.lattice(1.0).unwrap();
    for encoding in [Encoding::Moments, Encoding::Levels] {
        let bytes = survey
            .radio_map(&lattice, encoding, &Options::default())
            .unwrap();
        let map = RadioMap::new(&bytes).unwrap();
        let surveyed: Vec<bool> = (0..80).map(|point| map.is_surveyed(point)).collect();
        assert!(surveyed[30] && surveyed[49] && !surveyed[31..49].contains(&true));
        assert!(!map.is_surveyed(80) && !map.is_surveyed(usize::MAX));
        let mut posterior = Posterior::<80>::EMPTY;
        let scan = scan([40.0, 1.75]);
        let matcher = Matcher::new(map, &UNTEMPERED).unwrap();
        matcher.locate(&scan, &mut posterior).unwrap();
        assert!(posterior.weights()[31..49].iter().all(|w| *w == 0.0));
        assert!((posterior.weights().iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}
