//! The library beside exact answers in f64. Seeds are fixed; each limit says how often another seed would miss it.

use std::path::PathBuf;

use foxhunt::aoa::{Clean, Locator, clean};
use foxhunt::filter::ParticleFilter;
use foxhunt::model::ConstantVelocity;
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
use foxhunt::resample::Scheme;
use foxhunt_host::measured::Measured;
use foxhunt_host::reference::{Kalman, Maximum, Posterior, growth, mahalanobis, von_mises};
use foxhunt_host::replay::Replay;
use foxhunt_host::simulate;
use foxhunt_host::tracks::Track;
use foxhunt_problems::growth::{Growth, Measurement, START};
use foxhunt_simulation::{Sight, random};
use nalgebra::{Matrix4, RowVector4, Vector4};
use rayon::prelude::*;

/// The directory of the measured data, which do not come with the project.
fn data(test: &str) -> Option<PathBuf> {
    let directory = std::env::var_os("FOXHUNT_DATA").map(PathBuf::from);
    if directory.is_none() {
        println!("{test} skipped: FOXHUNT_DATA does not name the directory of the measured data");
    }
    directory
}

/// A body in the plane whose position is measured.
mod linear {
    use super::*;

    pub const DT: f64 = 1.0;
    const ACCELERATION: f64 = 0.5;
    const MEASURED: f64 = 2.0;
    const START: [f64; 4] = [2.0, 2.0, 1.0, 1.0];

    pub struct Run {
        /// Squares of the errors of mean (in posterior standard deviations) and covariance (relative), per step.
        pub mean: f64,
        pub covariance: f64,
        /// Difference of the log-evidence of the whole run.
        pub evidence: f64,
    }

    fn transition() -> Matrix4<f64> {
        let mut matrix = Matrix4::identity();
        matrix[(0, 2)] = DT;
        matrix[(1, 3)] = DT;
        matrix
    }

    fn process() -> Matrix4<f64> {
        let along = |d: usize| {
            let mut push = Vector4::zeros();
            push[d] = ACCELERATION * DT * DT / 2.0;
            push[d + 2] = ACCELERATION * DT;
            push * push.transpose()
        };
        along(0) + along(1)
    }

    pub fn run<const N: usize>(steps: usize, seed: u64) -> Run {
        let mut simulation = random::generator(seed, 0);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let dynamics = ConstantVelocity {
            sigma_m_s2: [ACCELERATION as f32; 2],
        };
        let mut truth = Vector4::from(START.map(|s| s * random::normal(&mut simulation)));
        let variances = START.map(|s| s * s);
        let mut kalman = Kalman {
            mean: Vector4::zeros(),
            covariance: Matrix4::from_diagonal(&variances.into()),
        };
        let mut filter = Box::new(ParticleFilter::<4, N>::new());
        filter.initialise(&mut rng, |rng| START.map(|s| s as f32 * normal(rng)));

        let (mut mean, mut covariance, mut evidence) = (0.0, 0.0, 0.0);
        for _ in 0..steps {
            let push = [0, 1].map(|_| ACCELERATION * random::normal(&mut simulation));
            truth = transition() * truth;
            for d in 0..2 {
                truth[d] += push[d] * DT * DT / 2.0;
                truth[d + 2] += push[d] * DT;
            }
            let z = [0, 1].map(|d| truth[d] + MEASURED * random::normal(&mut simulation));

            kalman.predict(&transition(), &process());
            let rows = [
                RowVector4::new(1.0, 0.0, 0.0, 0.0),
                RowVector4::new(0.0, 1.0, 0.0, 0.0),
            ];
            for (row, z) in rows.iter().zip(z) {
                evidence -= kalman.update(row, z, MEASURED * MEASURED);
            }

            filter.resample_below(0.5, &mut rng);
            filter.predict(&dynamics, DT as f32, &mut rng);
            let likelihood = |state: &[f32; 4]| {
                let off = [0, 1].map(|d| (z[d] as f32 - state[d]) / MEASURED as f32);
                -0.5 * (off[0] * off[0] + off[1] * off[1])
                    - (std::f32::consts::TAU * (MEASURED * MEASURED) as f32).ln()
            };
            evidence += f64::from(filter.update(&likelihood).unwrap());

            let estimate = Vector4::from(filter.mean().map(f64::from));
            let spread = kalman.covariance.cholesky().unwrap();
            mean += spread
                .l()
                .solve_lower_triangular(&(estimate - kalman.mean))
                .unwrap()
                .norm_squared()
                / 4.0;
            let found = Matrix4::from_fn(|a, b| f64::from(filter.covariance()[a][b]));
            covariance += ((found - kalman.covariance).norm() / kalman.covariance.norm()).powi(2);
        }
        let steps = steps as f64;
        Run {
            mean: mean / steps,
            covariance: covariance / steps,
            evidence,
        }
    }
}

#[test]
fn linear_gaussian_model_agrees_with_the_kalman_filter() {
    // One run in ten exceeds a limit, so the middle one of 25 does for one set of seeds in a million.
    const RUNS: u64 = 25;
    let runs: Vec<linear::Run> = (0..RUNS)
        .map(|seed| linear::run::<10_000>(40, seed))
        .collect();
    let median = |figure: fn(&linear::Run) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(figure).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mean = median(|run| run.mean.sqrt());
    let covariance = median(|run| run.covariance.sqrt());
    let evidence = median(|run| run.evidence.abs());
    println!(
        "errors: mean {mean:.4} posterior sigmas, covariance {covariance:.4}, log-evidence {evidence:.3}"
    );
    assert!(mean < 0.09);
    assert!(covariance < 0.09);
    assert!(evidence < 0.6);
}

/// Mean squared errors of the particle filter and of the exact filter over one run.
fn growth_run(exact: &growth::GridFilter, steps: usize, run: u64) -> [f64; 2] {
    let (states, measurements) = growth::run(steps, &mut random::generator(50, run));
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(run);
    let mut filter = ParticleFilter::<1, 1000>::new();
    filter.initialise(&mut rng, |_| [START]);
    let ours = measurements.iter().enumerate().map(|(step, y)| {
        let dynamics = Growth {
            step: step as u32 + 1,
        };
        filter.predict(&dynamics, 1.0, &mut rng);
        filter.update(&Measurement { value: *y as f32 }).unwrap();
        let mean = f64::from(filter.mean()[0]);
        filter.resample(Scheme::Systematic, &mut rng);
        mean
    });
    let square = |(estimate, state): (f64, &f64)| (estimate - state).powi(2) / steps as f64;
    let ours = ours.zip(&states).map(square).sum();
    let theirs = exact
        .means(&measurements)
        .into_iter()
        .zip(&states)
        .map(square)
        .sum();
    [ours, theirs]
}

#[test]
fn growth_model_is_as_good_as_particles_can_be() {
    const RUNS: u64 = 10_000;
    const STEPS: usize = 50;
    let exact = growth::GridFilter::new(STEPS);
    let errors: Vec<[f64; 2]> = (0..RUNS)
        .into_par_iter()
        .map(|run| growth_run(&exact, STEPS, run))
        .collect();

    let pooled = |k: usize| (errors.iter().map(|run| run[k]).sum::<f64>() / RUNS as f64).sqrt();
    let (ours, floor) = (pooled(0), pooled(1));
    // Standard deviation of the pooled RMSE over sets of runs.
    let scatter = errors
        .iter()
        .map(|run| (run[0] - ours * ours).powi(2))
        .sum::<f64>()
        .sqrt()
        / (2.0 * ours * RUNS as f64);
    println!(
        "pooled RMSE {ours:.4} +- {scatter:.4}, exact {floor:.4}, ratio {:.4}",
        ours / floor
    );
    // The limit is three times the scatter: one set of seeds in 500 would miss it.
    assert!((ours - 3.03).abs() < 0.03);
    assert!(ours < 1.015 * floor);
}

#[test]
fn locator_is_nearly_exact_on_the_published_tracks() {
    const RUNS: u64 = 200;
    for track in [Track::a1(), Track::a2()] {
        let (mut ours, mut floor, mut apart, mut covered) = (0.0, 0.0, 0.0, 0);
        for run in 0..RUNS {
            let sights = simulate::bearings(&track, &mut random::generator(12, run));
            let mut rng = Xoshiro128PlusPlus::seed_from_u64(run);
            let mut locator = Locator::<Clean<100>>::new(clean::Config::DEFAULT).unwrap();
            for sight in &sights {
                let observation = (*sight).try_into().unwrap();
                locator.push(&observation, &mut rng).unwrap();
            }
            let fix = locator.fix().unwrap();
            let posterior = Posterior::new(&sights).unwrap();
            let position = fix.position.map(f64::from);
            let between = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
            let square = |[x, y]: [f64; 2]| x * x + y * y;
            let off = mahalanobis(between(position, posterior.mean), &posterior.covariance);
            // At most 0.45 in 4,000 other runs.
            assert!(off < 1.0, "{}, run {run}: {off} sigmas off", track.name);
            ours += square(between(position, track.source));
            floor += square(between(posterior.mean, track.source));
            apart += off * off;
            covered += u32::from(fix.ellipse(0.95).contains(track.source.map(|v| v as f32)));
        }
        let ratio = (ours / floor).sqrt();
        let apart = (apart / RUNS as f64).sqrt();
        let coverage = f64::from(covered) / RUNS as f64;
        println!(
            "{}: RMSE {ratio:.4} x exact, {apart:.3} apart, coverage {coverage:.3}",
            track.name
        );
        // Over ten other sets of seeds: up to 1.016 and 0.161, and coverages that scatter by 0.017 round 0.94.
        assert!(ratio < 1.05 && apart < 0.25);
        assert!((0.87..=0.99).contains(&coverage));
    }
}

#[test]
fn measured_bearings_are_located_as_exactly() {
    let Some(data) = data("measured bearings") else {
        return;
    };
    for transmitter in ["tx2", "tx3", "tx4"] {
        let measured = Measured::read(&data.join("wsr/los_set_a.csv"), transmitter).unwrap();
        let drive = measured.drive(4.0).unwrap();
        let replay = Replay::of(drive.bytes());
        let posterior = Posterior::new(replay.sights()).unwrap();
        let fix = replay.fix().unwrap();
        let offset = [0, 1].map(|d| f64::from(fix.position[d]) - posterior.mean[d]);
        let off = mahalanobis(offset, &posterior.covariance);
        println!(
            "{transmitter}: {off:.3} posterior sigmas off {:?}",
            replay.gateway().counters()
        );
        assert_eq!(fix.bearings, 50);
        // At most 0.25 for 200 seeds of the gateway.
        assert!(off < 0.3);
    }
}

#[test]
fn lenths_bearings_give_his_estimates() {
    let Some(data) = data("Lenth's bearings") else {
        return;
    };
    let read = |name: &str| csv::Reader::from_path(data.join("lenth").join(name)).unwrap();
    let all: Vec<Sight> = read("bearings.csv")
        .deserialize::<[f64; 3]>()
        .zip(0..)
        .map(|(row, time_ms)| {
            let [x, y, degrees] = row.unwrap();
            Sight {
                time_ms,
                position: [x, y],
                bearing: (90.0 - degrees).to_radians(),
                sigma: 0.1,
            }
        })
        .collect();
    let without_sixth: Vec<Sight> = all
        .iter()
        .enumerate()
        .filter(|(row, _)| *row != 5)
        .map(|(_, sight)| *sight)
        .collect();

    let mut compared = 0;
    for row in read("results.csv").records() {
        let row = row.unwrap();
        let sights = match &row[0] {
            "7" => &without_sixth,
            _ => &all,
        };
        if &row[1] != "MLE" {
            continue;
        }
        let Maximum {
            place: [x, y],
            covariance,
        } = von_mises(sights, [7.0, 2.0]).unwrap();
        let [sx, sy] = [0, 1].map(|d| covariance[(d, d)].sqrt());
        let correlation = covariance[(0, 1)] / (sx * sy);
        let columns = [(2, x), (3, y), (5, sx), (6, sy), (7, correlation)];
        for (column, value) in columns {
            let printed = &row[column];
            let decimals = printed
                .split_once('.')
                .map_or(0, |(_, decimals)| decimals.len());
            // 0.156 is printed as .156.
            let ours = format!("{value:.decimals$}");
            assert_eq!(
                ours.trim_start_matches('0'),
                printed.trim_start_matches('0'),
                "{row:?}"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 10);
}
