//! How far the stated errors of direction finders can be trusted among reflections, by the method of the spectrum; and
//! whether a drive past a source ends where the gateway says.

use anyhow::Result;
use foxhunt::aoa::robust::Config;
use foxhunt_host::{
    array::{Method, coverage},
    figures::Figure,
    passes::{Build, Passes, Told},
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{
    statistics::median,
    study::{Study, progress},
    table::table,
};

/// Readings of each method, unless told otherwise.
const RUNS: u32 = 2_000;
/// The least rate of readings of which a 95 % interval holds the truth.
const LEAST: f64 = 0.9;
/// Drives of all builds and methods, unless fewer runs are asked for: as many of each.
const DRIVES: u32 = 504;
/// The rates of drives between which those are whose 95 % ellipse holds the source.
const HELD: [f64; 2] = [0.92, 0.98];
/// Conditions of drives: a key, the standard deviation of the antennas' phases in degrees, what the locator is told, such as
/// how sure it is that sigmas are as stated ([`scale_sigma`](foxhunt::aoa::robust::Errors::scale_sigma)), and whether the
/// figures have limits. Sigmas as stated allow for reflections in every reading, so ellipses are too wide for an ideal
/// array. Errors of phase are a bias by direction: a locator that is not told of it takes its steadiness for accuracy.
const CONDITIONS: [(&str, f64, Told, bool); 6] = [
    ("ideal", 0.0, Told::Scale(SCALE_SIGMA), true),
    ("ideal.stated", 0.0, Told::Scale(0.0), false),
    ("ideal.directions", 0.0, Told::Directions, false),
    ("phase10", 10.0, Told::Scale(SCALE_SIGMA), false),
    ("phase10.stated", 10.0, Told::Scale(0.0), false),
    ("phase10.directions", 10.0, Told::Directions, false),
];
const SCALE_SIGMA: f32 = Config::CITY.errors.scale_sigma;

/// Prints the tables, and returns their figures.
///
/// # Errors
/// When no progress can be shown.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut figures = readings(study);
    for (key, phase, told, limited) in CONDITIONS {
        let drives = Drives::new(study, phase, told)?;
        drives.print(phase, told);
        figures.extend(drives.figures(key, limited));
    }
    Ok(figures)
}

fn readings(study: &Study) -> Vec<Figure> {
    let runs = u64::from(study.runs.unwrap_or(RUNS));
    let header = [
        "method",
        "bearing",
        "truth within 95 %",
        "of the best",
        "stated sigma, degrees",
        "error, degrees",
        "bearings",
    ];
    let mut table = table(header, 2);
    let mut figures = Vec::new();
    for method in Method::ALL {
        for (spectra, name) in [(false, "field"), (true, "spectrum")] {
            let found = coverage(method, spectra, runs, study.seed);
            table.add_row([
                method.name().to_owned(),
                name.to_owned(),
                format!("{:.1} %", 100.0 * found.any),
                format!("{:.1} %", 100.0 * found.best),
                format!("{:.1}", found.stated),
                format!("{:.1}", found.error),
                format!("{:.2}", found.bearings),
            ]);
            let figure = |what, value, unit| {
                Figure::new(
                    format!("kraken.{}.{name}.{what}", method.name()),
                    value,
                    unit,
                )
            };
            figures.push(figure("missed", 1.0 - found.any, "rate").at_most(1.0 - LEAST));
            figures.push(figure("sigma", found.stated, "degrees"));
            figures.push(figure("error", found.error, "degrees"));
        }
    }
    println!(
        "{runs} readings of a KrakenSDR, with a reflection of 0.2 to 0.6 from anywhere:\n\n{table}\n"
    );
    figures
}

/// Drives past a source with every build and method, in turns.
struct Drives(Vec<(Build, Method, Passes)>);

impl Drives {
    fn new(study: &Study, phase: f64, told: Told) -> Result<Self> {
        let kinds: Vec<(Build, Method)> = Build::ALL
            .into_iter()
            .flat_map(|build| Method::ALL.map(|method| (build, method)))
            .collect();
        let all = study.runs.unwrap_or(DRIVES).min(DRIVES);
        let all = u64::from(all).next_multiple_of(kinds.len() as u64);
        let one = |run: u64| {
            let (build, method) = kinds[run as usize % kinds.len()];
            let passes = Passes::one(build, method, phase, told, study.seed, run);
            (build, method, passes)
        };
        let drives = (0..all)
            .into_par_iter()
            .progress_with(progress(all, format!("drives, {phase} degrees"))?)
            .map(one);
        Ok(Self(drives.collect()))
    }

    /// Of the drives that are `wanted`.
    fn summary(&self, wanted: impl Fn(Build, Method) -> bool) -> Summary {
        let drives = self
            .0
            .iter()
            .filter(|(build, method, _)| wanted(*build, *method));
        let drives = drives.map(|(_, _, passes)| *passes);
        let sum = drives.clone().fold(Passes::default(), Passes::and);
        let errors = drives
            .filter(|drive| drive.fixes > 0)
            .map(|drive| drive.error);
        Summary {
            median: if sum.fixes > 0 {
                median(errors)
            } else {
                f64::NAN
            },
            sum,
        }
    }

    fn print(&self, phase: f64, told: Told) {
        let header = [
            "build",
            "method",
            "drives",
            "fixes",
            "95 % ellipse holds",
            "median error, m",
            "unused readings",
        ];
        let mut table = table(header, 2);
        for build in Build::ALL {
            for method in Method::ALL {
                let one = self.summary(|b, m| (b, m) == (build, method));
                table.add_row(one.row(build.name(), method.name()));
            }
        }
        table.add_row(self.summary(|_, _| true).row("all", "all"));
        let told = match told {
            Told::Scale(sigma) => {
                format!("the logarithm of the scale of sigmas known to {sigma} before")
            }
            Told::Directions => "told that errors depend on the direction".to_owned(),
        };
        println!(
            "Drives past a source, one reading in five with a reflection, antennas off by {phase} degrees of phase, \
             {told}:\n\n{table}\n"
        );
    }

    fn figures(&self, key: &str, limited: bool) -> [Figure; 5] {
        let Summary { sum, median } = self.summary(|_, _| true);
        let held = sum.held as f64 / sum.fixes as f64;
        let figure = |what, value, unit, limit| Figure {
            limit: Some(limit).filter(|_| limited),
            ..Figure::new(format!("kraken.drives.{key}.{what}"), value, unit)
        };
        let [least, most] = HELD;
        [
            figure("no_fix", (sum.runs - sum.fixes) as f64, "drives", 0.0),
            figure("covered", held, "of fixes", most),
            figure("missed", 1.0 - held, "of fixes", 1.0 - least),
            figure("unused", sum.unused as f64, "readings", 0.0),
            Figure::new(format!("kraken.drives.{key}.median"), median, "m"),
        ]
    }
}

/// What has become of some drives.
struct Summary {
    sum: Passes,
    /// Of the errors of the fixes, in metres.
    median: f64,
}

impl Summary {
    fn row(&self, build: &str, method: &str) -> [String; 7] {
        let Passes {
            runs,
            fixes,
            held,
            unused,
            ..
        } = self.sum;
        [
            build.to_owned(),
            method.to_owned(),
            runs.to_string(),
            fixes.to_string(),
            format!("{:.1} %", 100.0 * held as f64 / fixes as f64),
            format!("{:.1}", self.median),
            unused.to_string(),
        ]
    }
}
