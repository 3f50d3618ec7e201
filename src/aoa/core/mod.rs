//! What the locators of one stationary source share: the bearings that they keep, the moves of their particles, and the
//! tests whether there is a fix.

mod buffer;
mod sweep;

use super::NotObservable;
use crate::math::{larger, sqrt};
pub(super) use buffer::{Buffer, Comparison, Entry, square_of_distance};
pub(super) use sweep::{BLOCK, Block, Importance, Proposal, Target, sweep};

/// Whether `count` particles of this effective sample size are to be resampled and moved.
pub(super) fn is_depleted(effective_sample_size: f32, count: usize, fraction: f32) -> bool {
    let needed = fraction * count as f32;
    // A single particle that is left has no covariance to say so.
    effective_sample_size < larger(needed, 2.0)
}

/// Test against the hypothesis that the bearings are parallel (source at infinity), by the likelihood ratio. The curvature
/// alone misleads: errors make parallel bearings cross near the vehicle.
pub(in crate::aoa) struct Crossing {
    /// Twice the gain in log-likelihood of the best place over the best direction at infinity.
    pub(in crate::aoa) gain: f32,
    /// Sum of the information of the bearings, 1 / sigma^2.
    pub(in crate::aoa) information: f32,
    /// Largest standard deviation of the range that makes a fix, as a fraction of the range.
    pub(in crate::aoa) limit: f32,
    /// Gain that is enough, in those of bearings by which the range is just known well enough: 1 where nothing else tells
    /// that the source is not far away.
    pub(in crate::aoa) enough: f32,
}

impl Crossing {
    /// The reason of bearings that do not cross far enough.
    pub(in crate::aoa) fn reason(&self) -> NotObservable {
        let gain = larger(self.gain, 0.0);
        NotObservable::CrossingAngle {
            have_rad: 2.0 * sqrt(gain / self.information),
            // Two halves of the bearings that differ by this angle have a likelihood ratio of 1 / (2 limit^2).
            needed_rad: 2.0 * sqrt(self.enough / self.information) / self.limit,
        }
    }

    /// Whether the bearings make a fix about a place with this largest variance, at this squared range.
    ///
    /// # Errors
    /// The reason why not.
    pub(in crate::aoa) fn check(&self, variance: f32, range: f32) -> Result<(), NotObservable> {
        if self.gain * self.limit * self.limit < self.enough {
            return Err(self.reason());
        }
        check_narrow(variance, range, self.limit)
    }
}

/// Whether the largest variance of a position is small beside its squared range.
///
/// # Errors
/// How large it is, if it is not.
pub(in crate::aoa) fn check_narrow(
    variance: f32,
    range: f32,
    limit: f32,
) -> Result<(), NotObservable> {
    if is_narrow(variance, range, limit) {
        return Ok(());
    }
    Err(NotObservable::WideRange {
        have: sqrt(variance / range),
        needed: limit,
    })
}

/// Whether it is.
pub(in crate::aoa) fn is_narrow(variance: f32, range: f32, limit: f32) -> bool {
    variance <= limit * limit * range
}
