//! Whether a fix claims more than it knows.

use std::fmt;

use foxhunt::aoa::Fix;
use foxhunt_host::reference::mahalanobis;

/// How far the true place is from a fix, in the standard deviations that the fix claims: its Mahalanobis
/// distance.
#[derive(Debug, Clone, Copy)]
pub struct Coverage(f64);

/// The 95 % ellipse is at this distance: the root of -2 ln(1 - 0.95).
const ELLIPSE: f64 = 2.448;
/// A normal distribution has a thousandth beyond this distance: chance is no excuse.
const CHANCE: f64 = 3.717;

impl Coverage {
    /// Of `truth`, in metres from the origin of the fix.
    pub fn new(fix: &Fix, truth: [f64; 2]) -> Self {
        let offset = [0, 1].map(|d| truth[d] - f64::from(fix.position[d]));
        let covariance = fix.covariance.rows().map(|row| row.map(f64::from));
        Self(mahalanobis(offset, &covariance.into()))
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(distance) = *self;
        let (side, remark) = if distance <= ELLIPSE {
            ("inside", "")
        } else if distance <= CHANCE {
            ("outside", ": one time in twenty that is chance")
        } else {
            (
                "outside",
                ": these bearings have errors in common, which the model takes to be independent",
            )
        };
        write!(
            f,
            "the true place is {side} the 95 % ellipse ({distance:.1} standard deviations){remark}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truth_inside_at_the_edge_and_far_outside() {
        let fix = Fix {
            position: [10.0, 20.0],
            covariance: [[4.0, 0.0], [0.0, 1.0]].into(),
            effective_sample_size: 100.0,
            bearings: 10,
        };
        for (truth, inside, words) in [
            ([14.0, 20.0], true, "is inside the 95 % ellipse (2.0 "),
            ([10.0, 23.0], false, "(3.0 standard deviations): one time"),
            ([10.0, 12.9], false, "(7.1 standard deviations): these"),
        ] {
            let text = Coverage::new(&fix, truth).to_string();
            assert!(text.contains(words), "{text}");
            let ellipse = fix.ellipse(0.95);
            assert_eq!(ellipse.contains(truth.map(|v| v as f32)), inside);
        }
    }
}
