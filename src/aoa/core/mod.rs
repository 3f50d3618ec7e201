//! What the locators of one stationary source share: the bearings that they keep, the moves of their particles, and the
//! tests whether there is a fix.

mod buffer;
mod entry;
mod observability;
mod sweep;

pub(super) use buffer::Buffer;
pub(super) use entry::{Comparison, Entry};
pub(super) use observability::{Crossing, is_narrow};
pub(super) use sweep::{BLOCK, Block, Proposal, Target, sweep};

/// Whether particles that are worth so many of `count` are to be resampled and moved.
pub(super) fn is_depleted(effective_sample_size: f32, count: usize, fraction: f32) -> bool {
    let needed = fraction * count as f32;
    // A single particle that is left has no covariance to say so.
    effective_sample_size < if needed > 2.0 { needed } else { 2.0 }
}
