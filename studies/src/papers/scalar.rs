//! A state of one dimension over some steps: methods on the same measurements, beside the exact filter.

use foxhunt_simulation::random;
use std::ops::Range;

use anyhow::Result;
use foxhunt::{
    proposal::{Sensor, Transition},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    figures::Figure,
    picture::{Axis, Curve, Curves, Style},
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{
    counted::Counter,
    statistics::{Estimate, bootstrap, median},
    study::{Study, progress},
};
use crate::methods::scalar::{self as methods, Visit};

/// Steps of a run, in both papers.
pub const STEPS: usize = 50;

/// One run: what a method may know, and what it should find.
pub struct Problem<T, M> {
    /// The state before the first step.
    pub start: f32,
    /// How the state comes to each step, and what is measured there.
    pub steps: Vec<(T, M)>,
    /// The states.
    pub truth: Vec<f64>,
    /// The exact posterior means.
    pub exact: Vec<f64>,
}

/// What a method made of one run.
#[derive(Debug, Clone, Default)]
pub struct Estimates {
    pub means: Vec<f64>,
    /// Steps in which the middle 95 % of the cloud hold the state.
    covered: usize,
    /// Calls of the model.
    pub calls: u64,
}

/// A method to run.
pub struct Method<P> {
    pub label: &'static str,
    /// In the names of figures.
    pub key: &'static str,
    /// Instructions of a run.
    pub instructions: f64,
    run: Box<Run<P>>,
}

type Run<P> = dyn Fn(&P, &mut Xoshiro128PlusPlus) -> Estimates + Sync;

/// The methods that the study of this name hands to a visitor, with what the board took for each.
pub fn methods_of<P>(
    study: &Study,
    name: &str,
    visit: impl FnOnce(&mut Collected<P>),
) -> Result<Vec<Method<P>>> {
    let mut collected = Collected(Vec::new());
    visit(&mut collected);
    let instructions = study.instructions(name)?;
    let mut methods = collected.0;
    for method in &mut methods {
        method.instructions = instructions.per_run(method.label)?.value;
    }
    Ok(methods)
}

/// Methods as a study hands them over.
pub struct Collected<P>(Vec<Method<P>>);

impl<T: Transition<1> + Copy, M: Sensor<1, 1> + Copy> Visit for Collected<Problem<T, M>> {
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
            run: Box::new(move |problem, rng| track(problem, &method, rng)),
        });
    }
}

fn track<T: Transition<1> + Copy, M: Sensor<1, 1> + Copy>(
    problem: &Problem<T, M>,
    method: &impl methods::Method,
    rng: &mut Xoshiro128PlusPlus,
) -> Estimates {
    let counter = Counter::default();
    let counted =
        |&(dynamics, measurement): &(T, M)| (counter.of(dynamics), counter.of(measurement));
    let mut estimates = Estimates::default();
    let steps = problem.steps.iter().map(counted);
    method.track(problem.start, steps, rng, |mean, column, log_weights| {
        let state = problem.truth[estimates.means.len()];
        estimates.means.push(mean.into());
        estimates.covered += usize::from(covers(column, log_weights, state));
    });
    estimates.calls = counter.calls();
    estimates
}

/// Whether the middle 95 % of a cloud hold a state.
fn covers(column: &[f32], log_weights: &[f32], state: f64) -> bool {
    let highest = log_weights.iter().copied().fold(f32::MIN, f32::max);
    let [mut below, mut above, mut all] = [0.0; 3];
    for (x, log_weight) in column.iter().zip(log_weights) {
        let (x, weight) = (f64::from(*x), f64::from(log_weight - highest).exp());
        all += weight;
        below += if x <= state { weight } else { 0.0 };
        above += if x >= state { weight } else { 0.0 };
    }
    below >= 0.025 * all && above >= 0.025 * all
}

/// A fraction, if there is one.
pub fn percent(fraction: Option<f64>) -> String {
    fraction.map_or_else(String::new, |fraction| format!("{:.1} %", 100.0 * fraction))
}

/// All runs of all methods.
pub struct Experiment {
    /// The exact filter is the last of them.
    pub methods: Vec<Outcomes>,
    /// The states of the first run.
    truth: Vec<f64>,
}

/// All runs of one method.
pub struct Outcomes {
    pub label: &'static str,
    pub key: &'static str,
    /// Of a run; zero of the exact filter, which is not for boards.
    pub instructions: f64,
    /// Estimates in the first run.
    first: Vec<f64>,
    /// Squared errors, of each run and step.
    squares: Vec<Vec<f64>>,
    covered: usize,
    calls: u64,
}

pub const FLOOR: &str = "floor";

impl Experiment {
    /// Runs every method on the problem of each run.
    pub fn run<T: Sync + Send, M: Sync + Send>(
        name: String,
        problem: impl Fn(u64) -> Problem<T, M> + Sync,
        mut methods: Vec<Method<Problem<T, M>>>,
        runs: u32,
        seed: u64,
    ) -> Result<Self> {
        methods.push(Method {
            label: "exact filter (floor)",
            key: FLOOR,
            instructions: 0.0,
            run: Box::new(|problem: &Problem<T, M>, _| Estimates {
                means: problem.exact.clone(),
                ..Estimates::default()
            }),
        });
        let run = |run: u32| {
            let problem = problem(run.into());
            let mut rng = random::generator(!seed, run.into());
            let of_method = |method: &Method<_>| {
                let mut own = Xoshiro128PlusPlus::from_rng(&mut rng);
                (method.run)(&problem, &mut own)
            };
            let estimates: Vec<Estimates> = methods.iter().map(of_method).collect();
            (problem.truth, estimates)
        };
        let all: Vec<(Vec<f64>, Vec<Estimates>)> = (0..runs)
            .into_par_iter()
            .progress_with(progress(runs.into(), name)?)
            .map(run)
            .collect();
        let outcomes = |(index, method): (usize, Method<_>)| Outcomes {
            label: method.label,
            key: method.key,
            instructions: method.instructions,
            first: all[0].1[index].means.clone(),
            squares: all
                .iter()
                .map(|(truth, estimates)| {
                    let means = &estimates[index].means;
                    truth
                        .iter()
                        .zip(means)
                        .map(|(x, m)| (x - m).powi(2))
                        .collect()
                })
                .collect(),
            covered: all
                .iter()
                .map(|(_, estimates)| estimates[index].covered)
                .sum(),
            calls: all
                .iter()
                .map(|(_, estimates)| estimates[index].calls)
                .sum(),
        };
        Ok(Self {
            methods: methods.into_iter().enumerate().map(outcomes).collect(),
            truth: all[0].0.clone(),
        })
    }

    pub fn runs(&self) -> usize {
        self.floor().squares.len()
    }

    pub fn floor(&self) -> &Outcomes {
        &self.methods[self.methods.len() - 1]
    }

    pub fn named(&self, key: &str) -> Option<&Outcomes> {
        self.methods.iter().find(|method| method.key == key)
    }

    /// RMSE over all steps of all runs together, as a multiple of that of the exact filter.
    pub fn pooled_over_floor(&self, method: &Outcomes) -> Estimate {
        let (ours, theirs) = (method.mean_squares(), self.floor().mean_squares());
        bootstrap(ours.len(), |runs| {
            let (mut a, mut b) = (0.0, 0.0);
            for run in runs {
                a += ours[run];
                b += theirs[run];
            }
            (a / b).sqrt()
        })
    }

    /// Mean over the runs of the RMSE of each, as a multiple of that of the exact filter.
    pub fn mean_over_floor(&self, method: &Outcomes) -> Estimate {
        let (ours, theirs) = (method.rmses(), self.floor().rmses());
        bootstrap(ours.len(), |runs| {
            let (mut a, mut b) = (0.0, 0.0);
            for run in runs {
                a += ours[run];
                b += theirs[run];
            }
            a / b
        })
    }

    /// The RMSE of the named methods at each step, logarithmic, and their estimates in one run.
    pub fn picture(&self, title: &str, keys: &[&str]) -> Result<String> {
        let named = || keys.iter().filter_map(|key| self.named(key));
        let steps = |values: &[f64]| (1..).map(f64::from).zip(values.iter().copied()).collect();
        let truth = Curve {
            name: "truth".into(),
            points: steps(&self.truth),
            ..Curve::default()
        };
        let one = Curves {
            title: format!("{title}: one run"),
            horizontal: Axis::linear("step"),
            vertical: Axis::linear("state"),
            curves: std::iter::once(truth)
                .chain(named().map(|method| Curve {
                    name: method.label.into(),
                    points: steps(&method.first),
                    style: Style::DotsAndLine,
                    ..Curve::default()
                }))
                .collect(),
        };
        // Black is the truth: the first colour is left to it.
        let none = Curve::default();
        let errors = Curves {
            title: format!("{title}: error at each step, {} runs", self.runs()),
            horizontal: Axis::linear("step"),
            vertical: Axis::logarithmic("root mean square error"),
            curves: std::iter::once(none)
                .chain(named().map(Outcomes::curve))
                .collect(),
        };
        Curves::grid(&[one, errors], 2)
    }
}

impl Outcomes {
    /// RMSE over all steps of all runs together.
    pub fn pooled(&self) -> Estimate {
        Estimate::root_of_mean(&self.mean_squares())
    }

    /// Mean over the runs of the RMSE of each.
    pub fn mean(&self) -> Estimate {
        Estimate::mean(&self.rmses())
    }

    /// Variance over the runs of the RMSE of each.
    pub fn variance(&self) -> f64 {
        let rmses = self.rmses();
        self.mean().error.powi(2) * rmses.len() as f64
    }

    pub fn median(&self) -> f64 {
        median(self.rmses().into_iter())
    }

    /// Of each run.
    pub fn rmses(&self) -> Vec<f64> {
        self.mean_squares().into_iter().map(f64::sqrt).collect()
    }

    /// Calls of the model, per run.
    pub fn calls(&self) -> f64 {
        self.calls as f64 / self.squares.len() as f64
    }

    /// Fraction of the steps in which the middle 95 % of the cloud hold the state; nothing of the exact filter, which
    /// has no cloud here.
    pub fn coverage(&self) -> Option<f64> {
        let steps = self.squares.len() * self.squares[0].len();
        (self.calls > 0).then(|| self.covered as f64 / steps as f64)
    }

    /// What a run takes, and the coverage, as figures; of the exact filter there are none.
    pub fn cost_and_coverage(
        &self,
        figure: impl Fn(&str, f64, &'static str) -> Figure,
    ) -> Vec<Figure> {
        let mut figures = Vec::new();
        if self.key != FLOOR {
            figures.push(figure("calls", self.calls(), "per run"));
            figures.push(figure("instructions", self.instructions, "per run"));
        }
        let coverage = self.coverage();
        figures.extend(coverage.map(|fraction| figure("coverage", fraction, "of steps")));
        figures
    }

    /// Mean squared error of each run.
    fn mean_squares(&self) -> Vec<f64> {
        let mean = |run: &Vec<f64>| run.iter().sum::<f64>() / run.len() as f64;
        self.squares.iter().map(mean).collect()
    }

    fn curve(&self) -> Curve {
        let steps: Range<usize> = 0..self.squares[0].len();
        let (points, errors) = steps
            .map(|step| {
                let squares: Vec<f64> = self.squares.iter().map(|run| run[step]).collect();
                let rmse = Estimate::root_of_mean(&squares);
                (((step + 1) as f64, rmse.value), rmse.error)
            })
            .unzip();
        Curve {
            name: self.label.into(),
            points,
            errors,
            style: Style::Line,
        }
    }
}
