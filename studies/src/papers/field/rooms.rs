//! The bearings of the WSR set, in sight of the transmitters and not, in random orders of the places, by default; beside the
//! exact posterior and what else is known to be done with them, which see all at once.

use std::path::Path;

use anyhow::Result;
use foxhunt_host::{
    figures::Figure,
    measured::Measured,
    reference::{Model, mahalanobis},
    stops::shuffle,
};
use foxhunt_simulation::{Sight, faults::Faults, random};
use indicatif::ParallelProgressIterator;
use nalgebra::Vector2;
use rayon::prelude::*;

use super::{
    config::{SCALE_SIGMA, nothing},
    runs::{Run, exact},
};
use crate::papers::{
    others::{huber, nearest_to_lines},
    outcome::{Outcome, locate},
    statistics::{NINETY_FIVE, median, root_mean_square},
    study::{Study, progress},
    table::table,
};

const SETS: [(&str, &str); 2] = [("los", "los_set_a.csv"), ("nlos", "nlos_set_a.csv")];
const TRANSMITTERS: [&str; 3] = ["tx2", "tx3", "tx4"];
/// What each bearing states.
const SIGMA_DEGREES: f64 = 3.0;
/// The least fraction of the orders of a transmitter that have a fix, and whose ellipse holds it.
const ENOUGH: f64 = 0.9;
/// So many of the six transmitters may be worse.
const EXCUSED: f64 = 1.0;
/// The most that the median error may be in that of the exact posterior's.
const RATIO: f64 = 1.1;

/// Runs all transmitters of both sets.
pub fn run(study: &Study, orders: u32) -> Result<Vec<Figure>> {
    let Some(data) = study.data("wsr", "rooms") else {
        return Ok(Vec::new());
    };
    let header = [
        "bearings",
        "median m",
        "worst m",
        "95 % ellipse holds",
        "fixes",
        "the exact's median",
        "holds",
        "fixes",
        "Gauss-Newton",
        "holds",
        "least squares",
        "Huber",
        "holds",
    ];
    let mut table = table(header, 1);
    let mut all = Vec::new();
    for (set, file) in SETS {
        all.extend(transmitters(set, &data.join(file), orders, study.seed)?);
    }
    let mut figures = Vec::new();
    for one in &all {
        table.add_row(one.row());
        figures.extend(one.figures());
    }
    println!(
        "Rooms: the default configuration, {orders} random orders; the exact posterior has the same prior, but for a bias, \
         which it takes for none, and with the rates of outliers and mirrored bearings that are expected. The others are given all bearings at once, Huber's the best of 144 \
         starts."
    );
    println!("{table}\n");
    figures.extend(summary(&all));
    Ok(figures)
}

/// What is asked of all together.
fn summary(all: &[Transmitter]) -> Vec<Figure> {
    let located = || all.iter().filter(|one| one.fraction_of_fixes() >= ENOUGH);
    let fixed = located().count();
    let held = located().filter(|one| one.covered() >= ENOUGH).count();
    let figure = |what: &str, value, unit| Figure::new(format!("field.rooms.{what}"), value, unit);
    let mut figures = vec![
        figure("without_fix", (all.len() - fixed) as f64, "transmitters").at_most(EXCUSED),
        figure("not_held", (fixed - held) as f64, "transmitters").at_most(0.0),
    ];
    if fixed > 0 {
        let ratio = median(located().map(|one| one.median() / one.exact_median()));
        figures.push(figure("median_over_exact", ratio, "").at_most(RATIO));
        let (ours, huber): (Vec<f64>, Vec<f64>) =
            located().map(|one| (one.median(), one.huber.error)).unzip();
        let rms = |errors: Vec<f64>| root_mean_square(errors.into_iter());
        figures.push(figure("median_over_huber", rms(ours) / rms(huber), ""));
    }
    figures
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
    exact: Vec<Run>,
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
        let runs: Vec<(Outcome, Option<Run>)> = (0..orders)
            .into_par_iter()
            .progress_with(progress(orders.into(), name.join(" "))?)
            .map(|order| order_of(&sights, source, seed, order.into()))
            .collect::<Result<_>>()?;
        let ours = runs.iter().map(|(ours, _)| *ours).collect();
        let exact = runs.iter().filter_map(|(_, exact)| *exact).collect();
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
            exact,
            gauss_newton: maximum(f64::INFINITY),
            least_squares: off(nearest_to_lines(&sights)).norm(),
            huber: maximum(1.345),
        })
    }

    fn fixes(&self) -> impl Iterator<Item = Outcome> {
        let ours = self.ours.iter().copied();
        ours.filter(|ours| ours.error.is_finite())
    }

    fn fraction_of_fixes(&self) -> f64 {
        self.fixes().count() as f64 / self.ours.len() as f64
    }

    fn exact_median(&self) -> f64 {
        median(self.exact.iter().map(|run| run.exact.error))
    }

    fn median(&self) -> f64 {
        median(self.fixes().map(|fix| fix.error))
    }

    fn worst(&self) -> f64 {
        self.fixes().map(|fix| fix.error).fold(0.0, f64::max)
    }

    /// The fraction of all orders.
    fn covered(&self) -> f64 {
        let covered = self.fixes().filter(|fix| fix.covered).count();
        covered as f64 / self.ours.len() as f64
    }

    fn row(&self) -> [String; 13] {
        let count = self.fixes().count();
        let [middle, worst] = match count {
            0 => [f64::NAN; 2],
            _ => [self.median(), self.worst()],
        };
        let percent = |fraction: f64| format!("{:.0} %", 100.0 * fraction);
        let holds = |o: &Outcome| if o.covered { "yes" } else { "no" }.to_owned();
        let of_exact = |is: fn(&Run) -> bool| {
            let count = self.exact.iter().filter(|run| is(run)).count();
            percent(count as f64 / self.exact.len() as f64)
        };
        [
            self.name.join(" "),
            metres(middle),
            metres(worst),
            percent(self.covered()),
            percent(self.fraction_of_fixes()),
            metres(self.exact_median()),
            of_exact(|run| run.exact.covered),
            of_exact(|run| run.fix),
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
            let name = format!("field.rooms.{set}.{transmitter}.{what}");
            Figure::new(name, value, unit)
        };
        let mut figures = vec![
            figure("fixes", self.fraction_of_fixes(), "of orders"),
            figure("covered", self.covered(), "of orders"),
            figure("exact", self.exact_median(), "m"),
            figure("huber", self.huber.error, "m"),
        ];
        if self.fixes().next().is_some() {
            figures.extend([
                figure("median", self.median(), "m"),
                figure("worst", self.worst(), "m"),
            ]);
        }
        figures
    }
}

/// Orders from one exact posterior to the next: it depends on the place of the first bearing only, and takes seconds.
const EXACT_EVERY: u64 = 5;

/// The bearings in a random order, one a second: our outcome, and that of the exact posterior.
fn order_of(
    sights: &[Sight],
    source: [f64; 2],
    seed: u64,
    order: u64,
) -> Result<(Outcome, Option<Run>)> {
    let mut sights = sights.to_vec();
    for (sight, second) in sights.iter_mut().zip(0..) {
        sight.time_ms = 1000 * second;
    }
    shuffle(&mut sights, &mut random::generator(seed, order));
    let told = nothing(SIGMA_DEGREES.to_radians());
    let answer = locate(&told.config, &sights, seed ^ order)?;
    let last = sights[sights.len() - 1].position;
    let expected = told.config.errors.rates;
    let model = Model {
        scale_sigma: SCALE_SIGMA,
        ..Model::with_faults(&Faults {
            outlier_rate: expected.outlier.into(),
            mirrored_rate: expected.mirrored.into(),
            bias_sigma: 0.0,
        })
    };
    let exact = match order % EXACT_EVERY {
        0 => Some(Run::new(answer, &exact(&sights, model)?, source, last)),
        _ => None,
    };
    Ok((Outcome::of(answer, source), exact))
}
