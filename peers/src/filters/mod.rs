//! The filters that are compared, each used as its documentation shows.

mod bayes_estimate;
mod foxhunt;
mod multicalc;

pub use self::bayes_estimate::BayesEstimate;
pub use self::foxhunt::Foxhunt;
pub use self::multicalc::Multicalc;

use crate::workload::Sighting;

/// A filter of `N` particles on the workload.
pub trait Filter<const N: usize> {
    /// Draws the initial cloud around the source.
    fn new(seed: u64) -> Self;

    /// Predicts, weighs by the bearing, normalises and resamples, and returns the mean; `None` if
    /// the crate reports that no weight is left.
    fn step(&mut self, sighting: &Sighting) -> Option<[f32; 2]>;
}
