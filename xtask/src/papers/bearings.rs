//! Bearings along a track: methods on the same bearings, beside the exact posterior.

use std::path::Path;

use anyhow::{Context, Result};
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::{
    aoa::{
        BearingLikelihood, Observation,
        locator::{Answer, Locator},
    },
    estimate::Ellipse,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    Sight,
    picture::{self, Axis, Curve, Curves, Style},
    reference::{Posterior, cramer_rao, mahalanobis},
    simulate,
    tracks::Track,
};
use indicatif::ParallelProgressIterator;
use nalgebra::Matrix2;
use rand::Rng;
use rayon::prelude::*;

use super::{
    counted::{Counted, Counter},
    instructions::{Instructions, short},
    methods::bearings::{self as methods, Bearings, Visit, Watch},
    statistics::{Estimate, Experiments, bootstrap, median, root_mean_square},
};
use crate::figures::Figure;

/// 95 % of a normal distribution in the plane lie within this Mahalanobis distance.
const NINETY_FIVE: f64 = 2.447_746_830_680_816;

/// The bearings of one run.
pub struct Problem {
    pub track: Track,
    pub sights: Vec<Sight>,
    pub observations: Vec<Observation>,
}

impl Problem {
    pub fn new(track: &Track, rng: &mut impl Rng) -> Result<Self> {
        let sights = simulate::bearings(track, rng);
        let observations = sights
            .iter()
            .map(|sight| (*sight).try_into())
            .collect::<Result<_, _>>()?;
        Ok(Self {
            track: track.clone(),
            sights,
            observations,
        })
    }

    /// Of an estimate, in metres east and north.
    pub fn error(&self, position: [f32; 2]) -> [f64; 2] {
        [0, 1].map(|d| f64::from(position[d]) - self.track.source[d])
    }
}

/// What a method made of one run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Error after the last bearing, in metres east and north.
    pub error: [f64; 2],
    /// Whether the 95 % ellipse holds the source.
    pub covered: bool,
    /// Error after each bearing; empty for a method that is asked once, at the end.
    pub path: Vec<Option<[f64; 2]>>,
    /// Likelihoods of one bearing at one place that it evaluated; zero if that is not what it does.
    pub evaluations: u64,
}

/// A method to run.
pub struct Method {
    pub label: &'static str,
    /// In the names of figures.
    pub key: &'static str,
    /// Instructions of a run.
    pub instructions: f64,
    run: Box<Run>,
}

type Run = dyn Fn(&Problem, &mut Xoshiro128PlusPlus) -> Result<Outcome> + Sync;

impl Method {
    /// The last error in one run.
    fn error(&self, track: &Track, rng: &mut impl Rng) -> Result<[f64; 2]> {
        let problem = Problem::new(track, rng)?;
        let mut own = Xoshiro128PlusPlus::from_rng(rng);
        Ok((self.run)(&problem, &mut own)?.error)
    }
}

/// The methods that a study hands to a visitor, with what the board took for each.
pub fn methods_of(study: &str, visit: impl FnOnce(&mut Collected)) -> Result<Vec<Method>> {
    let mut collected = Collected(Vec::new());
    visit(&mut collected);
    let instructions = Instructions::of(study)?;
    let mut methods = collected.0;
    for method in &mut methods {
        method.instructions = instructions.per_run(method.label)?.value;
    }
    Ok(methods)
}

/// Methods as a study hands them over.
pub struct Collected(Vec<Method>);

impl Visit for Collected {
    fn method(
        &mut self,
        label: &'static str,
        key: &'static str,
        method: impl methods::Method + Send + Sync + 'static,
    ) {
        self.0.push(Method {
            label,
            key,
            instructions: 0.0,
            run: Box::new(move |problem, rng| locate(problem, &method, rng)),
        });
    }
}

fn locate(
    problem: &Problem,
    method: &impl methods::Method,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    let counter = Counter::default();
    let likelihoods: Vec<Counted<'_, BearingLikelihood>> = problem
        .observations
        .iter()
        .map(|observation| counter.of(BearingLikelihood::new(observation)))
        .collect();
    let bearings = Bearings {
        observations: &problem.observations,
        likelihoods: &likelihoods,
        process: problem.track.process as f32,
    };
    let mut watcher = Watcher {
        problem,
        path: Vec::new(),
        counter: &counter,
        locator: None,
    };
    let estimate = method
        .locate(bearings, rng, &mut watcher)
        .context("the method found no source")?;
    let source = problem.track.source.map(|v| v as f32);
    Ok(Outcome {
        error: problem.error(estimate.position),
        covered: Ellipse::of_normal(estimate.position, estimate.covariance, 0.95).contains(source),
        path: watcher.path,
        evaluations: counter.calls(),
    })
}

struct Watcher<'a> {
    problem: &'a Problem,
    path: Vec<Option<[f64; 2]>>,
    counter: &'a Counter,
    /// The particles of a locator that had a fix before the last bearing.
    locator: Option<[Vec<f32>; 2]>,
}

impl Watch for Watcher<'_> {
    fn estimate(&mut self, position: Option<[f32; 2]>) {
        let error = position.map(|position| self.problem.error(position));
        self.path.push(error);
    }

    /// What a locator evaluates for each particle can be told from whether they moved.
    fn pushed<const N: usize>(&mut self, locator: &Locator<N>, moves: u8) {
        let Answer::Fix(_) = locator.answer() else {
            return;
        };
        let (kept, moves) = (locator.observations().len(), usize::from(moves));
        let columns = locator.columns().map(<[f32]>::to_vec);
        self.counter.add(match &self.locator {
            None => N * kept * (moves + 2),
            Some(before) if *before == columns => N,
            Some(_) => N * (1 + kept * (moves + 1)),
        });
        self.locator = Some(columns);
    }
}

fn floor(problem: &Problem) -> Result<Outcome> {
    let posterior = Posterior::new(&problem.sights).context("the posterior has no bounds")?;
    let error = [0, 1].map(|d| posterior.mean[d] - problem.track.source[d]);
    Ok(Outcome {
        error,
        covered: mahalanobis(error, &posterior.covariance) <= NINETY_FIVE,
        path: Vec::new(),
        evaluations: 0,
    })
}

/// All runs on one track.
pub struct Experiment {
    pub track: Track,
    /// Of the error after the last bearing, in square metres.
    bound: Matrix2<f64>,
    /// Root of its trace after each bearing.
    bounds: Vec<Option<f64>>,
    /// The exact posterior is the last of them.
    pub methods: Vec<Outcomes>,
}

/// All runs of one method.
pub struct Outcomes {
    pub label: &'static str,
    pub key: &'static str,
    /// Of a run; zero of the exact posterior, which is not for boards.
    pub instructions: f64,
    runs: Vec<Outcome>,
}

pub const FLOOR: &str = "floor";

impl Experiment {
    /// Runs every method, and the exact posterior, on the same bearings.
    pub fn run(track: Track, methods: &[Method], runs: u32, seed: u64) -> Result<Self> {
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

        let exact = Method {
            label: "exact posterior (floor)",
            key: FLOOR,
            instructions: 0.0,
            run: Box::new(|problem, _| floor(problem)),
        };
        let methods: Vec<&Method> = methods.iter().chain([&exact]).collect();
        let runs: Vec<Vec<Outcome>> = (0..runs)
            .into_par_iter()
            .progress_with(super::progress(runs.into(), track.name)?)
            .map(|run| {
                let mut rng = simulate::generator(seed, run.into());
                let problem = Problem::new(&track, &mut rng)?;
                let one = |method: &&Method| {
                    let mut own = Xoshiro128PlusPlus::from_rng(&mut rng);
                    (method.run)(&problem, &mut own)
                };
                methods.iter().map(one).collect()
            })
            .collect::<Result<_>>()?;
        let methods = methods
            .into_iter()
            .enumerate()
            .map(|(index, method)| Outcomes {
                label: method.label,
                key: method.key,
                instructions: method.instructions,
                runs: runs.iter().map(|run| run[index].clone()).collect(),
            })
            .collect();
        Ok(Self {
            track,
            bound,
            bounds,
            methods,
        })
    }

    pub fn name(&self) -> String {
        self.track.name.to_lowercase()
    }

    pub fn runs(&self) -> usize {
        self.methods[0].runs.len()
    }

    /// Root of the trace of the Cramer-Rao bound, in metres.
    pub fn bound(&self) -> f64 {
        self.bound.trace().sqrt()
    }

    /// Prints the table, with what the paper prints of some methods, by their keys.
    pub fn print(&self, printed: &[(&str, &str)]) {
        println!(
            "Track {}, {} bearings, {} runs; Cramer-Rao bound {:.2} m",
            self.track.name,
            self.track.receivers.len(),
            self.runs(),
            self.bound(),
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
            "the paper's",
            "likelihoods",
            "M4F instructions",
        ]);
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        for method in &self.methods {
            let [x, y] = method.relative_errors(self.track.source);
            let printed = printed.iter().find(|(key, _)| *key == method.key);
            table.add_row([
                method.label.to_owned(),
                self.over_bound(method).to_string(),
                self.over_floor(method).to_string(),
                format!("{:.2}", method.median().value),
                format!("{:.1} %", 100.0 * self.beyond_five_sigma(method)),
                format!("{:.1} %", 100.0 * method.coverage()),
                format!("{:.3} %, {:.3} %", 100.0 * x, 100.0 * y),
                printed.map_or("", |(_, printed)| *printed).to_owned(),
                short(method.evaluations()),
                short(method.instructions),
            ]);
        }
        println!("{table}");
    }

    /// What is said of every method.
    pub fn figures(&self, paper: &str, method: &Outcomes) -> Vec<Figure> {
        let prefix = format!("papers.{paper}.{}.{}", self.name(), method.key);
        let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
        let over_bound = self.over_bound(method);
        let mut figures = vec![
            figure("rmse_over_bound", over_bound.value, ""),
            figure("rmse_over_bound_error", over_bound.error, ""),
            figure("rmse_over_floor", self.over_floor(method).value, ""),
            figure("beyond_5_sigma", self.beyond_five_sigma(method), "of runs"),
            figure("coverage", method.coverage(), "of runs"),
            figure("median", method.median().value, "m"),
        ];
        if method.evaluations() > 0.0 {
            figures.push(figure("evaluations", method.evaluations(), "per run"));
        }
        if method.instructions > 0.0 {
            figures.push(figure("instructions", method.instructions, "per run"));
        }
        figures
    }

    /// The RMSE that experiments of `runs` runs find for a method, as a multiple of the bound.
    ///
    /// A few runs in a thousand of the published filters are lost, and they make the RMSE: what 1,000 runs can show of
    /// it is only seen from many more.
    pub fn more_runs(&self, method: &Method, runs: usize, seed: u64) -> Result<Experiments> {
        const MORE_RUNS: u32 = 20_000;
        let pool: Vec<f64> = (0..MORE_RUNS)
            .into_par_iter()
            .progress_with(super::progress(MORE_RUNS.into(), "lost runs")?)
            .map(|run| {
                let mut rng = simulate::generator(!seed, run.into());
                let [x, y] = method.error(&self.track, &mut rng)?;
                Ok(x.hypot(y) / self.bound())
            })
            .collect::<Result<_>>()?;
        let experiments = Experiments::draw(&pool, runs, !seed);
        println!(
            "{}, in {MORE_RUNS} more runs: RMSE / bound of {runs} runs {:.2}, 99 % of the time {:.2} to {:.2}",
            method.label,
            experiments.quantile(0.5),
            experiments.quantile(0.005),
            experiments.quantile(0.995),
        );
        Ok(experiments)
    }

    pub fn floor(&self) -> &Outcomes {
        &self.methods[self.methods.len() - 1]
    }

    pub fn over_bound(&self, method: &Outcomes) -> Estimate {
        bootstrap(self.runs(), |runs| {
            root_mean_square(runs.map(|run| method.error(run))) / self.bound()
        })
    }

    /// Against the exact posterior mean of the same runs.
    pub fn over_floor(&self, method: &Outcomes) -> Estimate {
        let floor = self.floor();
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
    pub fn beyond_five_sigma(&self, method: &Outcomes) -> f64 {
        // NaN is beyond.
        1.0 - method.share(|outcome| mahalanobis(outcome.error, &self.bound) <= 5.0)
    }

    /// The RMSE of the named methods after each bearing.
    pub fn draw_errors(&self, keys: &[&str], stem: &Path) -> Result<()> {
        let bound = Curve {
            name: "Cramer-Rao bound".into(),
            points: self
                .bounds
                .iter()
                .enumerate()
                .filter_map(|(n, bound)| Some(((n + 1) as f64, (*bound)?)))
                .filter(|(_, bound)| *bound < 1000.0)
                .collect(),
            ..Curve::default()
        };
        let picture = Curves {
            title: format!(
                "Track {}: error after each bearing, {} runs",
                self.track.name,
                self.runs()
            ),
            horizontal: Axis::linear("bearings"),
            vertical: Axis::logarithmic("root mean square error, m"),
            curves: std::iter::once(bound)
                .chain(self.named(keys).filter_map(Outcomes::curve))
                .collect(),
        };
        picture::save(&picture.svg()?, stem)
    }

    /// Where the named methods thought the source to be after each bearing of the first run, once they were near.
    pub fn draw_run(&self, keys: &[&str], stem: &Path) -> Result<()> {
        let [x, y] = self.track.source;
        let near = 12.0 * self.bound();
        let paths = self.named(keys).map(|method| Curve {
            name: method.label.into(),
            points: method.runs[0]
                .path
                .iter()
                .flatten()
                .filter(|[dx, dy]| dx.hypot(*dy) < near)
                .map(|[dx, dy]| (x + dx, y + dy))
                .collect(),
            style: Style::DotsAndLine,
            ..Curve::default()
        });
        let truth = Curve {
            name: "source".into(),
            points: vec![(x, y)],
            style: Style::Dots,
            ..Curve::default()
        };
        let picture = Curves {
            title: format!(
                "Track {}: estimates within {near:.0} m in one run",
                self.track.name
            ),
            horizontal: Axis::linear("metres east"),
            vertical: Axis::linear("metres north"),
            curves: std::iter::once(truth).chain(paths).collect(),
        };
        picture::save(&picture.svg()?, stem)
    }

    fn named(&self, keys: &[&str]) -> impl Iterator<Item = &Outcomes> {
        self.methods
            .iter()
            .filter(|method| keys.contains(&method.key))
    }
}

impl Outcomes {
    fn error(&self, run: usize) -> f64 {
        let [x, y] = self.runs[run].error;
        x.hypot(y)
    }

    pub fn median(&self) -> Estimate {
        bootstrap(self.runs.len(), |runs| {
            median(runs.map(|run| self.error(run)))
        })
    }

    pub fn coverage(&self) -> f64 {
        self.share(|outcome| outcome.covered)
    }

    /// Per run.
    pub fn evaluations(&self) -> f64 {
        let sum: u64 = self.runs.iter().map(|outcome| outcome.evaluations).sum();
        sum as f64 / self.runs.len() as f64
    }

    fn share(&self, holds: impl Fn(&Outcome) -> bool) -> f64 {
        let count = self.runs.iter().filter(|outcome| holds(outcome)).count();
        count as f64 / self.runs.len() as f64
    }

    /// Mean error along x and y, as a share of the coordinates of the source.
    fn relative_errors(&self, source: [f64; 2]) -> [f64; 2] {
        let share = |outcome: &Outcome, d: usize| (outcome.error[d] / source[d]).abs();
        let sum = |d| self.runs.iter().map(|o| share(o, d)).sum::<f64>();
        [0, 1].map(|d| sum(d) / self.runs.len() as f64)
    }

    /// RMSE after each bearing, from where nearly all runs have an estimate; `None` if the method has one at the
    /// end only.
    fn curve(&self) -> Option<Curve> {
        let steps = self.runs[0].path.len();
        let (points, errors): (Vec<_>, Vec<_>) = (0..steps)
            .filter_map(|step| {
                let squares: Vec<f64> = self
                    .runs
                    .iter()
                    .filter_map(|outcome| outcome.path[step])
                    .map(|[x, y]| x * x + y * y)
                    .collect();
                let known = squares.len() as f64 >= 0.99 * self.runs.len() as f64;
                known.then(|| {
                    let rmse = Estimate::root_of_mean(&squares);
                    (((step + 1) as f64, rmse.value), rmse.error)
                })
            })
            .unzip();
        (!points.is_empty()).then(|| Curve {
            name: self.label.into(),
            points,
            errors,
            style: Style::Line,
        })
    }
}
