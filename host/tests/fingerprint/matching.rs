//! Scans matched with a map.

use foxhunt::fingerprint::{
    Config, Encoding, Match, Matcher, Posterior, RadioMap, Reading, ReadingError,
};

use crate::site::*;

/// Posteriors of the table and of the Gaussian against f64 with what the map holds: only the steps of the costs differ.
#[test]
fn matchers_differ_from_f64_by_their_steps() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let gaussian = Matcher::new(moments, &UNTEMPERED).unwrap();
    let table = Matcher::new(levels, &UNTEMPERED).unwrap();
    let mut posterior = Posterior::<100>::EMPTY;
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
            let sigma = f64::from(m.sigma_db).hypot(4.0);
            let density = normal_density(f64::from(rssi - m.mean_dbm), sigma);
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
    let config = Config::DEFAULT;
    let mut posterior = Posterior::<POINTS>::EMPTY;
    let mut squares = [0.0; 3];
    for place in places() {
        let scan = scan(place);
        let found = [
            Matcher::new(moments, &config)
                .unwrap()
                .locate(&scan, &mut posterior),
            Matcher::new(levels, &config)
                .unwrap()
                .locate(&scan, &mut posterior),
        ];
        // The densities themselves, tempered as the others.
        let log_likelihoods: Vec<f64> = (0..POINTS)
            .map(|point| {
                let of =
                    |r: &Reading| log_density(r.beacon.into(), point, f64::from(r.rssi_dbm), 4.0);
                f64::from(config.tempering) * scan.iter().map(of).sum::<f64>()
            })
            .collect();
        let (_, exact, _) = exact(&log_likelihoods);
        let [gaussian, table] = found.map(|found| f64::from(found.unwrap().mean[0]));
        for (sum, x) in squares.iter_mut().zip([gaussian, table, exact]) {
            *sum += (x - place[0]).powi(2) / 60.0;
        }
    }
    let rmse = squares.map(f64::sqrt);
    // A guess is 23 m off.
    assert!(rmse.iter().all(|e| *e < 6.0), "{rmse:?}");
    // The table has levels of 2 dB, and 15 steps.
    assert!((rmse[1] / rmse[2] - 1.0).abs() < 0.1, "{rmse:?}");
}

#[test]
fn scans_that_make_no_sense_are_refused_and_change_nothing() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let gaussian = Matcher::new(moments, &UNTEMPERED).unwrap();
    let table = Matcher::new(levels, &UNTEMPERED).unwrap();
    let reading = |beacon, rssi_dbm| Reading { beacon, rssi_dbm };
    let mut posterior = Posterior::<POINTS>::EMPTY;
    assert!(posterior.weights().is_empty());
    let good = [reading(1, -60.0), reading(2, -70.0)];
    gaussian.locate(&good, &mut posterior).unwrap();
    let before = posterior.weights().to_vec();
    for (scan, error) in [
        (vec![], ReadingError::Strength),
        (vec![reading(0, 42.0)], ReadingError::Strength),
        (vec![reading(0, f32::NAN)], ReadingError::Strength),
        (
            vec![reading(0, -60.0), reading(4, -60.0)],
            ReadingError::Beacon,
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
    let mut small = Posterior::<79>::EMPTY;
    assert_eq!(
        gaussian.locate(&good, &mut small),
        Err(ReadingError::Points)
    );
    assert_eq!(table.locate(&good, &mut small), Err(ReadingError::Points));
    // More readings than any scan has.
    let many = vec![good[0]; 1000];
    assert_eq!(gaussian.locate(&many, &mut posterior).unwrap().used, 64);
    assert_eq!(table.locate(&many, &mut posterior).unwrap().used, 64);
}
