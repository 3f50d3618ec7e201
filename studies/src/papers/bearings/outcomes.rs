//! All runs of one method.

use super::problem::Outcome;
use crate::papers::statistics::{Estimate, bootstrap, median};

/// All runs of one method.
pub struct Outcomes {
    pub label: &'static str,
    pub key: &'static str,
    /// Of a run; zero of the exact posterior, which is not for boards.
    pub instructions: f64,
    pub(super) runs: Vec<Outcome>,
}

impl Outcomes {
    /// The length of the last error in a run, in metres.
    pub(super) fn error(&self, run: usize) -> f64 {
        let [x, y] = self.runs[run].error;
        x.hypot(y)
    }

    pub fn median(&self) -> Estimate {
        bootstrap(self.runs.len(), |runs| {
            median(runs.map(|run| self.error(run)))
        })
    }

    pub fn coverage(&self) -> f64 {
        self.fraction(|outcome| outcome.covered)
    }

    /// Per run.
    pub fn evaluations(&self) -> f64 {
        let sum: u64 = self.runs.iter().map(|outcome| outcome.evaluations).sum();
        sum as f64 / self.runs.len() as f64
    }

    /// The fraction of the runs of which something holds.
    pub(super) fn fraction(&self, holds: impl Fn(&Outcome) -> bool) -> f64 {
        let count = self.runs.iter().filter(|outcome| holds(outcome)).count();
        count as f64 / self.runs.len() as f64
    }

    /// Mean error along x and y, as fractions of the coordinates of the source.
    pub(super) fn relative_errors(&self, source: [f64; 2]) -> [f64; 2] {
        let relative = |outcome: &Outcome, d: usize| (outcome.error[d] / source[d]).abs();
        let sum = |d| self.runs.iter().map(|o| relative(o, d)).sum::<f64>();
        [0, 1].map(|d| sum(d) / self.runs.len() as f64)
    }
}
