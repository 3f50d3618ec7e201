//! What the locators of one stationary source share: the bearings that they keep, the moves of their particles, and the
//! tests whether there is a fix.

mod buffer;
mod sweep;

use super::NotObservable;
use crate::math::sqrt;
pub(super) use buffer::{Buffer, Comparison, Entry, square_of_distance};
pub(super) use sweep::{BLOCK, Block, Proposal, Target, sweep};

/// Whether particles that are worth so many of `count` are to be resampled and moved.
pub(super) fn is_depleted(effective_sample_size: f32, count: usize, fraction: f32) -> bool {
    let needed = fraction * count as f32;
    // A single particle that is left has no covariance to say so.
    effective_sample_size < if needed > 2.0 { needed } else { 2.0 }
}

/// How far bearings rule out that they are parallel, that the source is anywhere up to infinity: by the likelihood ratio,
/// because the curvature of the likelihood alone is deceived by the intersections that errors make of parallel bearings,
/// among the vehicle's own places.
pub(in crate::aoa) struct Crossing {
    /// Twice the gain in log-likelihood of the best place over the best direction at infinity.
    pub(in crate::aoa) gain: f32,
    /// Sum of the information of the bearings, 1 / sigma^2.
    pub(in crate::aoa) information: f32,
    /// Largest standard deviation of the range that makes a fix, as a fraction of the range.
    pub(in crate::aoa) limit: f32,
}

impl Crossing {
    /// The reason of bearings that do not cross far enough.
    pub(in crate::aoa) fn reason(&self) -> NotObservable {
        let gain = if self.gain > 0.0 { self.gain } else { 0.0 };
        NotObservable::CrossingAngle {
            have_rad: 2.0 * sqrt(gain / self.information),
            // Two halves of the bearings that differ by this angle have a likelihood ratio of 1 / (2 limit^2).
            needed_rad: 2.0 / (self.limit * sqrt(self.information)),
        }
    }

    /// Whether the bearings make a fix about a place with this largest variance, at this squared range.
    ///
    /// # Errors
    /// The reason why not.
    pub(in crate::aoa) fn check(&self, variance: f32, range: f32) -> Result<(), NotObservable> {
        let crosses = self.gain * self.limit * self.limit >= 1.0;
        if crosses && is_narrow(variance, range, self.limit) {
            Ok(())
        } else {
            Err(self.reason())
        }
    }
}

/// Whether a largest variance is small beside a squared range.
pub(in crate::aoa) fn is_narrow(variance: f32, range: f32, limit: f32) -> bool {
    variance <= limit * limit * range
}
