//! Radio maps and matching, from the survey to the posterior, held against the same in f64.

use std::{fs, path::PathBuf};

use foxhunt::{
    fingerprint::{
        Encoding, GaussianMatcher, KernelDensity, Lattice, MapError, Match, MatchError, Matcher,
        Missing, Neighbours, Packet, PacketError, PacketModel, Posterior, RadioMap, Reading,
        Samples, Settings, TableMatcher,
    },
    model::Likelihood,
};
use foxhunt_host::radio_map::{self, Options, SiteSurvey, rust_constant};

const POINTS: usize = 80;
const BEACONS: usize = 4;
const EACH: usize = 16;
const PLACES: [[f64; 2]; BEACONS] = [[10.0, 0.0], [30.0, 3.5], [50.0, 0.0], [70.0, 3.5]];

/// A sample of a beacon at a place, in whole dBm: path loss, something that stays, something that does not.
fn sample(beacon: usize, [x, y]: [f64; 2], number: usize) -> i8 {
    let [bx, by] = PLACES[beacon];
    let squared = (x - bx).powi(2) + (y - by).powi(2) + 1.0;
    let b = beacon as f64;
    let shadow = 3.0 * (0.37 * x + 1.3 * b).sin() + 2.0 * (0.9 * x + 0.5 * y - b).sin();
    let noise = 4.0 * (2.1 * number as f64 + 5.3 * x + 3.1 * y + 1.7 * b).sin();
    (-40.0 - 10.0 * squared.log10() + shadow + noise).round() as i8
}

fn survey(places: &[[f64; 2]]) -> SiteSurvey {
    SiteSurvey::new(places.iter().flat_map(|&[x, y]| {
        (0..BEACONS * EACH).map(move |i| radio_map::Reading {
            x,
            y,
            beacon: 100 + (i / EACH) as u32,
            rssi: f64::from(sample(i / EACH, [x, y], i % EACH)),
        })
    }))
}

fn line() -> Vec<[f64; 2]> {
    (0..POINTS).map(|i| [i as f64, 1.75]).collect()
}

/// A hall of 16 by 8 points, 2 m apart.
fn hall() -> Vec<[f64; 2]> {
    (0..128)
        .map(|i| [f64::from(i % 16) * 5.0, f64::from(i / 16) * 2.0])
        .collect()
}

fn tunnel(encoding: Encoding) -> Vec<u8> {
    let survey = survey(&line());
    let lattice = survey.lattice(1.0).unwrap();
    survey
        .radio_map(&lattice, encoding, &Options::default())
        .unwrap()
}

fn hall_map() -> Vec<u8> {
    let survey = survey(&hall());
    let lattice = survey.lattice(2.5).unwrap();
    survey
        .radio_map(&lattice, Encoding::Moments, &Options::default())
        .unwrap()
}

fn scan(position: [f64; 2]) -> [Reading; BEACONS] {
    std::array::from_fn(|beacon| Reading {
        beacon: beacon as u8,
        rssi_dbm: f32::from(sample(beacon, position, 99)),
    })
}

fn settings() -> Settings {
    Settings::new().with_tempering(1.0).unwrap()
}

fn log_mixture(density: f64) -> f64 {
    ((1.0 - 1e-3) * density + 1e-3 / 120.0).ln()
}

fn normal_density(distance: f64, deviation: f64) -> f64 {
    (-0.5 * (distance / deviation).powi(2)).exp() / (deviation * std::f64::consts::TAU.sqrt())
}

/// Kernel density in f64.
fn log_density(beacon: usize, point: usize, rssi: f64, bandwidth: f64) -> f64 {
    let samples = (0..EACH).map(|i| f64::from(sample(beacon, line()[point], i)));
    let sum: f64 = samples.map(|s| normal_density(rssi - s, bandwidth)).sum();
    log_mixture(sum / EACH as f64)
}

/// Posterior, mean and covariance along x in f64.
fn exact(log_likelihoods: &[f64]) -> (Vec<f64>, f64, f64) {
    let largest = log_likelihoods
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = log_likelihoods
        .iter()
        .map(|l| (l - largest).exp())
        .collect();
    let sum: f64 = weights.iter().sum();
    let weights: Vec<f64> = weights.iter().map(|w| w / sum).collect();
    let mean: f64 = weights.iter().enumerate().map(|(i, w)| w * i as f64).sum();
    let variance = weights
        .iter()
        .enumerate()
        .map(|(i, w)| w * (i as f64 - mean).powi(2));
    (weights.clone(), mean, variance.sum())
}

fn samples() -> Vec<i8> {
    let points = line().into_iter();
    points
        .flat_map(|place| (0..BEACONS * EACH).map(move |i| sample(i / EACH, place, i % EACH)))
        .collect()
}

fn places() -> impl Iterator<Item = [f64; 2]> {
    (0..60).map(|i| [1.31 * f64::from(i), 0.3 + 0.05 * f64::from(i)])
}

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
    let directory = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
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
            let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
            let deviation = (squares / (EACH - 1) as f64).sqrt();
            let moments = map.moments(beacon, point).unwrap();
            assert!((f64::from(moments.mean_dbm) - mean).abs() <= 0.2501);
            assert!((f64::from(moments.deviation_db) - deviation).abs() <= 0.1251);
        }
    }
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
fn kernel_densities_are_those_of_f64() {
    let samples = samples();
    let lattice = Lattice::new([0.0, 1.75], 1.0, 80, 1).unwrap();
    let samples = Samples::new(lattice, 4, &samples).unwrap();
    let matcher = KernelDensity::new(samples, 3.0, &settings()).unwrap();
    let mut posterior = Posterior::<POINTS>::new();
    for place in places() {
        let scan = scan(place);
        let found = matcher.locate(&scan, &mut posterior).unwrap();
        let log_likelihoods: Vec<f64> = (0..POINTS)
            .map(|point| {
                let of =
                    |r: &Reading| log_density(r.beacon.into(), point, f64::from(r.rssi_dbm), 3.0);
                scan.iter().map(of).sum()
            })
            .collect();
        let (weights, mean, variance) = exact(&log_likelihoods);
        for (got, exact) in posterior.weights().iter().zip(&weights) {
            assert!((f64::from(*got) - exact).abs() < 1e-4, "{got} {exact}");
        }
        assert!((f64::from(found.mean[0]) - mean).abs() < 1e-3);
        assert!(
            (f64::from(posterior.covariance(&lattice)[0][0]) - variance).abs()
                < 1e-3 * (1.0 + variance)
        );
        assert!((f64::from(found.log_likelihood) - log_likelihoods[found.point]).abs() < 1e-3);
    }
}

/// Posteriors of the table and of the Gaussian against f64 with what the map holds: only the steps of the costs differ.
#[test]
fn matchers_differ_from_f64_by_their_steps() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let gaussian = GaussianMatcher::new(moments, &settings()).unwrap();
    let table = TableMatcher::new(levels, &settings()).unwrap();
    let mut posterior = Posterior::<100>::new();
    let check = |found: Match, weights: &[f32], log_likelihoods: &[f64], step: f64| {
        let (exact, mean, _) = exact(log_likelihoods);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        assert_eq!(weights.len(), POINTS);
        for (got, exact) in weights.iter().zip(&exact) {
            let ratio = (f64::from(*got) / exact).ln().abs();
            assert!(
                *exact < 1e-6 || ratio < 2.0 * step * BEACONS as f64,
                "{got} {exact}"
            );
        }
        assert!(
            (f64::from(found.mean[0]) - mean).abs() < 20.0 * step,
            "{found:?} {mean}"
        );
        assert!(
            (f64::from(found.log_likelihood) - log_likelihoods[found.point]).abs() < 4.0 * step
        );
        let largest = weights.iter().copied().fold(0.0, f32::max);
        assert_eq!(weights[found.point], largest);
        assert_eq!(found.used, BEACONS);
    };
    for place in places() {
        let scan = scan(place);
        let of = |log_density: &dyn Fn(usize, f32, usize) -> f64| -> Vec<f64> {
            let sum = |point| {
                let readings = scan.iter();
                readings
                    .map(|r| log_density(r.beacon.into(), r.rssi_dbm, point))
                    .sum()
            };
            (0..POINTS).map(sum).collect()
        };
        let found = gaussian.locate(&scan, &mut posterior).unwrap();
        let log_likelihoods = of(&|beacon, rssi, point| {
            let m = moments.moments(beacon, point).unwrap();
            let deviation = f64::from(m.deviation_db).hypot(4.0);
            let density = normal_density(f64::from(rssi - m.mean_dbm), deviation);
            (0.999 * density).max(1e-3 / 120.0).ln()
        });
        check(found, posterior.weights(), &log_likelihoods, 0.037);
        let found = table.locate(&scan, &mut posterior).unwrap();
        let log_likelihoods =
            of(&|beacon, rssi, point| levels.log_density(beacon, rssi, point).unwrap().into());
        check(found, posterior.weights(), &log_likelihoods, 1e-4);
    }
}

#[test]
fn all_methods_find_the_place() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let samples = samples();
    let samples = Samples::new(*moments.lattice(), 4, &samples).unwrap();
    let settings = Settings::new();
    let mut posterior = Posterior::<POINTS>::new();
    let mut squares = [0.0; 4];
    for place in places() {
        let scan = scan(place);
        let found = [
            GaussianMatcher::new(moments, &settings)
                .unwrap()
                .locate(&scan, &mut posterior),
            TableMatcher::new(levels, &settings)
                .unwrap()
                .locate(&scan, &mut posterior),
            KernelDensity::new(samples, 4.0, &settings)
                .unwrap()
                .locate(&scan, &mut posterior),
            Neighbours::new(moments, 3, &settings)
                .unwrap()
                .locate(&scan, &mut posterior),
        ];
        for (sum, found) in squares.iter_mut().zip(found) {
            *sum += (f64::from(found.unwrap().mean[0]) - place[0]).powi(2) / 60.0;
        }
    }
    let rmse = squares.map(f64::sqrt);
    // A guess is 23 m off.
    assert!(rmse.iter().all(|e| *e < 6.0), "{rmse:?}");
    // The table has levels of 2 dB, and 15 steps.
    assert!((rmse[1] / rmse[2] - 1.0).abs() < 0.1, "{rmse:?}");
}

#[test]
fn neighbours_are_the_nearest_means() {
    let bytes = tunnel(Encoding::Moments);
    let map = RadioMap::new(&bytes).unwrap();
    let mut posterior = Posterior::<POINTS>::new();
    for place in places() {
        let scan = scan(place);
        let mut order: Vec<usize> = (0..POINTS).collect();
        let squares = |point: usize| -> f32 {
            let of = |r: &Reading| {
                (r.rssi_dbm - map.moments(r.beacon.into(), point).unwrap().mean_dbm).powi(2)
            };
            scan.iter().map(of).sum()
        };
        order.sort_by(|a, b| squares(*a).total_cmp(&squares(*b)));
        let found = Neighbours::new(map, 5, &settings())
            .unwrap()
            .locate(&scan, &mut posterior)
            .unwrap();
        assert_eq!(found.point, order[0]);
        assert_eq!(found.log_likelihood, -squares(order[0]));
        let mean = order[..5].iter().sum::<usize>() as f32 / 5.0;
        assert!((found.mean[0] - mean).abs() < 1e-4);
        assert_eq!(posterior.weights().iter().filter(|w| **w == 0.2).count(), 5);
    }
    assert!(Neighbours::new(map, 0, &settings()).is_err());
    assert!(Neighbours::new(map, 17, &settings()).is_err());
}

#[test]
fn scans_that_make_no_sense_are_refused_and_change_nothing() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    assert!(GaussianMatcher::new(levels, &settings()).is_err());
    assert!(TableMatcher::new(moments, &settings()).is_err());
    let gaussian = GaussianMatcher::new(moments, &settings()).unwrap();
    let table = TableMatcher::new(levels, &settings()).unwrap();
    let reading = |beacon, rssi_dbm| Reading { beacon, rssi_dbm };
    let mut posterior = Posterior::<POINTS>::new();
    assert!(posterior.weights().is_empty());
    let good = [reading(1, -60.0), reading(2, -70.0)];
    gaussian.locate(&good, &mut posterior).unwrap();
    let before = posterior.weights().to_vec();
    for (scan, error) in [
        (vec![], MatchError::Scan),
        (vec![reading(0, 42.0)], MatchError::Scan),
        (vec![reading(0, f32::NAN)], MatchError::Scan),
        (
            vec![reading(0, -60.0), reading(4, -60.0)],
            MatchError::Beacon,
        ),
    ] {
        assert_eq!(gaussian.locate(&scan, &mut posterior), Err(error));
        assert_eq!(table.locate(&scan, &mut posterior), Err(error));
        assert_eq!(posterior.weights(), before);
    }
    // What is out of range is left out.
    let gated = [
        good[0],
        reading(0, 42.0),
        good[1],
        reading(3, f32::NEG_INFINITY),
    ];
    let found = gaussian.locate(&gated, &mut posterior).unwrap();
    assert_eq!(found.used, 2);
    assert_eq!(posterior.weights(), before);
    let mut small = Posterior::<79>::new();
    assert_eq!(gaussian.locate(&good, &mut small), Err(MatchError::Points));
    assert_eq!(table.locate(&good, &mut small), Err(MatchError::Points));
    // More readings than any scan has.
    let many = vec![good[0]; 1000];
    assert_eq!(gaussian.locate(&many, &mut posterior).unwrap().used, 64);
    assert_eq!(table.locate(&many, &mut posterior).unwrap().used, 64);
}

#[test]
fn a_missing_beacon_says_something_only_if_asked() {
    // Beacon 7 is heard in the left half only; beacon 5 everywhere alike.
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
    let [moments, levels] = [Encoding::Moments, Encoding::Levels].map(|encoding| {
        survey
            .radio_map(&lattice, encoding, &Options::default())
            .unwrap()
    });
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    assert!(moments.moments(1, 3).is_some() && moments.moments(1, 13).is_none());
    let mut posterior = Posterior::<20>::new();
    let scan = [Reading {
        beacon: 0,
        rssi_dbm: -60.0,
    }];
    for (missing, left) in [
        (Missing::Ignored, 0.45..0.55),
        (Missing::Modelled, 0.0..0.02),
    ] {
        let settings = settings().with_missing(missing);
        let share = |posterior: &Posterior<20>| posterior.weights()[..10].iter().sum::<f32>();
        GaussianMatcher::new(moments, &settings)
            .unwrap()
            .locate(&scan, &mut posterior)
            .unwrap();
        assert!(
            left.contains(&share(&posterior)),
            "{missing:?} {}",
            share(&posterior)
        );
        TableMatcher::new(levels, &settings)
            .unwrap()
            .locate(&scan, &mut posterior)
            .unwrap();
        assert!(
            left.contains(&share(&posterior)),
            "{missing:?} {}",
            share(&posterior)
        );
    }
    // Where it is heard, nothing points to the half where it is not.
    let scan = [
        scan[0],
        Reading {
            beacon: 1,
            rssi_dbm: -55.0,
        },
    ];
    TableMatcher::new(levels, &settings())
        .unwrap()
        .locate(&scan, &mut posterior)
        .unwrap();
    assert!(posterior.weights()[..10].iter().sum::<f32>() > 0.99);
    GaussianMatcher::new(moments, &settings())
        .unwrap()
        .locate(&scan, &mut posterior)
        .unwrap();
    assert!(posterior.weights()[..10].iter().sum::<f32>() > 0.99);
}

/// Bilinear interpolation in f64.
fn interpolated(map: &RadioMap, beacon: usize, place: [f64; 2]) -> [f64; 2] {
    let lattice = map.lattice();
    let cell = |axis: usize, points: usize| {
        let u = (place[axis] - f64::from(lattice.origin()[axis])) / f64::from(lattice.spacing());
        let u = u.clamp(0.0, (points - 1) as f64);
        let before = (u as usize).min(points.saturating_sub(2));
        (before, u - before as f64)
    };
    let (column, right) = cell(0, lattice.columns());
    let (row, up) = cell(1, lattice.rows());
    let mut sums = [0.0; 2];
    for (dy, wy) in [(0, 1.0 - up), (1, up)] {
        for (dx, wx) in [(0, 1.0 - right), (1, right)] {
            if wx * wy > 0.0 {
                let point = (row + dy) * lattice.columns() + column + dx;
                let m = map.moments(beacon, point).unwrap();
                sums[0] += wx * wy * f64::from(m.mean_dbm);
                sums[1] += wx * wy * f64::from(m.deviation_db);
            }
        }
    }
    sums
}

#[test]
fn packets_weigh_particles_by_the_interpolated_map() {
    let settings = Settings::new();
    let model = PacketModel::new(&settings);
    let turned = {
        // The tunnel along y: one column.
        let survey = SiteSurvey::new(line().into_iter().flat_map(|[y, x]| {
            (0..BEACONS * EACH).map(move |i| radio_map::Reading {
                x,
                y,
                beacon: (i / EACH) as u32,
                rssi: f64::from(sample(i / EACH, [y, x], i % EACH)),
            })
        }));
        let lattice = survey.lattice(1.0).unwrap();
        survey
            .radio_map(&lattice, Encoding::Moments, &Options::default())
            .unwrap()
    };
    for bytes in [tunnel(Encoding::Moments), hall_map(), turned] {
        let map = RadioMap::new(&bytes).unwrap();
        let (mut x, mut y) = (vec![], vec![]);
        for i in 0..2000 {
            // All over the map, and beyond it.
            let [u, v] = [0.618_034, 0.754_878].map(|step: f64| (step * f64::from(i)).fract());
            let lattice = map.lattice();
            let reach = |n: usize| (n as f32 - 1.0) * lattice.spacing();
            let [x0, y0] = lattice.origin();
            x.push(x0 + (1.2 * u as f32 - 0.1) * reach(lattice.columns()));
            y.push(y0 + (1.2 * v as f32 - 0.1) * reach(lattice.rows()));
        }
        // The points themselves, too.
        for point in 0..map.lattice().points() {
            let [px, py] = map.lattice().position(point);
            x.push(px);
            y.push(py);
        }
        let mut out = vec![0.0; x.len()];
        for (beacon, rssi_dbm, offset) in [(0, -55, 0.0), (1, -70, 10.0), (3, -62, -3.25)] {
            let packet = Packet { beacon, rssi_dbm };
            let likelihood = map.packet_likelihood(packet, offset, &model).unwrap();
            likelihood.log_likelihoods(&[&x, &y], &mut out);
            for (i, got) in out.iter().enumerate() {
                let one = Likelihood::<4>::log_likelihood(&likelihood, &[x[i], y[i], 0.0, 0.0]);
                assert_eq!(one, *got);
                let place = [x[i], y[i]].map(f64::from);
                let [mean, deviation] = interpolated(&map, beacon.into(), place);
                let distance = f64::from(rssi_dbm) - f64::from(offset) - mean;
                let of = |deviation: f64| {
                    let density = 0.999 * normal_density(distance, deviation.hypot(4.0));
                    0.5 * density.max(1e-3 / 120.0).ln()
                };
                // The place is rounded to a 256th of the spacing, the deviation to a quarter of a dB.
                let slope = if i < 2000 { 0.02 } else { 2e-5 } * (1.0 + distance.abs() / 8.0);
                let (low, high) = (of((deviation - 0.13).max(0.0)), of(deviation + 0.13));
                let (low, high) = (low.min(high), low.max(high));
                assert!(
                    (low.min(of(deviation)) - slope..=high.max(of(deviation)) + slope)
                        .contains(&f64::from(*got)),
                    "{place:?} {got} {low} {high}"
                );
            }
        }
        for nowhere in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
            let packet = Packet {
                beacon: 0,
                rssi_dbm: -60,
            };
            let likelihood = map.packet_likelihood(packet, 0.0, &model).unwrap();
            likelihood.log_likelihoods(&[&[nowhere; 3], &[0.0, nowhere, 1.0]], &mut out[..3]);
            assert!(out[..3].iter().all(|l| l.is_finite()));
        }
    }
}

#[test]
fn packets_that_say_nothing_are_refused() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let model = PacketModel::new(&settings());
    let refusal = |map: RadioMap, beacon, rssi_dbm, offset| {
        let packet = Packet { beacon, rssi_dbm };
        map.packet_likelihood(packet, offset, &model).err()
    };
    assert_eq!(refusal(moments, 0, -60, 0.0), None);
    assert_eq!(refusal(levels, 0, -60, 0.0), Some(PacketError::Encoding));
    assert_eq!(refusal(moments, 4, -60, 0.0), Some(PacketError::Beacon));
    assert_eq!(refusal(moments, 0, 42, 0.0), Some(PacketError::Strength));
    assert_eq!(
        refusal(moments, 0, -60, f32::NAN),
        Some(PacketError::Offset)
    );
}

#[test]
fn between_the_places_of_a_survey_the_field_is_smooth() {
    // Every other metre surveyed, every metre in the map.
    let survey = survey(&line().into_iter().step_by(2).collect::<Vec<_>>());
    let lattice = survey.lattice(1.0).unwrap();
    let bytes = survey
        .radio_map(&lattice, Encoding::Moments, &Options::default())
        .unwrap();
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
            if point % 2 == 0 {
                assert_eq!(got, truth);
            } else {
                squares += (got.mean_dbm - truth.mean_dbm).powi(2) / 156.0;
            }
        }
    }
    assert!(squares.sqrt() < 1.2, "{}", squares.sqrt());
}

#[test]
fn points_that_nobody_was_near_are_left_out() {
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
        let mut posterior = Posterior::<80>::new();
        let scan = scan([40.0, 1.75]);
        match encoding {
            Encoding::Moments => GaussianMatcher::new(map, &settings())
                .unwrap()
                .locate(&scan, &mut posterior),
            _ => TableMatcher::new(map, &settings())
                .unwrap()
                .locate(&scan, &mut posterior),
        }
        .unwrap();
        assert!(posterior.weights()[31..49].iter().all(|w| *w == 0.0));
        assert!((posterior.weights().iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let survey = survey(&line());
    let lattice = survey.lattice(1.0).unwrap();
    for (options, name) in [
        (
            Options {
                bandwidth: 0.0,
                ..Options::default()
            },
            "bandwidth",
        ),
        (
            Options {
                bandwidth: f64::NAN,
                ..Options::default()
            },
            "bandwidth",
        ),
        (
            Options {
                outliers: 0.0,
                ..Options::default()
            },
            "outliers",
        ),
        (
            Options {
                levels: 1,
                ..Options::default()
            },
            "levels",
        ),
        (
            Options {
                reach: Some(f64::NAN),
                ..Options::default()
            },
            "reach",
        ),
    ] {
        let error = survey
            .radio_map(&lattice, Encoding::Levels, &options)
            .unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
    let none = SiteSurvey::new([]);
    assert!(none.lattice(1.0).is_err());
    let error = none
        .radio_map(&lattice, Encoding::Moments, &Options::default())
        .unwrap_err();
    assert!(error.to_string().contains("0 beacons"), "{error}");
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
const _: RadioMap<'static> = match RadioMap::new(include_bytes!("data/tunnel.moments")) {
    Ok(map) => map,
    Err(_) => panic!("damaged"),
};
