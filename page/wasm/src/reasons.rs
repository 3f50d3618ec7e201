//! Why there is no fix, in plain words.

use core::f32::consts::FRAC_PI_2;

use foxhunt::aoa::NotObservable;

use crate::messages::Reason;

/// The reason, for a person.
pub fn reason(of: NotObservable) -> Reason {
    let (code, text) = match of {
        NotObservable::TooFewBearings { have } => (
            "few",
            format!("Too few bearings: {have} so far, at least 2 are needed."),
        ),
        // No angle is enough: their errors ask for more of them.
        NotObservable::CrossingAngle { needed_rad, .. } if needed_rad > FRAC_PI_2 => (
            "angle",
            "By their errors, so few bearings do not tell yet where they cross. Drive on, across them.".into(),
        ),
        NotObservable::CrossingAngle {
            have_rad,
            needed_rad,
        } => (
            "angle",
            format!(
                "The bearings are nearly parallel: they cross at {:.1}°, and {:.1}° are needed. Drive on, across them.",
                have_rad.to_degrees(),
                needed_rad.to_degrees()
            ),
        ),
        NotObservable::NoIntersection => (
            "no-intersection",
            "The bearings do not meet in front of the vehicle. Drive on, or wait.".into(),
        ),
        NotObservable::SeveralPlaces { have: 0 | 1 } => (
            "several",
            "One place fits, but chance explains the bearings nearly as well. Drive on.".into(),
        ),
        NotObservable::SeveralPlaces { have } => (
            "several",
            format!("{have} places fit. Drive so that they lie in different directions."),
        ),
        NotObservable::WideRange { have, needed } => (
            "range",
            format!(
                "The direction is known, the range is not: it is uncertain by {:.1} %, and a fix takes {:.1} %. \
                 Drive nearer, or across the line of sight.",
                100.0 * have,
                100.0 * needed
            ),
        ),
        NotObservable::Contradiction { outliers } => (
            "contradiction",
            format!(
                "{:.0} % of the bearings do not fit any one place. Check the array, or expect several sources.",
                100.0 * outliers
            ),
        ),
        _ => ("other", "There is no fix yet.".into()),
    };
    Reason { code, text }
}
