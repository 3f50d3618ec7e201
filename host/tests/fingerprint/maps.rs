//! Radio maps of a survey.

use std::{fs, path::PathBuf};

use foxhunt::fingerprint::{Encoding, MapError, RadioMap};
use foxhunt_host::radio_map::{Reading, Recipe, Shape, SiteSurvey, rust_constant};

use crate::site::*;

#[test]
fn maps_take_as_many_bytes_as_promised() {
    assert!(tunnel(Encoding::Moments).len() <= 1024);
    assert!(tunnel(Encoding::Levels).len() <= 5427);
    assert_eq!(
        RadioMap::new(&tunnel(Encoding::Levels))
            .unwrap()
            .lattice()
            .points(),
        80
    );
}

/// The maps of the portable tests and of the firmware. With `BLESS` in the environment they are rewritten.
#[test]
fn the_stored_maps_are_those_of_the_builder() {
    let directory = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/portable/data");
    for (name, bytes) in [
        ("tunnel.moments", tunnel(Encoding::Moments)),
        ("tunnel.levels", tunnel(Encoding::Levels)),
        ("hall.moments", hall_map()),
    ] {
        let file = directory.join(name);
        if std::env::var_os("BLESS").is_some() {
            fs::write(&file, &bytes).unwrap();
        }
        assert!(fs::read(&file).unwrap() == bytes, "{name} is another map");
    }
}

#[test]
fn a_map_holds_what_was_surveyed() {
    let bytes = tunnel(Encoding::Moments);
    let map = RadioMap::new(&bytes).unwrap();
    assert_eq!((map.beacons(), map.lattice().points()), (4, 80));
    assert_eq!(map.lattice().position(79), [79.0, 1.75]);
    assert_eq!(map.beacon_index(103), Some(3));
    assert_eq!(map.beacon_index(104), None);
    assert_eq!(map.beacon(2).unwrap().detection, 1.0);
    for beacon in 0..BEACONS {
        for (point, place) in line().into_iter().enumerate() {
            let values: Vec<f64> = (0..EACH)
                .map(|i| f64::from(sample(beacon, place, i)))
                .collect();
            let mean = values.iter().sum::<f64>() / EACH as f64;
            let moments = map.moments(beacon, point).unwrap();
            // Neighbours have a say, and noise of 3 dB in 16 readings.
            assert!((f64::from(moments.mean_dbm) - mean).abs() <= 2.0);
            assert!(moments.sigma_db < 2.0);
        }
    }
    assert!((f64::from(map.noise_db()) - 2.8).abs() < 1.5);
    assert!(map.error_length_m() > 0.0 && map.by_hand() == 1);
    assert!(map.moments(4, 0).is_none() && map.moments(0, 80).is_none());
    assert!(map.moments(usize::MAX, usize::MAX).is_none());
    assert_eq!(map.log_density(0, -50.0, 0), None);
    assert_eq!(map.limited(80, 3).err(), Some(MapError::Beacons));
    assert_eq!(map.limited(79, 4).err(), Some(MapError::Points));
    assert!(map.limited(80, 4).is_ok());
}

#[test]
fn the_table_is_the_kernel_density_to_half_a_step() {
    let bytes = tunnel(Encoding::Levels);
    let map = RadioMap::new(&bytes).unwrap();
    // From the largest density of a kernel of 4 dB to that of an outlier, in 15 steps.
    let (top, floor) = (
        log_mixture(normal_density(0.0, 4.0)),
        (1e-3f64 / 120.0).ln(),
    );
    let half = 0.5 * (top - floor) / 15.0;
    let lowest = samples().into_iter().map(f64::from).fold(0.0, f64::min) - 4.0;
    let mut worst: f64 = 0.0;
    for beacon in 0..BEACONS {
        for point in 0..POINTS {
            for level in 0..30 {
                let rssi = lowest + 2.0 * f64::from(level);
                let got = map.log_density(beacon, rssi as f32, point).unwrap();
                worst = worst.max((f64::from(got) - log_density(beacon, point, rssi, 4.0)).abs());
            }
        }
    }
    assert!(worst <= half + 1e-4 && worst > 0.9 * half, "{worst} {half}");
    assert_eq!(map.log_density(0, -50.0, 80), None);
    assert_eq!(map.moments(0, 0), None);
}

#[test]
fn between_the_places_of_a_survey_the_field_is_smooth() {
    // Every other metre surveyed, every metre in the map.
    let survey = survey(&line().into_iter().step_by(2).collect::<Vec<_>>());
    let bytes = map(&survey, 1.0, Encoding::Moments);
    let sparse = RadioMap::new(&bytes).unwrap();
    let dense = tunnel(Encoding::Moments);
    let dense = RadioMap::new(&dense).unwrap();
    let mut squares = 0.0;
    for beacon in 0..BEACONS {
        for point in 0..79 {
            let (got, truth) = (
                sparse.moments(beacon, point).unwrap(),
                dense.moments(beacon, point).unwrap(),
            );
            squares += (got.mean_dbm - truth.mean_dbm).powi(2) / 316.0;
        }
    }
    assert!(squares.sqrt() < 1.2, "{}", squares.sqrt());
}

#[test]
fn recipes_that_make_no_sense_are_refused() {
    let survey = survey(&line());
    type Change = fn(&mut Recipe);
    let changes: [(Change, &str); 9] = [
        (|r| r.bandwidth_db = 0.0, "bandwidth"),
        (|r| r.bandwidth_db = f64::NAN, "bandwidth"),
        (|r| r.outliers = 0.0, "outliers"),
        (|r| r.levels = 1, "levels"),
        (|r| r.reach_m = Some(f64::NAN), "reach"),
        (|r| r.cell_m = Some(-1.0), "cell"),
        (|r| r.sigma_db = Some(16.0), "sigma"),
        (|r| r.length_m = Some(f64::INFINITY), "length"),
        (|r| r.spacing_m = Some(0.0), "spacing"),
    ];
    for (change, name) in changes {
        let mut recipe = Recipe::default();
        change(&mut recipe);
        let error = survey.map(&recipe, &mut |_| ()).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
    let none = SiteSurvey::new([]);
    assert!(none.lattice(1.0).is_err());
    let error = none.map(&Recipe::default(), &mut |_| ()).unwrap_err();
    assert!(error.to_string().contains("0 beacons"), "{error}");
}

#[test]
fn what_was_stated_is_in_the_header() {
    let survey = survey(&line());
    let recipe = Recipe {
        sigma_db: Some(3.0),
        length_m: Some(4.0),
        packet_sigma_db: Some(5.0),
        days: Some(20_000),
        ..Recipe::default()
    };
    let mut done = 0.0;
    let mut progress = |fraction: f64| {
        assert!(fraction >= done && fraction <= 1.0);
        done = fraction;
    };
    let made = survey.map(&recipe, &mut progress).unwrap();
    assert_eq!(done, 1.0);
    let map = RadioMap::new(&made.bytes).unwrap();
    assert_eq!((map.error_length_m(), map.noise_db()), (4.0, 5.0));
    assert_eq!((map.surveyed_on(), map.by_hand()), (Some(20_000), 0b111000));
    let sigma = map.moments(0, 0).unwrap().sigma_db;
    assert!((3.0..4.0).contains(&sigma), "{sigma}");
    assert_eq!(made.expected.by_point_m.len(), map.lattice().points());
    let rest = made.expected.rest_m;
    assert!(
        (f64::from(map.rest_error_m()) - rest).abs() < 0.006,
        "{rest}"
    );
}

/// Levels that rise evenly along a line: places err as a mean of all beacons does.
#[test]
fn what_a_tag_at_rest_is_off_by_is_that_of_the_errors_of_the_map() {
    const DB_PER_M: f64 = 0.5;
    const SIGMA_DB: f64 = 4.0;
    for beacons in [2, 8] {
        let readings = (0..200).flat_map(|point| {
            (0..beacons).map(move |beacon| {
                let rise = if beacon % 2 == 0 { DB_PER_M } else { -DB_PER_M };
                let x = f64::from(point);
                Reading {
                    x,
                    y: 0.0,
                    beacon,
                    rssi: -70.0 + rise * (x - 100.0),
                }
            })
        });
        let recipe = Recipe {
            spacing_m: Some(1.0),
            cell_m: Some(0.0),
            shape: Some(Shape {
                length_m: 40.0,
                noise: 1e-3,
            }),
            sigma_db: Some(SIGMA_DB),
            ..Recipe::default()
        };
        let made = SiteSurvey::new(readings).map(&recipe, &mut |_| ()).unwrap();
        let expected = SIGMA_DB / DB_PER_M / f64::from(beacons).sqrt();
        let rest = made.expected.rest_m;
        // At the ends of the line a tag is known better.
        assert!(
            (0.85..1.02).contains(&(rest / expected)),
            "{rest} {expected}"
        );
    }
}

#[test]
fn the_constant_is_the_map() {
    let bytes = tunnel(Encoding::Moments);
    let text = rust_constant("TUNNEL", &bytes);
    assert!(text.contains(&format!("pub const TUNNEL: [u8; {}] = [", bytes.len())));
    let (_, numbers) = text.split_once("= [").unwrap();
    let numbers = numbers
        .split([',', '\n', ' ', ']', ';'])
        .filter(|word| !word.is_empty());
    let parsed: Vec<u8> = numbers
        .map(|word| u8::from_str_radix(word.trim_start_matches("0x"), 16).unwrap())
        .collect();
    assert_eq!(parsed, bytes);
}

/// The compiler can check a map.
const _: RadioMap<'static> = match RadioMap::new(include_bytes!(
    "../../../tests/portable/data/tunnel.moments"
)) {
    Ok(map) => map,
    Err(_) => panic!("damaged"),
};
