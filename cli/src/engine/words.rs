//! What is known, as messages.

use foxhunt::aoa::{self, NotObservable, geodesy::LocalPlane};
use foxhunt::estimate;
use foxhunt_host::{archive::coordinates, geodesy::Place};

use super::hunt::Hunt;
use super::message::{Advice, Answer, Ellipse, Hypothesis, Reason, Source};
use super::site::rounded;

/// The most particles that are told.
const PARTICLES: usize = 300;

/// What a search knows at a time.
pub fn answer(hunt: &dyn Hunt, time_ms: i64) -> Answer {
    let Some(plane) = hunt.plane() else {
        return nothing(time_ms);
    };
    let reason = match hunt.answer() {
        aoa::Answer::Fix(_) => None,
        aoa::Answer::NotObservable(reason) => Some(why(reason)),
    };
    let sources = hunt.sources();
    Answer {
        time_ms,
        sources: (sources.iter())
            .filter_map(|one| source(&plane, one))
            .collect(),
        hypotheses: (hunt.hypotheses().iter())
            .filter(|hypothesis| hypothesis.probability >= 0.01)
            .filter_map(|one| hypothesis(&plane, one))
            .collect(),
        reason,
        advice: hunt.advice().and_then(|told| advice(hunt, &plane, &told)),
        particles: (hunt.particles(PARTICLES).iter())
            .filter_map(|place| coordinates(&plane, *place))
            .map(|[longitude, latitude]| [latitude, longitude])
            .collect(),
    }
}

/// What is known without a bearing.
pub fn nothing(time_ms: i64) -> Answer {
    Answer {
        time_ms,
        sources: Vec::new(),
        hypotheses: Vec::new(),
        reason: Some(why(NotObservable::TooFewBearings { have: 0 })),
        advice: None,
        particles: Vec::new(),
    }
}

fn source(plane: &LocalPlane, source: &aoa::Source) -> Option<Source> {
    let [lon, lat] = coordinates(plane, source.fix.position)?;
    let covariance = source.fix.covariance;
    let covariance = [covariance.xx, covariance.xy, covariance.yy];
    Some(Source {
        number: source.identity,
        lat,
        lon,
        covariance: covariance.map(|v| rounded(v.into(), 3)),
        ellipse: ellipse(&source.fix.ellipse(0.95)),
        probability: Some(rounded(source.probability.into(), 4)),
        fix: true,
        bearings: source.fix.bearings,
    })
}

fn hypothesis(plane: &LocalPlane, hypothesis: &aoa::Hypothesis) -> Option<Hypothesis> {
    let [lon, lat] = coordinates(plane, hypothesis.position)?;
    Some(Hypothesis {
        lat,
        lon,
        mass: rounded(hypothesis.probability.into(), 4),
        ellipse: ellipse(&hypothesis.ellipse(0.95)),
    })
}

fn ellipse(ellipse: &estimate::Ellipse) -> Ellipse {
    let angle = 90.0 - f64::from(ellipse.orientation).to_degrees();
    Ellipse {
        semi_major_m: rounded(ellipse.semi_major.into(), 2),
        semi_minor_m: rounded(ellipse.semi_minor.into(), 2),
        angle_deg: rounded(angle.rem_euclid(180.0), 2),
    }
}

fn advice(hunt: &dyn Hunt, plane: &LocalPlane, advice: &aoa::Advice) -> Option<Advice> {
    /// Nats below which a bearing tells nothing new.
    const LITTLE: f32 = 0.1;
    if advice.information < LITTLE {
        return None;
    }
    let [longitude, latitude] = coordinates(plane, hunt.observation()?.position())?;
    let is_way = advice.distance_m > 0.0 && advice.distance_m.is_finite();
    let metres = is_way.then(|| advice.distance_m.into());
    let course = advice.direction.compass_degrees().into();
    let place = Place {
        latitude,
        longitude,
    };
    Some(way(place, course, metres))
}

/// Where to drive from a place, on a course, until there can be a fix, if that is not too far.
pub fn way(place: Place, course_deg: f64, metres: Option<f64>) -> Advice {
    /// Metres to the place that is pointed at, where no distance is needed or it is too far.
    const AHEAD: f64 = 300.0;
    let (sin, cos) = course_deg.to_radians().sin_cos();
    let ahead = metres.unwrap_or(AHEAD);
    let Place {
        latitude: lat,
        longitude: lon,
    } = place.offset([ahead * sin, ahead * cos]);
    let text = match metres {
        Some(metres) => {
            format!("drive {metres:.0} m towards {course_deg:.0} degrees: then there can be a fix")
        }
        None => format!("drive towards {course_deg:.0} degrees: bearings tell most there"),
    };
    Advice { lat, lon, text }
}

/// Why there is no fix.
pub fn why(reason: NotObservable) -> Reason {
    Reason {
        code: code(reason).into(),
        text: reason.to_string(),
        help: reason.help().into(),
    }
}

/// The word of `$PFOXN`.
pub fn code(reason: NotObservable) -> &'static str {
    match reason {
        NotObservable::TooFewBearings { .. } => "FEW",
        NotObservable::CrossingAngle { .. } => "ANGLE",
        NotObservable::NoIntersection => "APART",
        NotObservable::SeveralPlaces { .. } => "PLACES",
        NotObservable::WideRange { .. } => "WIDE",
        NotObservable::Contradiction { .. } => "CONTRARY",
        _ => "OTHER",
    }
}
