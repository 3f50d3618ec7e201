//! Du, Zhao, Jiang, Yu: bearing-only location, Telecommunication Engineering 56(12), 2016.
//!
//! Their particle filter as they give it, on tracks of the size of theirs, beside our locator, Gauss-Newton
//! and the exact posterior.

mod methods;

use std::{
    fmt,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt_host::{
    Sight,
    picture::{self, Curve, Curves},
    reference::{cramer_rao, mahalanobis},
    simulate,
    tracks::Track,
};
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use nalgebra::Matrix2;
use rand::RngExt;
use rayon::prelude::*;

use self::methods::Outcome;
use super::statistics::{Estimate, bootstrap, median, root_mean_square};
use crate::{
    figures::{self, Figure},
    project,
};

/// The options of `cargo xtask papers aoa`.
#[derive(clap::Args)]
pub struct Options {
    /// Runs on each track.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(10..))]
    runs: u32,
    /// Seed of all random numbers: the same seed gives the same tables.
    #[arg(long, default_value_t = 2016)]
    seed: u64,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What an independent implementation in f64 found for the published filter, in 1,000 runs.
struct Reference {
    /// RMSE as a multiple of the bound, with 100 and with 1000 particles.
    rmse: [f64; 2],
    /// RMSE of the exact posterior mean as a multiple of the bound.
    floor: f64,
    /// Median error with 100 particles, in metres.
    median: f64,
}

const REFERENCE_RUNS: usize = 1000;

/// With 100 particles a few runs in a thousand are lost, and they make the RMSE: what 1,000 runs can show
/// of it is only seen from many more.
const MORE_RUNS: u32 = 20_000;

/// Runs the experiment on both tracks.
pub fn run(options: &Options) -> Result<()> {
    let tracks = [
        (
            Track::a1(),
            Reference {
                rmse: [1.87, 1.09],
                floor: 1.017,
                median: 6.07,
            },
        ),
        (
            Track::a2(),
            Reference {
                rmse: [2.56, 1.14],
                floor: 1.010,
                median: 2.74,
            },
        ),
    ];
    let mut all = Vec::new();
    for (track, reference) in tracks {
        let experiment = Experiment::run(track, options)?;
        experiment.print();
        all.extend(experiment.figures(&reference));
        let stem = project::root()
            .join("target/papers")
            .join(format!("aoa-{}", experiment.name()));
        experiment.draw(&stem)?;
        println!("picture: {}\n", stem.with_extension("svg").display());
    }
    println!(
        "The paper prints mean relative errors in x and y, over the estimates of one run on a track of its own: \
         particle filter 0.266 % and 0.206 %, fish school 0.101 % and 0.091 %. Those above are of the last \
         estimates of all runs.\n"
    );
    figures::print(&all);
    if let Some(file) = &options.json {
        figures::write_json(&all, file)?;
    }
    figures::check(&all)
}

/// All runs on one track.
struct Experiment {
    track: Track,
    /// Of the error after the last bearing, in square metres.
    bound: Matrix2<f64>,
    /// Root of its trace after each bearing.
    bounds: Vec<Option<f64>>,
    methods: Vec<Method>,
    reproduction: Reproduction,
}

/// All runs of one method.
struct Method {
    label: &'static str,
    key: &'static str,
    outcomes: Vec<Outcome>,
}

impl Experiment {
    fn run(track: Track, options: &Options) -> Result<Self> {
        let clean: Vec<Sight> = simulate::bearings(
            &Track {
                deviation: 0.0,
                ..track.clone()
            },
            &mut simulate::generator(0, 0),
        )
        .into_iter()
        .map(|sight| Sight {
            deviation: track.deviation,
            ..sight
        })
        .collect();
        let bound =
            cramer_rao(&clean, track.source).context("the track does not determine the source")?;
        let bounds = (1..=clean.len())
            .map(|n| cramer_rao(&clean[..n], track.source).map(|bound| bound.trace().sqrt()))
            .collect();

        let bar = ProgressBar::new(options.runs.into())
            .with_message(track.name)
            .with_style(ProgressStyle::with_template(
                "{msg} {wide_bar} {pos}/{len} runs, {eta} left",
            )?);
        let runs: Vec<_> = (0..options.runs)
            .into_par_iter()
            .progress_with(bar)
            .map(|run| methods::run(&track, &mut simulate::generator(options.seed, run.into())))
            .collect::<Result<_>>()?;
        let methods = methods::ALL
            .iter()
            .enumerate()
            .map(|(index, (label, key))| Method {
                label,
                key,
                outcomes: runs
                    .iter()
                    .map(|run: &Vec<Outcome>| run[index].clone())
                    .collect(),
            })
            .collect();
        let reproduction = Reproduction::run(&track, bound.trace().sqrt(), options.seed)?;
        Ok(Self {
            track,
            bound,
            bounds,
            methods,
            reproduction,
        })
    }

    fn name(&self) -> String {
        self.track.name.to_lowercase()
    }

    fn runs(&self) -> usize {
        self.methods[0].outcomes.len()
    }

    fn print(&self) {
        println!(
            "Track {}, {} bearings, {} runs; Cramer-Rao bound {:.2} m",
            self.track.name,
            self.track.receivers.len(),
            self.runs(),
            self.bound.trace().sqrt(),
        );
        let mut table = Table::new();
        table.load_style(ASCII_MARKDOWN).set_header([
            "method",
            "RMSE / bound",
            "RMSE / floor",
            "median m",
            "off > 5 sigma",
            "95 % ellipse holds",
            "mean |dx| / x, |dy| / y",
        ]);
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        for method in &self.methods {
            let [x, y] = method.relative_errors(self.track.source);
            table.add_row([
                method.label.to_owned(),
                self.over_bound(method).to_string(),
                self.over_floor(method).to_string(),
                format!("{:.2}", method.median().value),
                format!("{:.1} %", 100.0 * self.beyond_five_sigma(method)),
                format!("{:.1} %", 100.0 * method.coverage()),
                format!("{:.3} %, {:.3} %", 100.0 * x, 100.0 * y),
            ]);
        }
        println!("{table}");
        println!("{}", self.reproduction);
    }

    fn figures(&self, reference: &Reference) -> Vec<Figure> {
        let name = self.name();
        let mut figures = Vec::new();
        for method in &self.methods {
            let prefix = format!("papers.aoa.{name}.{}", method.key);
            let figure =
                |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
            let over_bound = self.over_bound(method);
            let over_floor = self.over_floor(method);
            let beyond = figure("beyond_5_sigma", self.beyond_five_sigma(method), "of runs");
            let held = figure("coverage", method.coverage(), "of runs");
            let missed = figure("coverage_missed", 1.0 - method.coverage(), "of runs");
            let floor_figure = figure("rmse_over_floor", over_floor.value, "");
            let (floor_figure, beyond, held, missed) = if method.key == methods::LOCATOR {
                (
                    floor_figure.at_most(1.2),
                    beyond.at_most(0.01),
                    held.at_most(0.98),
                    missed.at_most(0.10),
                )
            } else {
                (floor_figure, beyond, held, missed)
            };
            figures.push(figure("rmse_over_bound", over_bound.value, ""));
            figures.push(figure("rmse_over_bound_error", over_bound.error, ""));
            figures.extend([floor_figure, beyond, held, missed]);
            figures.push(figure("median", method.median().value, "m"));

            // The reproduction: within three standard deviations of what others found.
            let off = |estimate: Estimate, expected| {
                estimate.distance(expected, REFERENCE_RUNS as f64, self.runs() as f64)
            };
            if method.key == methods::PUBLISHED_100 {
                let surprise = self.reproduction.surprise(reference.rmse[0]);
                figures.push(figure("rmse_surprise", surprise, "").at_most(0.998));
                let off = off(method.median(), reference.median);
                figures.push(figure("median_off_reference", off, "sigma").at_most(3.0));
            } else if method.key == methods::PUBLISHED_1000 {
                // Beside the floor of the same runs their common luck does not count.
                let off = off(over_floor, reference.rmse[1] / reference.floor);
                figures.push(figure("rmse_off_reference", off, "sigma").at_most(3.0));
            }
        }
        figures
    }

    fn over_bound(&self, method: &Method) -> Estimate {
        let bound = self.bound.trace().sqrt();
        bootstrap(self.runs(), |runs| {
            root_mean_square(runs.map(|run| method.error(run))) / bound
        })
    }

    /// Against the exact posterior mean of the same runs.
    fn over_floor(&self, method: &Method) -> Estimate {
        let floor = &self.methods[methods::FLOOR];
        bootstrap(self.runs(), |runs| {
            let (mut ours, mut theirs) = (0.0, 0.0);
            for run in runs {
                ours += method.error(run).powi(2);
                theirs += floor.error(run).powi(2);
            }
            (ours / theirs).sqrt()
        })
    }

    /// Share of the runs whose error is longer than five standard deviations of the bound in its direction.
    fn beyond_five_sigma(&self, method: &Method) -> f64 {
        method.share(|outcome| mahalanobis(outcome.error, &self.bound) > 5.0)
    }

    fn draw(&self, stem: &Path) -> Result<()> {
        let bound = Curve {
            name: "Cramer-Rao bound".into(),
            points: self
                .bounds
                .iter()
                .enumerate()
                .filter_map(|(n, bound)| Some(((n + 1) as f64, (*bound)?)))
                .filter(|(_, bound)| *bound < 1000.0)
                .collect(),
        };
        let curves = self
            .methods
            .iter()
            .filter_map(Method::curve)
            .map(|curve| Curve {
                // Which is why it seems to know the source before it can be known.
                name: curve
                    .name
                    .replace("as published", "as published, started from all bearings"),
                ..curve
            });
        let picture = Curves {
            title: format!(
                "Track {}: error after each bearing, {} runs",
                self.track.name,
                self.runs()
            ),
            horizontal: "bearings".into(),
            vertical: "root mean square error, m".into(),
            curves: std::iter::once(bound).chain(curves).collect(),
        };
        picture::save(&picture.svg()?, stem)
    }
}

impl Method {
    fn error(&self, run: usize) -> f64 {
        let [x, y] = self.outcomes[run].error;
        x.hypot(y)
    }

    fn median(&self) -> Estimate {
        bootstrap(self.outcomes.len(), |runs| {
            median(runs.map(|run| self.error(run)))
        })
    }

    fn coverage(&self) -> f64 {
        self.share(|outcome| outcome.covered)
    }

    fn share(&self, holds: impl Fn(&Outcome) -> bool) -> f64 {
        let count = self
            .outcomes
            .iter()
            .filter(|outcome| holds(outcome))
            .count();
        count as f64 / self.outcomes.len() as f64
    }

    /// Mean error along x and y, as a share of the coordinates of the source.
    fn relative_errors(&self, source: [f64; 2]) -> [f64; 2] {
        let share = |outcome: &Outcome, d: usize| (outcome.error[d] / source[d]).abs();
        let sum = |d| self.outcomes.iter().map(|o| share(o, d)).sum::<f64>();
        [0, 1].map(|d| sum(d) / self.outcomes.len() as f64)
    }

    /// RMSE after each bearing, from where nearly all runs have an estimate; `None` if the method has one at the
    /// end only.
    fn curve(&self) -> Option<Curve> {
        let steps = self.outcomes[0].path.len();
        let points = (0..steps)
            .filter_map(|step| {
                let errors: Vec<[f64; 2]> = self
                    .outcomes
                    .iter()
                    .filter_map(|outcome| outcome.path[step])
                    .collect();
                let known = errors.len() as f64 >= 0.99 * self.outcomes.len() as f64;
                known.then(|| {
                    let rmse = root_mean_square(errors.iter().map(|[x, y]| x.hypot(*y)));
                    ((step + 1) as f64, rmse)
                })
            })
            .collect::<Vec<_>>();
        (!points.is_empty()).then(|| Curve {
            name: self.label.into(),
            points,
        })
    }
}

/// The RMSE, as a multiple of the bound, that experiments of 1,000 runs find for the published filter with
/// 100 particles: in rising order.
struct Reproduction(Vec<f64>);

impl Reproduction {
    /// Draws the experiments from a pool of many runs.
    fn run(track: &Track, bound: f64, seed: u64) -> Result<Self> {
        const EXPERIMENTS: usize = 4000;
        let pool: Vec<f64> = (0..MORE_RUNS)
            .into_par_iter()
            .map(|run| {
                let mut rng = simulate::generator(!seed, run.into());
                let [x, y] = methods::published_alone(track, &mut rng)?;
                Ok(x.hypot(y) / bound)
            })
            .collect::<Result<_>>()?;
        let mut rng = simulate::generator(!seed, MORE_RUNS.into());
        let mut experiments: Vec<f64> = (0..EXPERIMENTS)
            .map(|_| {
                root_mean_square((0..REFERENCE_RUNS).map(|_| pool[rng.random_range(0..pool.len())]))
            })
            .collect();
        experiments.sort_by(f64::total_cmp);
        Ok(Self(experiments))
    }

    fn quantile(&self, probability: f64) -> f64 {
        self.0[((self.0.len() - 1) as f64 * probability) as usize]
    }

    /// Share of the experiments that are nearer to the middle one than `rmse`.
    fn surprise(&self, rmse: f64) -> f64 {
        let below = self.0.partition_point(|experiment| *experiment < rmse) as f64;
        (2.0 * below / self.0.len() as f64 - 1.0).abs()
    }
}

impl fmt::Display for Reproduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "as published, N = 100, in {MORE_RUNS} more runs: RMSE / bound of 1,000 runs {:.2}, 99 % of the time {:.2} to {:.2}",
            self.quantile(0.5),
            self.quantile(0.005),
            self.quantile(0.995),
        )
    }
}
