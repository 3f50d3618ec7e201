//! The bearings of the WSR set, in sight of the transmitters and not, in random orders of the places; beside what is
//! known to be done with them, which sees all at once.

use std::path::Path;

use anyhow::Result;
use foxhunt::aoa::robust::Config;
use foxhunt_host::{Sight, figures::Figure, measured::Measured, reference::mahalanobis, simulate};
use indicatif::ParallelProgressIterator;
use nalgebra::Vector2;
use rand::RngExt;
use rayon::prelude::*;

use super::{
    others::{huber, nearest_to_lines},
    outcome::{Outcome, locate},
};
use crate::papers::{
    statistics::{NINETY_FIVE, median, root_mean_square},
    study::{Study, progress},
    table::table,
};

const SETS: [(&str, &str); 2] = [("los", "los_set_a.csv"), ("nlos", "nlos_set_a.csv")];
const TRANSMITTERS: [&str; 3] = ["tx2", "tx3", "tx4"];
/// Of bearings taken at one place; what they are off by together is a bias, of as much.
const SIGMA_DEGREES: f64 = 3.0;

/// What a user has who states nothing.
const CONFIG: Config = Config::DEFAULT;

/// Runs all transmitters of both sets.
pub fn run(study: &Study, orders: u32) -> Result<Vec<Figure>> {
    let Some(data) = study.data("wsr", "bearings") else {
        return Ok(Vec::new());
    };
    let header = [
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
    ];
    let mut table = table(header, 1);
    let mut figures = Vec::new();
    for (set, file) in SETS {
        let all = transmitters(set, &data.join(file), orders, study.seed)?;
        for one in &all {
            table.add_row(one.row());
            figures.extend(one.figures());
        }
        let located = all.iter().filter(|one| one.fixes().next().is_some());
        let (ours, huber): (Vec<f64>, Vec<f64>) =
            located.map(|one| (one.median(), one.huber.error)).unzip();
        let rms = |errors: Vec<f64>| root_mean_square(errors.into_iter());
        let figure = Figure::new(
            format!("papers.bearings.measured.{set}.median_over_huber"),
            rms(ours) / rms(huber),
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

fn transmitters(
    set: &'static str,
    file: &Path,
    orders: u32,
    seed: u64,
) -> Result<Vec<Transmitter>> {
    let one = |name| {
        let measured = Measured::read(file, name)?;
        Transmitter::new([set, name], &measured, orders, seed)
    };
    TRANSMITTERS.into_iter().map(one).collect()
}

/// A distance in a table: it is lost where a maximum is at infinity, and there is none without a fix.
fn metres(error: f64) -> String {
    match error {
        lost if lost > 1000.0 => "lost".to_owned(),
        none if none.is_nan() => String::new(),
        near => format!("{near:.2}"),
    }
}

/// What came of the bearings on a transmitter.
struct Transmitter {
    /// The set, and the transmitter.
    name: [&'static str; 2],
    ours: Vec<Outcome>,
    gauss_newton: Outcome,
    least_squares: f64,
    huber: Outcome,
}

impl Transmitter {
    fn new(name: [&'static str; 2], measured: &Measured, orders: u32, seed: u64) -> Result<Self> {
        let source = measured.transmitter;
        let sights: Vec<Sight> = measured
            .bearings
            .iter()
            .map(|&(position, degrees)| Sight {
                time_ms: 0,
                position,
                bearing: degrees.to_radians(),
                sigma: SIGMA_DEGREES.to_radians(),
            })
            .collect();
        let ours = (0..orders)
            .into_par_iter()
            .progress_with(progress(orders.into(), name.join(" "))?)
            .map(|order| {
                let mut rng = simulate::generator(seed, order.into());
                let mut sights = sights.clone();
                for last in (1..sights.len()).rev() {
                    sights.swap(last, rng.random_range(0..=last));
                }
                for (index, sight) in sights.iter_mut().enumerate() {
                    sight.time_ms = 1000 * index as u32;
                }
                let answer = locate(&CONFIG, &sights, seed ^ u64::from(order))?;
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
            name,
            ours,
            gauss_newton: maximum(f64::INFINITY),
            least_squares: off(nearest_to_lines(&sights)).norm(),
            huber: maximum(1.345),
        })
    }
    fn fixes(&self) -> impl Iterator<Item = &Outcome> {
        self.ours.iter().filter(|ours| ours.error.is_finite())
    }

    fn median(&self) -> f64 {
        median(self.fixes().map(|fix| fix.error))
    }

    fn worst(&self) -> f64 {
        self.fixes().map(|fix| fix.error).fold(0.0, f64::max)
    }

    fn covered(&self) -> usize {
        self.fixes().filter(|fix| fix.covered).count()
    }

    fn row(&self) -> [String; 10] {
        let count = self.fixes().count();
        let [middle, worst] = match count {
            0 => [f64::NAN; 2],
            _ => [self.median(), self.worst()],
        };
        let holds = |o: &Outcome| if o.covered { "yes" } else { "no" }.to_owned();
        [
            self.name.join(" "),
            metres(middle),
            metres(worst),
            format!("{} of {count}", self.covered()),
            format!("{} of {}", self.ours.len() - count, self.ours.len()),
            metres(self.gauss_newton.error),
            holds(&self.gauss_newton),
            metres(self.least_squares),
            metres(self.huber.error),
            holds(&self.huber),
        ]
    }

    fn figures(&self) -> Vec<Figure> {
        let [set, transmitter] = self.name;
        let figure = |what: &str, value, unit| {
            let name = format!("papers.bearings.measured.{set}.{transmitter}.{what}");
            Figure::new(name, value, unit)
        };
        let count = self.fixes().count() as f64;
        let mut figures = vec![
            figure("no_fix", 1.0 - count / self.ours.len() as f64, "of orders"),
            figure("huber", self.huber.error, "m"),
        ];
        if count > 0.0 {
            figures.extend([
                figure("median", self.median(), "m"),
                figure("worst", self.worst(), "m"),
                figure("covered", self.covered() as f64 / count, "of fixes"),
            ]);
        }
        figures
    }
}
