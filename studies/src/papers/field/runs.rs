//! What many runs of a locator say beside the exact posterior.

use anyhow::{Context, Result};
use foxhunt::aoa::Answer;
use foxhunt_host::{
    figures::Figure,
    reference::{Model, Posterior},
};
use foxhunt_simulation::Sight;
use indicatif::ParallelProgressIterator;
use nalgebra::Vector2;
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
    /// Whether the exact posterior makes a fix: with a margin for what a locator may find otherwise.
    pub fix: bool,
}

/// Of the largest relative standard deviation of range that makes a fix.
const MARGIN: f64 = 0.8;

impl Run {
    /// From the last answer, after a bearing taken at `last`.
    pub fn new(answer: Answer, exact: &Posterior, source: [f64; 2], last: [f64; 2]) -> Self {
        let sight = Vector2::from(exact.mean) - Vector2::from(last);
        let range = sight.norm();
        let along = sight.dot(&(exact.covariance * sight)).sqrt() / range;
        Self {
            ours: Outcome::of(answer, source),
            exact: Outcome::exact(exact, source),
            far: 5.0 * exact.covariance.trace().sqrt(),
            fix: along < MARGIN * config::RANGE_SIGMA * range,
        }
    }
}

/// The exact posterior of `sights` with the locators' prior, and otherwise by the `model`.
pub fn exact(sights: &[Sight], model: Model) -> Result<Posterior> {
    exact_within(config::RANGE_M, sights, model)
}

/// The same of a locator for sources within a range.
pub fn exact_within(range_m: f64, sights: &[Sight], model: Model) -> Result<Posterior> {
    let square = config::everywhere(sights).context("no bearings")?;
    let model = Model {
        prior: config::prior(sights, range_m).context("no bearings")?,
        ..model
    };
    Posterior::within_nearly(&square, sights, &model).context("no posterior")
}

/// What is asked of a locator.
#[derive(Clone, Copy)]
pub struct Limits {
    /// The most that its RMSE may be, in that of the exact posterior.
    pub ratio: f64,
    /// The least and the most that the 95 % ellipse holds the source, as fractions of the fixes.
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
    "no fix, though the exact has",
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

    /// Of the fixes.
    fn coverage(&self) -> f64 {
        let fixes = self.fraction(|run| run.ours.error.is_finite());
        self.fraction(|run| run.ours.covered) / fixes
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

    /// All that have no fix, and those in which the exact posterior has one.
    fn no_fix(&self) -> [f64; 2] {
        let none = |run: &Run| !run.ours.error.is_finite();
        [
            self.fraction(none),
            self.fraction(|run| none(run) && run.fix),
        ]
    }

    fn lost(&self) -> [f64; 2] {
        [
            self.fraction(|run| run.ours.error.is_finite() && run.ours.error > run.far),
            self.fraction(|run| run.exact.error > run.far),
        ]
    }

    pub fn row(&self, condition: &str) -> [String; 8] {
        let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
        let [ours, exact] = self.rmse();
        let [lost, exact_lost] = self.lost();
        let [no_fix, missing] = self.no_fix();
        let coverage = self.coverage();
        [
            condition.to_owned(),
            format!("{ours:.3}"),
            format!("{exact:.3}"),
            self.ratio().to_string(),
            percent(coverage),
            percent(self.fraction(|run| run.exact.covered)),
            format!("{}, {}", percent(lost), percent(exact_lost)),
            format!("{}, {}", percent(no_fix), percent(missing)),
        ]
    }

    /// Figures without limits.
    pub fn reported(&self, prefix: &str) -> [Figure; 4] {
        let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
        let [lost, exact_lost] = self.lost();
        [
            figure("rmse_over_exact", self.ratio().value, ""),
            figure("covered", self.coverage(), "of fixes"),
            figure("lost", lost - exact_lost, "of runs more than the exact"),
            figure("missing", self.no_fix()[1], "of runs"),
        ]
    }

    /// Those that no more runs may be lost of than of the exact posterior's.
    pub fn kept(&self, prefix: &str) -> Vec<Figure> {
        let [ratio, covered, lost, missing] = self.reported(prefix);
        vec![ratio, covered, lost.at_most(0.0), missing]
    }

    pub fn figures(&self, prefix: &str, limits: &Limits) -> Vec<Figure> {
        let [ratio, covered, lost, missing] = self.reported(prefix);
        let [least, most] = limits.covered;
        let missed = Figure::new(format!("{prefix}.missed"), 1.0 - covered.value, "of fixes");
        vec![
            ratio.at_most(limits.ratio),
            covered.at_most(most),
            missed.at_most(1.0 - least),
            lost.at_most(0.0),
            missing.at_most(0.0),
        ]
    }
}
