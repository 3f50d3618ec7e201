//! The tracker on simulated and measured walks, in short: `cargo xtask papers fingerprint` is the long form. Seeds are fixed;
//! each limit says how often another seed would miss it.

use std::path::PathBuf;

use foxhunt::fingerprint::tracker::Config;
use foxhunt_host::experiment::Run;
use foxhunt_host::reference::corridor::{CorridorFilter, Motion};
use foxhunt_host::walks::{Office, Walk, follow_scans, of_simulated_scans, tunnel_map};
use foxhunt_simulation::random::generator;
use rayon::prelude::*;

const RUNS: u64 = 100;

/// Errors of the tracker and of the exact filter, in metres, in every run.
fn simulated(noise: f64, packets: usize, seed: u64) -> Vec<[Vec<f64>; 2]> {
    let filter = CorridorFilter::new(&Motion::default(), 0.5, 17);
    let places: Vec<f64> = filter.places().collect();
    (0..RUNS)
        .into_par_iter()
        .map(|number| {
            let run = Run::draw(noise, packets, &mut generator(seed, number));
            let map = tunnel_map(&run.survey).unwrap();
            let ours = follow_scans(&run, &map, of_simulated_scans(), number).unwrap();
            let exact = filter.run(&run.log_likelihoods(&places));
            let errors = |places: Vec<f64>| {
                let pairs = places.into_iter().zip(&run.truth);
                pairs.map(|(place, truth)| place - truth).collect()
            };
            [
                errors(ours),
                errors(exact.iter().map(|belief| belief.mean).collect()),
            ]
        })
        .collect()
}

fn fraction(errors: &[f64], of: impl Fn(f64) -> bool) -> f64 {
    errors.iter().filter(|error| of(error.abs())).count() as f64 / errors.len() as f64
}

/// Mean and its standard deviation.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The difference of the mean squares, run by run, has to be within what a ratio of 1.05 of the roots allows, and three of
/// its standard deviations. In 1,000 runs the ratio was 1.00 everywhere: then about one seed in 2,000 misses this for each
/// noise, one in 700 for the fraction of near steps and for the lost ones, one in 200 altogether.
#[test]
fn in_the_simulated_tunnel_the_tracker_is_as_good_as_the_exact_filter() {
    for (column, (noise, packets)) in [(2.0, 1), (4.0, 1), (6.0, 1), (4.0, 10)]
        .into_iter()
        .enumerate()
    {
        let runs = simulated(noise, packets, 410 + column as u64);
        let by_run = |of: &dyn Fn(&[f64]) -> f64| -> (Vec<f64>, Vec<f64>) {
            runs.iter()
                .map(|[ours, exact]| (of(ours), of(exact)))
                .unzip()
        };
        let difference = |ours: &[f64], exact: &[f64], factor: f64| {
            let pairs = ours.iter().zip(exact);
            mean(&pairs.map(|(a, b)| a - factor * b).collect::<Vec<_>>())
        };
        let squares =
            |errors: &[f64]| errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        let (ours, exact) = by_run(&squares);
        let (excess, sigma) = difference(&ours, &exact, 1.05 * 1.05);
        assert!(excess < 3.0 * sigma, "{noise} dB: {excess} +- {sigma} m^2");
        let (ours, exact) = by_run(&|errors| fraction(errors, |e| e > 2.0));
        let (excess, sigma) = difference(&ours, &exact, 1.0);
        assert!(
            excess < 0.02 + 3.0 * sigma,
            "{noise} dB: {excess} +- {sigma} far"
        );
        let (ours, exact) = by_run(&|errors| fraction(errors, |e| e > 20.0));
        let (excess, sigma) = difference(&ours, &exact, 1.0);
        assert!(
            excess <= 3.0 * sigma,
            "{noise} dB: {excess} +- {sigma} lost"
        );
        if packets == 10 {
            let (far, sigma) = mean(&by_run(&|errors| fraction(errors, |e| e > 2.0)).0);
            assert!(far < 0.07 + 3.0 * sigma, "{far} +- {sigma} far");
        }
    }
}

/// Errors of all walks of a kind with four filter seeds, in rising order, by the packets that `hears` lets through.
fn measured(office: &Office, is_straight: bool, hears: impl Fn(usize) -> bool) -> Vec<f64> {
    let walks = office
        .walks
        .iter()
        .filter(|walk| walk.is_straight == is_straight);
    let of_walk = |walk: &Walk| -> Vec<f64> {
        let heard = |packet: &&foxhunt_simulation::tunnel::Packet| hears(packet.beacon);
        let packets: Vec<_> = walk.packets.iter().filter(heard).copied().collect();
        let times = walk.times();
        (0..4)
            .flat_map(|seed| {
                let places = walk
                    .follow(&packets, &times, Config::DEFAULT, seed)
                    .unwrap();
                walk.errors(&times, &places)
            })
            .collect()
    };
    let mut errors: Vec<f64> = walks.flat_map(of_walk).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// The walks are what they are; only the filter's seeds vary. With 40 of them 99.8 % and 93 % of the steps were near, with
/// 12 and with 4 receivers, and 90 % in the plane within 2.76 m: four seeds are further off than the limits less often than
/// once in a thousand times.
#[test]
fn measured_walks_are_tracked() {
    let Some(data) = std::env::var_os("FOXHUNT_DATA").map(PathBuf::from) else {
        println!(
            "measured_walks_are_tracked skipped: FOXHUNT_DATA does not name the directory of the measured data"
        );
        return;
    };
    let office = Office::open(&data.join("tetam")).unwrap();
    // Of the survey, by leaving each place out.
    assert!(office.left_out_db() < 3.7, "{}", office.left_out_db());
    let straight = measured(&office, true, |_| true);
    assert!(fraction(&straight, |e| e < 2.0) >= 0.95);
    let four = measured(&office, true, |receiver| [0, 4, 9, 10].contains(&receiver));
    assert!(fraction(&four, |e| e < 2.0) >= 0.85);
    let plane = measured(&office, false, |_| true);
    let p90 = plane[plane.len() * 9 / 10];
    assert!(p90 <= 2.9, "{p90}");
}
