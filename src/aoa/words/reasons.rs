//! Why there is no fix, and what helps, in words for people.

use core::{f32::consts::FRAC_PI_2, fmt};

use super::answer::NotObservable;

impl fmt::Display for NotObservable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFewBearings { have } => write!(f, "too few bearings: {have} so far"),
            // No angle is enough: their errors ask for more of them.
            Self::CrossingAngle { needed_rad, .. } if needed_rad > FRAC_PI_2 => {
                f.write_str("by their errors, so few bearings do not tell yet where they cross")
            }
            Self::CrossingAngle {
                have_rad,
                needed_rad,
            } => write!(
                f,
                "the bearings cross at {:.1} degrees, {:.1} are needed",
                have_rad.to_degrees(),
                needed_rad.to_degrees(),
            ),
            Self::NoIntersection => {
                f.write_str("the bearings do not meet in front of their receivers")
            }
            Self::SeveralPlaces { have: 0 | 1 } => {
                f.write_str("one place fits, but chance explains the bearings nearly as well")
            }
            Self::SeveralPlaces { have } => write!(f, "{have} places fit"),
            Self::WideRange { have, needed } => write!(
                f,
                "the range is known to {:.1} %, {:.1} % are needed",
                100.0 * have,
                100.0 * needed,
            ),
            Self::Contradiction { outliers } => write!(
                f,
                "{:.0} % of the bearings do not fit the best place",
                100.0 * outliers,
            ),
        }
    }
}

impl NotObservable {
    /// What helps, to be said after "to get a fix,".
    pub const fn help(self) -> &'static str {
        match self {
            Self::TooFewBearings { .. } => "take more bearings",
            Self::CrossingAngle { .. } => {
                "drive across the bearings: from one place, or towards the source, they are too nearly parallel"
            }
            Self::NoIntersection => {
                "drive on; if that does not help, look at the finder: its bearings may be mirrored, or grow the other way"
            }
            Self::SeveralPlaces { .. } => {
                "drive so that the places that fit lie in different directions"
            }
            Self::WideRange { .. } => {
                "drive nearer, or across the line of sight, or state how far the source can be"
            }
            Self::Contradiction { .. } => {
                "look at the heading and at the sense of the bearings, or expect several sources"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn every_reason_is_told_in_its_own_words() {
        let crossing = |have_rad, needed_rad| NotObservable::CrossingAngle {
            have_rad,
            needed_rad,
        };
        let wide = NotObservable::WideRange {
            have: 0.5,
            needed: 0.25,
        };
        for (reason, said) in [
            (NotObservable::TooFewBearings { have: 1 }, "1 so far"),
            (crossing(0.05, 0.1), "at 2.9 degrees, 5.7 are needed"),
            (crossing(0.05, FRAC_PI_2), "90.0 are needed"),
            (crossing(0.05, 1.6), "do not tell yet where they cross"),
            (NotObservable::NoIntersection, "do not meet in front"),
            (NotObservable::SeveralPlaces { have: 1 }, "one place fits"),
            (NotObservable::SeveralPlaces { have: 2 }, "2 places fit"),
            (wide, "known to 50.0 %, 25.0 % are needed"),
            (NotObservable::Contradiction { outliers: 0.9 }, "90 % of"),
        ] {
            let text = reason.to_string();
            assert!(text.contains(said), "{text}");
        }
    }
}
