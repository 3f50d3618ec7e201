//! Maps made by hand, good ones and bad ones; what comes from a survey is tested with the host's builder.

extern crate std;

use std::{vec, vec::Vec};

use proptest::prelude::*;

use super::*;
use crate::checksum::crc32;

/// A header of version 2: encoding, beacons, levels, columns, rows.
fn header([encoding, beacons, levels, columns, rows]: [u8; 5]) -> Vec<u8> {
    let mut bytes = b"FXRM\x02".to_vec();
    bytes.extend([encoding, beacons, levels, columns, 0, rows, 0]);
    for number in [10.0f32, -5.0, 0.5] {
        bytes.extend(number.to_le_bytes());
    }
    if encoding == 2 {
        bytes.extend([-100i8 as u8, 2]);
        bytes.extend((-2.3f32).to_le_bytes());
        bytes.extend(0.6f32.to_le_bytes());
    } else {
        bytes.extend(325u16.to_le_bytes());
        bytes.extend([0; 8]);
    }
    bytes.extend(1.5f32.to_le_bytes());
    bytes.extend(20_000u32.to_le_bytes());
    bytes.extend([16, 0b101]);
    bytes
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}

/// A whole map, its data from `byte`.
fn map(shape: [u8; 5], mut byte: impl FnMut() -> u8) -> Vec<u8> {
    let [encoding, beacons, levels, columns, rows] = shape.map(usize::from);
    let points = columns * rows;
    let of_beacon = if encoding == 2 {
        (levels + 1) * points.div_ceil(8) * 4
    } else {
        2 * points
    };
    let mut bytes = header(shape);
    let length = 6 * beacons + points.div_ceil(8) + beacons * of_beacon;
    bytes.extend((0..length).map(|_| byte()));
    sealed(bytes)
}

/// Three points, two beacons.
fn small() -> Vec<u8> {
    let mut bytes = header([1, 2, 0, 3, 1]);
    bytes.extend([7, 0, 0, 0, 255, -90i8 as u8]);
    bytes.extend([0xef, 0xbe, 0xad, 0xde, 51, -95i8 as u8]);
    bytes.push(0b101);
    // Sigmas in quarters of a dB, means in halves of one above -128 dBm.
    bytes.extend([8, 100, 0, 120, 12, 130]);
    bytes.extend([4, 80, 63, 81, 1, 0]);
    sealed(bytes)
}

#[test]
fn a_map_reads_as_it_was_written() {
    let bytes = small();
    let map = RadioMap::new(&bytes).unwrap();
    assert_eq!(map.encoding(), Encoding::Moments);
    assert_eq!(
        *map.lattice(),
        Lattice::new([10.0, -5.0], 0.5, 3, 1).unwrap()
    );
    assert_eq!((map.error_length_m(), map.noise_db()), (1.5, 4.0));
    assert_eq!(map.rest_error_m(), 3.25);
    assert_eq!((map.surveyed_on(), map.by_hand()), (Some(20_000), 0b101));
    assert_eq!(map.beacons(), 2);
    let beacon = map.beacon(1).unwrap();
    assert_eq!(beacon.identifier, 0xdead_beef);
    assert!((beacon.detection - 0.2).abs() < 1e-6);
    assert_eq!(beacon.sensitivity_dbm, -95.0);
    assert_eq!(map.beacon(2), None);
    assert_eq!(
        [0, 1, 2, 3].map(|point| map.is_possible(point)),
        [true, false, true, false]
    );
    let moments = |mean_dbm, sigma_db| Some(Moments { mean_dbm, sigma_db });
    assert_eq!(map.moments(0, 0), moments(-78.0, 2.0));
    assert_eq!(map.moments(0, 1), None);
    assert_eq!(map.moments(1, 1), moments(-87.5, 15.75));
    assert_eq!(map.moments(1, 2), moments(-128.0, 0.25));
    assert_eq!(map.log_density(0, -50.0, 0), None);
}

#[test]
fn a_table_reads_as_it_was_written() {
    // One beacon, two levels and its absence, ten points in rows of eight bytes.
    let mut bytes = header([2, 1, 2, 10, 1]);
    bytes.extend([1, 0, 0, 0, 255, 0]);
    bytes.extend([0xff, 0x03]);
    for row in 0..3u8 {
        bytes.extend([0x40, 0x51, 0x62, 0x73, 8 + row, 9, 0, 0]);
    }
    let bytes = sealed(bytes);
    let map = RadioMap::new(&bytes).unwrap();
    // Those bytes are the levels.
    assert_eq!(map.rest_error_m(), 0.0);
    for (point, code) in [0, 1, 2, 3, 4, 5, 6, 7, 9, 9].into_iter().enumerate() {
        let exact = -2.3 - 0.6 * code as f32;
        assert_eq!(map.log_density(0, -98.9, point), Some(exact), "{point}");
    }
    // Levels are -100 and -98 dBm; what is beyond them counts as the last one.
    for (rssi, code) in [
        (-200.0, 8.0),
        (-99.1, 8.0),
        (-98.9, 9.0),
        (0.0, 9.0),
        (f32::NAN, 8.0),
    ] {
        assert_eq!(
            map.log_density(0, rssi, 8),
            Some(-2.3 - 0.6 * code),
            "{rssi}"
        );
    }
    assert_eq!(map.log_density(0, -98.0, 10), None);
    assert_eq!(map.log_density(1, -98.0, 0), None);
}

#[test]
fn every_flipped_bit_and_every_lost_byte_is_found() {
    let bytes = small();
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(RadioMap::new(&flipped).is_err(), "bit {bit}");
    }
    for length in 0..bytes.len() {
        let error = match length {
            0..4 => MapError::Magic,
            _ => MapError::Length,
        };
        let refused = RadioMap::new(&bytes[..length]).err();
        assert_eq!(refused, Some(error), "length {length}");
    }
    let junk = RadioMap::new(b"a text");
    assert_eq!(junk.err(), Some(MapError::Magic));
    let mut longer = bytes.clone();
    longer.push(0);
    assert_eq!(RadioMap::new(&longer).err(), Some(MapError::Length));
}

#[test]
fn what_is_wrong_is_named() {
    let refusal = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = small();
        bytes.truncate(bytes.len() - 4);
        change(&mut bytes);
        RadioMap::new(&sealed(bytes)).err()
    };
    assert_eq!(refusal(&|_| ()), None);
    assert_eq!(refusal(&|b| b[0] = b'f'), Some(MapError::Magic));
    assert_eq!(refusal(&|b| b[4] = 1), Some(MapError::Version));
    assert_eq!(refusal(&|b| b[5] = 3), Some(MapError::Encoding));
    assert_eq!(refusal(&|b| b[6] = 3), Some(MapError::Length));
    assert_eq!(refusal(&|b| b[8] = 4), Some(MapError::Length));
    assert_eq!(refusal(&|b| b[7] = 2), None);
    assert_eq!(refusal(&|b| b[23] |= 0x80), Some(MapError::Lattice));
    assert_eq!(refusal(&|b| b[12..16].fill(0xff)), Some(MapError::Lattice));
    assert_eq!(refusal(&|b| b[37] |= 0x80), Some(MapError::ErrorLength));
    assert_eq!(
        refusal(&|b| b[34..38].fill(0xff)),
        Some(MapError::ErrorLength)
    );
    assert_eq!(refusal(&|b| b[8..12].fill(0xff)), Some(MapError::Lattice));
    let mut flipped = small();
    flipped[50] ^= 1;
    assert_eq!(RadioMap::new(&flipped).err(), Some(MapError::Checksum));
    let none = map([1, 0, 0, 3, 1], || 0);
    assert_eq!(RadioMap::new(&none).err(), Some(MapError::Beacons));
    let mut levels = header([2, 1, 2, 3, 1]);
    levels[25] = 0;
    levels.resize(44 + 6 + 1 + 12, 0);
    assert_eq!(RadioMap::new(&sealed(levels)).err(), Some(MapError::Levels));
    assert_eq!(
        RadioMap::new(&map([2, 1, 1, 3, 1], || 0)).err(),
        Some(MapError::Levels)
    );
}

/// The mean and the covariance are those of the weights, computed from places in metres.
fn assert_summarised<const P: usize>(map: &RadioMap<'_>, found: &Match, posterior: &Posterior<P>) {
    let weights = posterior.weights().iter().copied().map(f64::from);
    let places = (0..).map(|point| map.lattice().position(point).map(f64::from));
    let places: Vec<_> = weights.zip(places).collect();
    let over = |of: &dyn Fn([f64; 2]) -> f64| {
        let products = places.iter().map(|(weight, place)| weight * of(*place));
        products.sum::<f64>()
    };
    assert_close(over(&|_| 1.0) as f32, 1.0, 1e-4);
    let mean = [over(&|[x, _]| x), over(&|[_, y]| y)];
    let covariance = posterior.covariance(map.lattice()).rows();
    for a in 0..2 {
        assert_close(found.mean[a], mean[a], 1e-3);
        for b in 0..2 {
            let moment = over(&|place| (place[a] - mean[a]) * (place[b] - mean[b]));
            assert_close(covariance[a][b], moment, 1e-3);
        }
    }
}

/// The scan is as likely at the points as the densities of the map say.
fn assert_likely(
    map: &RadioMap<'_>,
    found: &Match,
    scan: &[Reading],
    (config, weights): (&Config, &[f32]),
) {
    let accepted = scan
        .iter()
        .filter(|reading| config.accepts(reading.rssi_dbm));
    let accepted: Vec<_> = accepted.take(MAX_READINGS).collect();
    let at = |point: usize| {
        let density =
            |reading: &&Reading| map.log_density(reading.beacon.into(), reading.rssi_dbm, point);
        f64::from(accepted.iter().filter_map(density).sum::<f32>())
    };
    assert_close(found.log_likelihood, at(found.point), 1e-3);
    let points = (0..map.lattice().points()).filter(|point| map.is_possible(*point));
    for point in points {
        let expected = f64::from(config.tempering) * (at(point) - at(found.point));
        assert!(expected < 1e-3, "{point} {found:?}");
        let ratio = weights[point] / weights[found.point];
        assert_close(ratio, expected.exp(), 1e-3);
    }
}

/// Asks a map everything.
fn exercise(bytes: &[u8], scan: &[Reading], x: f32, y: f32) {
    let Ok(map) = RadioMap::new(bytes) else {
        return;
    };
    let points = map.lattice().points();
    for beacon in 0..map.beacons() + 2 {
        for point in [0, 1, points - 1, points, usize::MAX] {
            _ = (map.moments(beacon, point), map.is_possible(point));
            let log_density = map.log_density(beacon, x, point);
            assert!(log_density.is_none_or(f32::is_finite));
        }
        _ = map
            .beacon(beacon)
            .map(|beacon| map.beacon_index(beacon.identifier));
    }
    let mut posterior = Posterior::<300>::EMPTY;
    for missing_beacons_count in [false, true] {
        let config = Config {
            missing_beacons_count,
            ..Config::DEFAULT
        };
        let matcher = Matcher::new(map, &config).unwrap();
        if let Ok(found) = matcher.locate(scan, &mut posterior) {
            assert!(found.point < points && map.is_possible(found.point));
            assert_eq!(found.position, map.lattice().position(found.point));
            assert_summarised(&map, &found, &posterior);
            if map.encoding() == Encoding::Levels && !missing_beacons_count {
                assert_likely(&map, &found, scan, (&config, posterior.weights()));
            }
        }
    }
    assert!(map.lattice().nearest([x, y]) < points);
}

#[test]
fn bits_beyond_the_last_point_are_no_survey() {
    let mut bytes = header([1, 1, 0, 3, 1]);
    bytes.extend([7, 0, 0, 0, 255, -90i8 as u8]);
    bytes.push(0b1111_1000);
    bytes.extend([8, 100, 8, 120, 12, 130]);
    let bytes = sealed(bytes);
    let map = RadioMap::new(&bytes).unwrap();
    let scan = [Reading {
        beacon: 0,
        rssi_dbm: -60.0,
    }];
    let mut posterior = Posterior::<3>::EMPTY;
    let config = Config::DEFAULT;
    let matcher = Matcher::new(map, &config).unwrap();
    let found = matcher.locate(&scan, &mut posterior);
    assert_eq!(found, Err(ReadingError::Survey));
}

fn scans() -> impl Strategy<Value = Vec<Reading>> {
    let reading = (0u8..8, prop_oneof![-130.0f32..10.0, any::<f32>()])
        .prop_map(|(beacon, rssi_dbm)| Reading { beacon, rssi_dbm });
    prop::collection::vec(reading, 0..10)
}

proptest! {
    #[test]
    fn any_bytes_are_a_map_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        scan in scans(),
    ) {
        exercise(&bytes, &scan, 0.0, 0.0);
        // With a good beginning and a good end.
        let mut header = header([bytes.len() as u8 % 3, 2, 3, 2, 2]);
        header.extend(&bytes);
        exercise(&sealed(header), &scan, 0.0, 0.0);
    }

    #[test]
    fn any_data_is_read(
        encoding in 1u8..3,
        (beacons, levels) in (1u8..8, 2u8..6),
        (columns, rows) in (1u8..18, 1u8..18),
        seed in any::<u32>(),
        scan in scans(),
        (x, y) in (any::<f32>(), any::<f32>()),
    ) {
        let mut state = seed | 1;
        let levels = if encoding == 2 { levels } else { 0 };
        let bytes = map([encoding, beacons, levels, columns, rows], || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            (state >> 8) as u8
        });
        prop_assert!(RadioMap::new(&bytes).is_ok() || columns * rows == 1);
        exercise(&bytes, &scan, x, y);
    }

    #[test]
    fn damage_is_found(at in 0usize..67, change in 1u8..=255) {
        let mut bytes = small();
        let at = at % bytes.len();
        bytes[at] ^= change;
        prop_assert!(RadioMap::new(&bytes).is_err());
    }
}

#[test]
fn a_wrong_field_of_a_configuration_is_named() {
    let wrong = |change: &dyn Fn(&mut Config)| {
        let mut config = Config::DEFAULT;
        change(&mut config);
        config.check().unwrap_err().field()
    };
    for bad in [1.4, 21.0, f32::NAN] {
        assert_eq!(wrong(&|c| c.inflation_sigma_db = bad), "inflation_sigma_db");
    }
    for bad in [0.0, 0.2, f32::NAN] {
        assert_eq!(wrong(&|c| c.outlier_rate = bad), "outlier_rate");
    }
    for bad in [0.0, 1.1, f32::NAN] {
        assert_eq!(wrong(&|c| c.tempering = bad), "tempering");
    }
    let ranges = [[-129.0, 0.0], [-100.0, 21.0], [-50.0, -45.0], [f32::NAN; 2]];
    for bad in ranges {
        assert_eq!(wrong(&|c| c.range_dbm = bad), "range_dbm");
    }
    let config = Config::DEFAULT;
    assert_eq!(config.check(), Ok(()));
    assert!(config.accepts(-120.0) && config.accepts(0.0));
    assert!(!config.accepts(0.1) && !config.accepts(f32::NAN));
}

/// A map of one beacon: all sigmas by all means at 64 x 4 points.
fn all_moments() -> Vec<u8> {
    let mut bytes = header([1, 1, 0, 64, 4]);
    bytes.extend([1, 0, 0, 0, 0, 0]);
    bytes.extend([0xff; 32]);
    for next in 0..256 {
        bytes.extend([(next % 64) as u8, (64 * (next / 64) + 13) as u8]);
    }
    sealed(bytes)
}

#[test]
fn costs_are_those_of_the_mixture_for_all_configurations() {
    let bytes = all_moments();
    let map = RadioMap::new(&bytes).unwrap();
    let mut posterior = Posterior::<256>::EMPTY;
    for (inflation, outliers, range) in [
        (1.5, 0.1, [-60.0, -50.0]),
        (1.5, 1e-6, [-128.0, 20.0]),
        (4.0, 1e-3, [-120.0, 0.0]),
        (20.0, 0.1, [-128.0, 20.0]),
        (20.0, 1e-6, [-60.0, -50.0]),
    ] {
        let config = Config {
            inflation_sigma_db: inflation,
            outlier_rate: outliers,
            tempering: 1.0,
            range_dbm: range,
            ..Config::DEFAULT
        };
        let matcher = Matcher::new(map, &config).unwrap();
        let floor = f64::from(outliers / (range[1] - range[0])).ln();
        for rssi in -128..=20 {
            let rssi_dbm = rssi as f32;
            if !config.accepts(rssi_dbm) {
                continue;
            }
            let exact: Vec<f64> = (0..256)
                .map(|point| match map.moments(0, point) {
                    None => floor,
                    Some(moments) => {
                        let sigma = f64::from(moments.sigma_db).hypot(f64::from(inflation));
                        let z = f64::from(rssi_dbm - moments.mean_dbm) / sigma;
                        let peak = f64::from(1.0 - outliers).ln()
                            - (sigma * core::f64::consts::TAU.sqrt()).ln();
                        (peak - 0.5 * z * z).max(floor)
                    }
                })
                .collect();
            let scan = vec![Reading {
                beacon: 0,
                rssi_dbm,
            }];
            let found = matcher.locate(&scan, &mut posterior).unwrap();
            let best = exact.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // A 255th of the largest loss; and the smallest slope, of about 40, is rounded to a whole number.
            let step =
                (f64::from(config.inlier_rate().ln()) - (f64::from(inflation) * 2.5).ln() - floor)
                    / 255.0;
            let tolerance = 0.6 * step + 0.0125 * best.abs();
            assert_close(found.log_likelihood, best, tolerance);
            for (point, (weight, of_point)) in posterior.weights().iter().zip(&exact).enumerate() {
                let ratio = f64::from(weight / posterior.weights()[found.point]).ln();
                let expected = of_point - exact[found.point];
                assert!(
                    (ratio - expected).abs() < 2.0 * tolerance + 0.0125 * expected.abs(),
                    "{inflation} {outliers} {rssi} {point} {found:?} {step}: {ratio} {expected}"
                );
            }
        }
    }
}

fn assert_close(got: f32, exact: f64, tolerance: f64) {
    assert!(
        (f64::from(got) - exact).abs() < tolerance,
        "{got} {exact} {tolerance}"
    );
}
