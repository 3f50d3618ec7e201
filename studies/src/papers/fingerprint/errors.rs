//! Errors of many runs.

use foxhunt_host::picture::Curve;

use crate::papers::statistics::Estimate;

/// From here on an estimate is not near any more, in metres.
pub const NEAR: f64 = 2.0;
/// From here on it is lost.
pub const LOST: f64 = 20.0;

/// The errors of one method, in metres: by run, then by step.
#[derive(Debug, Clone, Default)]
pub struct Errors(Vec<Vec<f64>>);

impl Errors {
    pub fn push(&mut self, run: Vec<f64>) {
        self.0.push(run);
    }

    /// Those of all steps but the first so many of each run.
    pub fn after(&self, steps: usize) -> Self {
        let later = |run: &Vec<f64>| run.iter().skip(steps).copied().collect();
        Self(self.0.iter().map(later).collect())
    }

    pub fn runs(&self) -> usize {
        self.0.len()
    }

    /// All of them, in rising order.
    pub fn sorted(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.0.iter().flatten().map(|error| error.abs()).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// The error that this fraction of the steps does not exceed.
    pub fn quantile(&self, fraction: f64) -> f64 {
        let all = self.sorted();
        all[((all.len() - 1) as f64 * fraction) as usize]
    }

    /// The mean of a function of the error, run by run.
    fn by_run(&self, of: impl Fn(f64) -> f64) -> Vec<f64> {
        let mean = |run: &Vec<f64>| run.iter().map(|e| of(*e)).sum::<f64>() / run.len() as f64;
        self.0.iter().map(mean).collect()
    }

    /// Mean squares, run by run.
    pub fn squares(&self) -> Vec<f64> {
        self.by_run(|error| error * error)
    }

    pub fn rmse(&self) -> Estimate {
        Estimate::root_of_mean(&self.squares())
    }

    /// Fraction of the steps with an error below [`NEAR`].
    pub fn near(&self) -> Estimate {
        Estimate::mean(&self.by_run(|error| f64::from(u8::from(error.abs() < NEAR))))
    }

    /// Fraction of the steps with an error above [`LOST`], run by run.
    pub fn lost_by_run(&self) -> Vec<f64> {
        self.by_run(|error| f64::from(u8::from(error.abs() > LOST)))
    }

    pub fn lost(&self) -> f64 {
        Estimate::mean(&self.lost_by_run()).value
    }

    /// The fraction of the steps below each error, up to `most` metres.
    pub fn curve(&self, name: &str, most: f64) -> Curve {
        const POINTS: u32 = 240;
        let all = self.sorted();
        let below = |error: f64| all.partition_point(|e| *e < error) as f64 / all.len() as f64;
        let errors = (0..=POINTS).map(|n| most * f64::from(n) / f64::from(POINTS));
        Curve {
            name: name.to_owned(),
            points: errors.map(|error| (error, 100.0 * below(error))).collect(),
            ..Curve::default()
        }
    }
}
