//! What the locators of one stationary source share: the bearings that they keep, the moves of their particles, and the
//! tests whether there is a fix.

mod buffer;
mod entry;
mod sweep;

use super::NotObservable;
use crate::math::{larger, sqrt};
pub(super) use buffer::Buffer;
pub(super) use entry::{Comparison, Entry, square_of_distance};
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::{Bearing, Observation, PushError, Retract};

    /// Bearings a second and ten metres apart, from the first second and the origin on.
    fn buffer<const B: usize>(count: u16) -> Buffer<B> {
        let mut buffer = Buffer::EMPTY;
        for i in 0..count {
            let bearing = Bearing::from_radians(0.1);
            let east = 10.0 * f32::from(i);
            let taken = Observation::new(1_000 * (1 + u32::from(i)), [east, 0.0], bearing, 0.1);
            let taken = taken.unwrap();
            buffer.note(&taken, 1.0);
            buffer.add(Entry::new(taken, 1.0), &None);
        }
        buffer
    }

    /// How many bearings of three, apart, or two of them averaged, are taken back, how many stay for being merged, and how
    /// many are left.
    fn retracted<const B: usize>(what: Retract) -> [u32; 3] {
        let mut buffer = buffer::<B>(3);
        let retracted = buffer.retract(&what);
        [retracted.bearings, retracted.merged, buffer.count()]
    }

    #[test]
    fn a_bearing_is_admitted_once_and_not_before_all_others() {
        let buffer = buffer::<2>(3);
        let admit = |time_ms, station| {
            let taken = Observation::new(time_ms, [0.0; 2], Bearing::from_radians(0.1), 0.1);
            buffer.admit(&taken.unwrap().from_station(station))
        };
        // Of those that were averaged, the first and the last are known.
        for time_ms in [1_000, 2_000, 3_000] {
            assert_eq!(admit(time_ms, 0), Err(PushError::Duplicate), "{time_ms}");
            assert_eq!(admit(time_ms, 1), Ok(()));
        }
        assert_eq!((admit(1_500, 0), admit(3_001, 0)), (Ok(()), Ok(())));
        assert_eq!(admit(999, 0), Err(PushError::TooOld));
        assert_eq!(
            Buffer::<2>::EMPTY.admit(&buffer.entries()[0].observation),
            Ok(())
        );
    }

    #[test]
    fn what_is_taken_back_is_what_was_meant() {
        let one = |time_ms, station| Retract::Bearing { time_ms, station };
        let span = |from_ms, until_ms| Retract::Span { from_ms, until_ms };
        let near = |radius_m| Retract::Place {
            position: [0.0; 2],
            radius_m,
        };
        for (what, apart) in [
            (one(2_000, 0), [1, 0, 2]),
            (one(2_000, 1), [0, 0, 3]),
            (one(2_500, 0), [0, 0, 3]),
            (span(2_000, 2_000), [1, 0, 2]),
            (span(1_001, 1_999), [0, 0, 3]),
            (span(1_001, 3_000), [2, 0, 1]),
            (span(0, 9_000), [3, 0, 0]),
            (near(10.0), [2, 0, 1]),
            (near(9.9), [1, 0, 2]),
        ] {
            assert_eq!(retracted::<4>(what), apart, "{what:?}");
        }
        // The first two are one.
        for (what, averaged) in [
            (one(1_000, 0), [0, 2, 3]),
            (one(2_000, 0), [0, 2, 3]),
            (one(3_000, 0), [1, 0, 2]),
            (span(1_000, 2_000), [2, 0, 1]),
            (span(1_500, 9_000), [1, 2, 2]),
            (span(0, 1_999), [0, 2, 3]),
            (near(5.0), [0, 2, 3]),
        ] {
            assert_eq!(retracted::<2>(what), averaged, "{what:?}");
        }
    }

    #[test]
    fn particles_are_too_few_below_their_fraction_or_two() {
        for (size, count, fraction, expected) in [
            (49.9, 100, 0.5, true),
            (50.0, 100, 0.5, false),
            (1.9, 100, 0.0, true),
            (2.0, 100, 0.0, false),
            (2.0, 4, 0.5, false),
        ] {
            assert_eq!(is_depleted(size, count, fraction), expected, "{size}");
        }
    }

    #[test]
    fn a_crossing_says_what_it_lacks() {
        let crossing = |gain| Crossing {
            gain,
            information: 400.0,
            limit: 0.25,
            enough: 1.0,
        };
        // Needed is a gain of 16: halves of 0.1 rad each that differ by four times as much.
        let lacking = |have_rad: f32| NotObservable::CrossingAngle {
            have_rad,
            needed_rad: 0.4,
        };
        assert_eq!(crossing(-1.0).check(1.0, 100.0), Err(lacking(0.0)));
        assert_eq!(crossing(4.0).check(1.0, 100.0), Err(lacking(0.2)));
        assert_eq!(crossing(16.0).check(1.0, 100.0), Ok(()));
        assert_eq!(crossing(16.0).check(6.25, 100.0), Ok(()));
        let wide = NotObservable::WideRange {
            have: 0.5,
            needed: 0.25,
        };
        assert_eq!(crossing(16.0).check(25.0, 100.0), Err(wide));
    }
}
