//! The robust locator beside the exact posterior of outliers, mirrored and biased bearings. Seeds are fixed; each limit says
//! how often another seed would miss it.

use foxhunt::aoa::robust::{Config, Correlation, Errors};
use foxhunt::aoa::{Fix, Locate, Robust};
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
use foxhunt_host::reference::{Posterior, cramer_rao_of_biased};
use foxhunt_host::simulate;
use foxhunt_host::stationary::Stationary;
use foxhunt_host::tracks::Track;
use foxhunt_simulation::Sight;
use foxhunt_simulation::{faults::Faults, random};
use rayon::prelude::*;

const RUNS: u64 = 100;

fn last_fix(config: &Config, sights: &[Sight], run: u64) -> Option<Fix> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(run);
    let mut locator = Box::new(Robust::<256, 64>::EMPTY);
    for sight in sights {
        let observation = (*sight).try_into().unwrap();
        locator.push(&observation, config, &mut rng).unwrap();
    }
    locator.fix()
}

fn with_errors(errors: Errors) -> Config {
    Config {
        errors,
        ..Config::DEFAULT
    }
}

/// What came of the runs of one track and fault.
struct Outcome {
    /// RMSE beside that of the exact posterior.
    ratio: f64,
    /// Runs whose 95 % ellipse holds the source.
    covered: usize,
    /// Runs that are further off than five times the bound of bearings without outliers, none of them mirrored.
    lost: usize,
}

fn run(track: &Track, faults: &Faults) -> Outcome {
    let config = with_errors(Errors {
        bias_sigma_rad: faults.bias_sigma as f32,
        ..Errors::DEFAULT
    });
    let off = |[x, y]: [f64; 2]| (x - track.source[0]).hypot(y - track.source[1]);
    let runs: Vec<[f64; 4]> = (0..RUNS)
        .into_par_iter()
        .map(|run| {
            let mut sights = simulate::bearings(track, &mut random::generator(81, run));
            let bound = cramer_rao_of_biased(&sights, track.source, faults.bias_sigma).unwrap();
            faults.spoil(&mut sights, &mut random::generator(82, run));
            let fix = last_fix(&config, &sights, run).expect("a fix");
            let exact = off(Posterior::with_faults(&sights, faults).unwrap().mean);
            let ours = off(fix.position.map(f64::from));
            let covered = fix.ellipse(0.95).contains(track.source.map(|v| v as f32));
            let lost = ours > 5.0 * bound.trace().sqrt();
            let counted = |b| f64::from(u8::from(b));
            [ours * ours, exact * exact, counted(covered), counted(lost)]
        })
        .collect();
    let sum = |k: usize| runs.iter().map(|run| run[k]).sum::<f64>();
    let outcome = Outcome {
        ratio: (sum(0) / sum(1)).sqrt(),
        covered: sum(2) as usize,
        lost: sum(3) as usize,
    };
    println!(
        "{} {faults:?}: {:.3} x exact, coverage {}, lost {}",
        track.name, outcome.ratio, outcome.covered, outcome.lost
    );
    outcome
}

/// Ratios of 100 runs scatter by a hundredth round those of thousands, 1.00 to 1.01; coverages by 2.2 round 94 to 96; so
/// each of the ten is missed by less than one set of seeds in a thousand.
fn check(faults: Faults) {
    for track in [Track::a1(), Track::a2()] {
        let outcome = run(&track, &faults);
        assert!(outcome.ratio < 1.05, "{}", outcome.ratio);
        assert!((87..=100).contains(&outcome.covered), "{}", outcome.covered);
        assert_eq!(outcome.lost, 0);
    }
}

#[test]
fn clean_bearings_cost_nothing() {
    check(Faults::default());
}

#[test]
fn a_tenth_of_outliers() {
    check(Faults {
        outlier_rate: 0.1,
        ..Faults::default()
    });
}

#[test]
fn three_tenths_of_outliers() {
    check(Faults {
        outlier_rate: 0.3,
        ..Faults::default()
    });
}

#[test]
fn half_of_the_bearings_mirrored() {
    check(Faults {
        mirrored_rate: 0.5,
        ..Faults::default()
    });
}

#[test]
fn a_bias_of_three_degrees() {
    check(Faults {
        bias_sigma: 3f64.to_radians(),
        ..Faults::default()
    });
}

#[test]
fn a_stationary_vehicle_is_as_sure_as_it_may_be() {
    const RUNS: u64 = 60;
    let track = Track::a1();
    let stationary = Stationary {
        stop: 20,
        readings: 300,
        at_rest: 0.9,
        distance: 20.0,
    };
    let covered = |at_rest| {
        let config = with_errors(Errors {
            correlation: Correlation {
                at_rest,
                distance_m: 20.0,
                ..Correlation::NONE
            },
            ..Errors::DEFAULT
        });
        (0..RUNS)
            .into_par_iter()
            .filter(|&run| {
                let sights = stationary.bearings(&track, &mut random::generator(83, run));
                let fix = last_fix(&config, &sights, run).expect("a fix");
                fix.ellipse(0.95).contains(track.source.map(|v| v as f32))
            })
            .count()
    };
    let (matched, independent) = (covered(0.9), covered(0.0));
    println!("covered {matched} and {independent} of {RUNS}");
    // With 95 % each misses by one set of seeds in 2,000; untempered ones are covered in six to eight runs of ten.
    assert!(matched >= 51, "{matched}");
    assert!(independent < matched);
}
