//! The bearings of the WSR set, in sight of the transmitters and not, in random orders of the places; beside what is
//! known to be done with them, which sees all at once.

use std::{env, path::Path};

use anyhow::Result;
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::aoa::robust::{Errors, Settings};
use foxhunt_host::{Sight, measured::Measured, reference::mahalanobis, simulate};
use indicatif::ParallelProgressIterator;
use nalgebra::{Matrix2, Vector2};
use rand::RngExt;
use rayon::prelude::*;

use super::super::{
    progress,
    statistics::{median, root_mean_square},
};
use super::simulated::{NINETY_FIVE, Outcome, locate};
use crate::figures::Figure;

const SETS: [(&str, &str); 2] = [("los", "los_set_a.csv"), ("nlos", "nlos_set_a.csv")];
const TRANSMITTERS: [&str; 3] = ["tx2", "tx3", "tx4"];
/// Of bearings taken at one place; what they are off by together is a bias, of as much.
const DEVIATION_DEGREES: f64 = 3.0;

/// One for all: a room of ten metres, places that are decimetres apart.
fn settings() -> Result<Settings> {
    let errors = Errors::new().bias_deviation(DEVIATION_DEGREES.to_radians() as f32)?;
    let errors = errors.correlation(0.95, 0.2, f32::INFINITY)?;
    Ok(Settings::new(errors).range_m(10.0)?)
}

/// Runs all transmitters of both sets.
pub fn run(orders: u32, seed: u64) -> Result<Vec<Figure>> {
    let Some(data) = env::var_os("FOXHUNT_DATA") else {
        println!(
            "the measured bearings, and their figures, are skipped: FOXHUNT_DATA does not name the directory of the \
             measured data\n"
        );
        return Ok(Vec::new());
    };
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "bearings",
        "median m",
        "worst m",
        "95 % ellipse holds",
        "no fix",
        "Gauss-Newton",
        "holds",
        "least squares",
        "Huber",
        "holds",
    ]);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut figures = Vec::new();
    for (set, file) in SETS {
        let mut beside_huber = Vec::new();
        for transmitter in TRANSMITTERS {
            let file = Path::new(&data).join("wsr").join(file);
            let measured = Measured::read(&file, transmitter)?;
            let one = Transmitter::of(&measured, orders, seed, &format!("{set} {transmitter}"))?;
            let fixes = || one.ours.iter().filter(|o| o.error.is_finite());
            let count = fixes().count();
            let (middle, worst) = if count > 0 {
                let errors = || fixes().map(|o| o.error);
                (median(errors()), errors().fold(0.0, f64::max))
            } else {
                (f64::NAN, f64::NAN)
            };
            let covered = fixes().filter(|o| o.covered).count();
            // A maximum at infinity, or no fix.
            let metres = |error: f64| match error {
                lost if lost > 1000.0 => "lost".to_owned(),
                none if none.is_nan() => String::new(),
                near => format!("{near:.2}"),
            };
            let holds = |o: &Outcome| if o.covered { "yes" } else { "no" }.to_owned();
            table.add_row([
                format!("{set} {transmitter}"),
                metres(middle),
                metres(worst),
                format!("{covered} of {count}"),
                format!("{} of {orders}", one.ours.len() - count),
                metres(one.gauss_newton.error),
                holds(&one.gauss_newton),
                metres(one.least_squares),
                metres(one.huber.error),
                holds(&one.huber),
            ]);
            let name = |what: &str| format!("papers.bearings.measured.{set}.{transmitter}.{what}");
            let no_fix = 1.0 - count as f64 / f64::from(orders);
            figures.extend([
                Figure::new(name("no_fix"), no_fix, "of orders"),
                Figure::new(name("huber"), one.huber.error, "m"),
            ]);
            if count > 0 {
                beside_huber.push([middle, one.huber.error]);
                let covered = covered as f64 / count as f64;
                figures.extend([
                    Figure::new(name("median"), middle, "m"),
                    Figure::new(name("worst"), worst, "m"),
                    Figure::new(name("covered"), covered, "of fixes"),
                ]);
            }
        }
        let rms = |k: usize| root_mean_square(beside_huber.iter().map(|pair| pair[k]));
        let figure = Figure::new(
            format!("papers.bearings.measured.{set}.median_over_huber"),
            rms(0) / rms(1),
            "",
        );
        figures.push(if set == "nlos" {
            figure.at_most(1.0)
        } else {
            figure
        });
    }
    println!(
        "Measured bearings, {orders} random orders; the others are given all bearings at once, Huber's the best of 144 \
         starts. In the figures beside it the transmitters without a fix do not count."
    );
    println!("{table}\n");
    Ok(figures)
}

struct Transmitter {
    ours: Vec<Outcome>,
    gauss_newton: Outcome,
    least_squares: f64,
    huber: Outcome,
}

impl Transmitter {
    fn of(measured: &Measured, orders: u32, seed: u64, name: &str) -> Result<Self> {
        let source = measured.transmitter;
        let sights: Vec<Sight> = measured
            .bearings
            .iter()
            .map(|&(position, degrees)| Sight {
                position,
                bearing: degrees.to_radians(),
                deviation: DEVIATION_DEGREES.to_radians(),
            })
            .collect();
        let settings = settings()?;
        let ours = (0..orders)
            .into_par_iter()
            .progress_with(progress(orders.into(), name.to_owned())?)
            .map(|order| {
                let mut rng = simulate::generator(seed, order.into());
                let mut sights = sights.clone();
                for last in (1..sights.len()).rev() {
                    sights.swap(last, rng.random_range(0..=last));
                }
                let answer = locate(settings, &sights, seed ^ u64::from(order))?;
                Ok(Outcome::of(answer, source))
            })
            .collect::<Result<_>>()?;
        let off = |place: Vector2<f64>| place - Vector2::from(source);
        let maximum = |limit| {
            let (place, covariance) = huber(&sights, limit);
            Outcome {
                error: off(place).norm(),
                covered: mahalanobis(off(place).into(), &covariance) <= NINETY_FIVE,
            }
        };
        Ok(Self {
            ours,
            gauss_newton: maximum(f64::INFINITY),
            least_squares: off(nearest_to_lines(&sights)).norm(),
            huber: maximum(1.345),
        })
    }
}

/// The least cost by Huber's function with that limit, in deviations, from 144 starts all over the room; where there is
/// no limit, by least squares of the angles.
fn huber(sights: &[Sight], limit: f64) -> (Vector2<f64>, Matrix2<f64>) {
    let cost = |place: Vector2<f64>| -> f64 {
        let one = |sight: &Sight| {
            let u = (sight.residual(place.into()) / sight.deviation).abs();
            if u < limit {
                0.5 * u * u
            } else {
                limit * (u - 0.5 * limit)
            }
        };
        sights.iter().map(one).sum()
    };
    let starts = (0..144).map(|k| Vector2::new(f64::from(k % 12), f64::from(k / 12)) * 2.0);
    let ends = starts.map(|start| {
        let mut place = start - Vector2::repeat(11.0);
        let mut information = Matrix2::identity();
        for _ in 0..60 {
            information = Matrix2::zeros();
            let mut gradient = Vector2::zeros();
            for sight in sights {
                let ray = place - Vector2::from(sight.position);
                let across = Vector2::new(-ray.y, ray.x) / (ray.norm_squared() + 1e-6);
                let residual = sight.residual(place.into());
                let u = (residual / sight.deviation).abs();
                let weight = (limit / u).min(1.0) / sight.deviation.powi(2);
                information += across * across.transpose() * weight;
                gradient += across * residual * weight;
            }
            let Some(inverse) = information.try_inverse() else {
                break;
            };
            let mut step = inverse * gradient;
            for _ in 0..12 {
                // Not `>`: a NaN must be halved too.
                if cost(place + step) <= cost(place) {
                    break;
                }
                step *= 0.5;
            }
            place += step;
            let length = step.norm();
            if length <= 1e-7 || length.is_nan() {
                break;
            }
        }
        (place, information)
    });
    let best = ends.min_by(|(a, _), (b, _)| cost(*a).total_cmp(&cost(*b)));
    let (place, information) = best.expect("there are starts");
    let covariance = information.try_inverse();
    (place, covariance.unwrap_or_else(Matrix2::zeros))
}

/// The point with the least squares of distances from all lines of bearing.
fn nearest_to_lines(sights: &[Sight]) -> Vector2<f64> {
    let (mut matrix, mut vector) = (Matrix2::zeros(), Vector2::zeros());
    for sight in sights {
        let normal = Vector2::new(-sight.bearing.sin(), sight.bearing.cos());
        matrix += normal * normal.transpose();
        vector += normal * normal.dot(&Vector2::from(sight.position));
    }
    matrix.try_inverse().unwrap_or_else(Matrix2::zeros) * vector
}
