//! What many runs of a locator say beside the exact posterior.

use anyhow::{Context, Result};
use foxhunt::aoa::Answer;
use foxhunt_host::{
    Sight,
    figures::Figure,
    reference::{Model, Posterior},
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::config;
use crate::papers::{
    outcome::Outcome,
    statistics::{Estimate, bootstrap, root_mean_square},
    study::progress,
};

/// One run of a locator, and the exact posterior.
#[derive(Clone, Copy)]
pub struct Run {
    pub ours: Outcome,
    pub exact: Outcome,
    /// Five standard deviations of the exact posterior.
    far: f64,
}

impl Run {
    pub fn new(answer: Answer, exact: &Posterior, source: [f64; 2]) -> Self {
        Self {
            ours: Outcome::of(answer, source),
            exact: Outcome::exact(exact, source),
            far: 5.0 * exact.covariance.trace().sqrt(),
        }
    }
}

/// The exact posterior of `sights` with the locators' prior, and otherwise by the `model`.
pub fn exact(sights: &[Sight], model: Model) -> Result<Posterior> {
    let first = sights.first().context("no bearings")?.position;
    let model = Model {
        prior: config::prior(first),
        ..model
    };
    Posterior::within(&config::everywhere(first), sights, &model).context("no posterior")
}

/// What is asked of a locator.
#[derive(Clone, Copy)]
pub struct Limits {
    /// The most that its RMSE may be, in that of the exact posterior.
    pub ratio: f64,
    /// The least and the most that the 95 % ellipse holds the source, as fractions of the runs.
    pub covered: [f64; 2],
}

pub const HEADER: [&str; 8] = [
    "condition",
    "RMSE m",
    "the exact's",
    "RMSE / exact",
    "95 % ellipse holds",
    "the exact's",
    "lost, and the exact's",
    "no fix",
];

/// All runs of a condition.
pub struct Runs(Vec<Run>);

impl Runs {
    /// Runs 0 to `runs`.
    pub fn new(
        runs: u32,
        what: &str,
        one: impl Fn(u64) -> Result<Run> + Sync + Send,
    ) -> Result<Self> {
        let all = (0..u64::from(runs))
            .into_par_iter()
            .progress_with(progress(runs.into(), what.to_owned())?)
            .map(one)
            .collect::<Result<_>>()?;
        Ok(Self(all))
    }

    fn fraction(&self, is: impl Fn(&Run) -> bool) -> f64 {
        self.0.iter().filter(|run| is(run)).count() as f64 / self.0.len() as f64
    }

    /// RMSE of those with a fix, ours and the exact posterior's.
    fn rmse(&self) -> [f64; 2] {
        let fixes = || self.0.iter().filter(|run| run.ours.error.is_finite());
        [
            root_mean_square(fixes().map(|run| run.ours.error)),
            root_mean_square(fixes().map(|run| run.exact.error)),
        ]
    }

    fn ratio(&self) -> Estimate {
        bootstrap(self.0.len(), |runs| {
            let fixes = runs.map(|run| &self.0[run]);
            let fixes = fixes.filter(|run| run.ours.error.is_finite());
            let (ours, exact): (Vec<f64>, Vec<f64>) =
                fixes.map(|run| (run.ours.error, run.exact.error)).unzip();
            root_mean_square(ours.into_iter()) / root_mean_square(exact.into_iter())
        })
    }

    fn no_fix(&self) -> f64 {
        self.fraction(|run| !run.ours.error.is_finite())
    }

    fn lost(&self) -> [f64; 2] {
        [
            self.fraction(|run| !(run.ours.error <= run.far)),
            self.fraction(|run| run.exact.error > run.far),
        ]
    }

    pub fn row(&self, condition: &str) -> [String; 8] {
        let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
        let [ours, exact] = self.rmse();
        let [lost, exact_lost] = self.lost();
        [
            condition.to_owned(),
            format!("{ours:.3}"),
            format!("{exact:.3}"),
            self.ratio().to_string(),
            percent(self.fraction(|run| run.ours.covered)),
            percent(self.fraction(|run| run.exact.covered)),
            format!("{}, {}", percent(lost), percent(exact_lost)),
            percent(self.no_fix()),
        ]
    }

    /// Figures without limits.
    pub fn reported(&self, prefix: &str) -> [Figure; 4] {
        let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
        let [lost, exact_lost] = self.lost();
        [
            figure("rmse_over_exact", self.ratio().value, ""),
            figure("covered", self.fraction(|run| run.ours.covered), "of runs"),
            figure("lost", lost - exact_lost, "of runs more than the exact"),
            figure("no_fix", self.no_fix(), "of runs"),
        ]
    }

    /// Those that no more runs may be lost of than of the exact posterior's.
    pub fn kept(&self, prefix: &str) -> Vec<Figure> {
        let [ratio, covered, lost, no_fix] = self.reported(prefix);
        vec![ratio, covered, lost.at_most(0.0), no_fix]
    }

    pub fn figures(&self, prefix: &str, limits: &Limits) -> Vec<Figure> {
        let [ratio, covered, lost, no_fix] = self.reported(prefix);
        let [least, most] = limits.covered;
        let missed = Figure::new(format!("{prefix}.missed"), 1.0 - covered.value, "of runs");
        vec![
            ratio.at_most(limits.ratio),
            covered.at_most(most),
            missed.at_most(1.0 - least),
            lost.at_most(0.0),
            no_fix.at_most(0.0),
        ]
    }
}
