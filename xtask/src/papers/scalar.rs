//! A state of one dimension over some steps: methods on the same measurements, beside the exact filter.

pub mod methods;

use std::{ops::Range, path::Path};

use anyhow::Result;
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
use foxhunt_host::{
    picture::{self, Axis, Curve, Curves, Style},
    simulate,
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::statistics::{Estimate, bootstrap, median};

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
#[derive(Debug, Clone)]
pub struct Estimates {
    pub means: Vec<f64>,
    /// Calls of the model.
    pub calls: u64,
}

/// A method to run.
pub struct Method<P> {
    pub label: String,
    /// In the names of figures.
    pub key: &'static str,
    run: Box<Run<P>>,
}

type Run<P> = dyn Fn(&P, &mut Xoshiro128PlusPlus) -> Estimates + Sync;

impl<P> Method<P> {
    pub fn new(
        label: impl Into<String>,
        key: &'static str,
        run: impl Fn(&P, &mut Xoshiro128PlusPlus) -> Estimates + Sync + 'static,
    ) -> Self {
        Self {
            label: label.into(),
            key,
            run: Box::new(run),
        }
    }
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
    pub label: String,
    pub key: &'static str,
    /// Estimates in the first run.
    first: Vec<f64>,
    /// Squared errors, of each run and step.
    squares: Vec<Vec<f64>>,
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
        methods.push(Method::new(
            "exact filter (floor)",
            FLOOR,
            |problem: &Problem<T, M>, _| Estimates {
                means: problem.exact.clone(),
                calls: 0,
            },
        ));
        let run = |run: u32| {
            let problem = problem(run.into());
            let mut rng = simulate::generator(!seed, run.into());
            let of_method = |method: &Method<_>| {
                let mut own = Xoshiro128PlusPlus::from_rng(&mut rng);
                (method.run)(&problem, &mut own)
            };
            let estimates: Vec<Estimates> = methods.iter().map(of_method).collect();
            (problem.truth, estimates)
        };
        let all: Vec<(Vec<f64>, Vec<Estimates>)> = (0..runs)
            .into_par_iter()
            .progress_with(super::progress(runs.into(), name)?)
            .map(run)
            .collect();
        let outcomes = |(index, method): (usize, Method<_>)| Outcomes {
            label: method.label,
            key: method.key,
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
    pub fn draw(&self, title: &str, keys: &[&str], stem: &Path) -> Result<()> {
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
                    name: method.label.clone(),
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
        picture::save(&Curves::grid(&[one, errors], 2)?, stem)
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
            name: self.label.clone(),
            points,
            errors,
            style: Style::Line,
        }
    }
}
