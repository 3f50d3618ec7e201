//! A tunnel and a hall, their surveys and scans, and the same sums in f64.

use foxhunt::fingerprint::{Config, Encoding, Reading};
use foxhunt_host::radio_map::{self, Recipe, SiteSurvey};

pub const POINTS: usize = 80;
pub const BEACONS: usize = 4;
pub const EACH: usize = 16;
pub const PLACES: [[f64; 2]; BEACONS] = [[10.0, 0.0], [30.0, 3.5], [50.0, 0.0], [70.0, 3.5]];

/// A sample of a beacon at a place, in whole dBm: path loss, something that stays, something that does not.
pub fn sample(beacon: usize, [x, y]: [f64; 2], number: usize) -> i8 {
    let [bx, by] = PLACES[beacon];
    let squared = (x - bx).powi(2) + (y - by).powi(2) + 1.0;
    let b = beacon as f64;
    let shadow = 3.0 * (0.37 * x + 1.3 * b).sin() + 2.0 * (0.9 * x + 0.5 * y - b).sin();
    let noise = 4.0 * (2.1 * number as f64 + 5.3 * x + 3.1 * y + 1.7 * b).sin();
    (-40.0 - 10.0 * squared.log10() + shadow + noise).round() as i8
}

pub fn survey(places: &[[f64; 2]]) -> SiteSurvey {
    SiteSurvey::new(places.iter().flat_map(|&[x, y]| {
        (0..BEACONS * EACH).map(move |i| radio_map::Reading {
            x,
            y,
            beacon: 100 + (i / EACH) as u32,
            rssi: f64::from(sample(i / EACH, [x, y], i % EACH)),
        })
    }))
}

pub fn line() -> Vec<[f64; 2]> {
    (0..POINTS).map(|i| [i as f64, 1.75]).collect()
}

/// A hall of 16 by 8 points, 2 m apart.
pub fn hall() -> Vec<[f64; 2]> {
    (0..128)
        .map(|i| [f64::from(i % 16) * 5.0, f64::from(i / 16) * 2.0])
        .collect()
}

/// A map with points so many metres apart.
pub fn map(survey: &SiteSurvey, spacing: f64, encoding: Encoding) -> Vec<u8> {
    let recipe = Recipe {
        spacing_m: Some(spacing),
        encoding,
        ..Recipe::default()
    };
    survey.map(&recipe, &mut |_| ()).unwrap().bytes
}

pub fn tunnel(encoding: Encoding) -> Vec<u8> {
    map(&survey(&line()), 1.0, encoding)
}

pub fn hall_map() -> Vec<u8> {
    map(&survey(&hall()), 2.5, Encoding::Moments)
}

pub fn scan(position: [f64; 2]) -> [Reading; BEACONS] {
    std::array::from_fn(|beacon| Reading {
        beacon: beacon as u8,
        rssi_dbm: f32::from(sample(beacon, position, 99)),
    })
}

pub const UNTEMPERED: Config = Config {
    tempering: 1.0,
    ..Config::DEFAULT
};

pub fn log_mixture(density: f64) -> f64 {
    ((1.0 - 1e-3) * density + 1e-3 / 120.0).ln()
}

pub fn normal_density(distance: f64, sigma: f64) -> f64 {
    (-0.5 * (distance / sigma).powi(2)).exp() / (sigma * std::f64::consts::TAU.sqrt())
}

/// Kernel density in f64.
pub fn log_density(beacon: usize, point: usize, rssi: f64, bandwidth: f64) -> f64 {
    let samples = (0..EACH).map(|i| f64::from(sample(beacon, line()[point], i)));
    let sum: f64 = samples.map(|s| normal_density(rssi - s, bandwidth)).sum();
    log_mixture(sum / EACH as f64)
}

/// Posterior, mean and covariance along x in f64.
pub fn exact(log_likelihoods: &[f64]) -> (Vec<f64>, f64, f64) {
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

pub fn samples() -> Vec<i8> {
    let points = line().into_iter();
    points
        .flat_map(|place| (0..BEACONS * EACH).map(move |i| sample(i / EACH, place, i % EACH)))
        .collect()
}

pub fn places() -> impl Iterator<Item = [f64; 2]> {
    (0..60).map(|i| [1.31 * f64::from(i), 0.3 + 0.05 * f64::from(i)])
}
