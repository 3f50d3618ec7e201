//! The tables.

use anyhow::Result;
use foxhunt::aoa::{Answer, Mixture, NotObservable, Source};
use serde::{Deserialize, Serialize};

use super::coordinates::{axis, clock, compass, coordinates, rounded};
use super::{Answered, Archive, Kind, Taken};

/// A row of `fixes.csv`: what is known of a source with a bearing, or why there is no fix. Angles are in degrees
/// clockwise, those of directions from true north; times are UTC.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FixRow {
    /// When the last bearing was taken.
    pub time: String,
    /// Counts the searches, from 1.
    pub search: u32,
    /// `fix` or `none`.
    pub kind: String,
    /// Why there is no fix: `few`, `angle`, `apart`, as the gateway's `$PFOXN` says it, or `range`: there is one, too far
    /// away for coordinates.
    pub reason: Option<String>,
    /// The number of the source.
    pub source: Option<u16>,
    /// Of the fix.
    pub latitude: Option<f64>,
    /// Of the fix.
    pub longitude: Option<f64>,
    /// Half of the longest diameter of the 95 % ellipse.
    pub semi_major_m: Option<f64>,
    /// Half of the shortest.
    pub semi_minor_m: Option<f64>,
    /// Direction of the longest diameter.
    pub orientation_degrees: Option<f64>,
    /// How many bearings it rests on; without a fix, how many there were.
    pub bearings: u32,
    /// Of the particles.
    pub effective_sample_size: Option<f64>,
    /// At which the bearings cross, where that is too little.
    pub crossing_degrees: Option<f64>,
    /// At which they should.
    pub needed_degrees: Option<f64>,
    /// The common bias of all bearings.
    pub bias_degrees: Option<f64>,
    /// Its standard deviation.
    pub bias_sigma_degrees: Option<f64>,
    /// Rate of the bearings that point at the source.
    pub direct_rate: Option<f64>,
    /// Rate of those that point away from it.
    pub mirrored_rate: Option<f64>,
    /// Rate of outliers, which say nothing of it.
    pub outlier_rate: Option<f64>,
    /// Probability that the source moves.
    pub moving_probability: Option<f64>,
    /// How fast, if it does.
    pub speed_m_s: Option<f64>,
    /// Where to, if it does.
    pub course_degrees: Option<f64>,
    /// Standard deviation of either coordinate of its velocity.
    pub velocity_sigma_m_s: Option<f64>,
}

/// A row of `bearings.csv`: a bearing that was used. What it is and fits is said by all that is known at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BearingRow {
    /// When it was taken.
    pub time: String,
    /// Counts the searches, from 1.
    pub search: u32,
    /// Where it was taken.
    pub latitude: Option<f64>,
    /// Where it was taken.
    pub longitude: Option<f64>,
    /// Clockwise from true north.
    pub bearing_degrees: f64,
    /// Its standard deviation.
    pub sigma_degrees: f64,
    /// What it most probably is; nothing where that is not known.
    pub kind: Option<Kind>,
    /// Probability that it points at a source.
    pub direct_probability: Option<f64>,
    /// Probability that it points away from one.
    pub mirrored_probability: Option<f64>,
    /// Probability that it says nothing of any.
    pub outlier_probability: Option<f64>,
    /// The number of the source that it fits best.
    pub source: Option<u16>,
    /// What it is off the direction of that, clockwise: less the bias, and turned round if it is mirrored.
    pub residual_degrees: Option<f64>,
}

/// Rows under their heads.
pub(super) fn csv<T: Serialize>(rows: &[T]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(writer.into_inner()?)
}

impl Archive {
    /// The rows of `fixes.csv`: one for each bearing and source, or for each bearing without a fix.
    pub fn fix_rows(&self) -> Vec<FixRow> {
        self.answers.iter().flat_map(FixRow::of).collect()
    }

    /// The rows of `bearings.csv`.
    pub fn bearing_rows(&self) -> Vec<BearingRow> {
        self.bearings.iter().map(BearingRow::of).collect()
    }
}

fn angle(radians: f32) -> f64 {
    rounded(f64::from(radians).to_degrees(), 2)
}

fn probability(value: f32) -> f64 {
    rounded(value, 4)
}

impl FixRow {
    pub(super) fn of(known: &Answered) -> Vec<Self> {
        let common = Self::common(known);
        match known.answer {
            Answer::Fix(_) => {
                let row = |source| common.clone().with_source(known, source);
                known.sources.iter().map(row).collect()
            }
            Answer::NotObservable(reason) => vec![common.without_fix(reason)],
        }
    }

    fn common(known: &Answered) -> Self {
        let rate = |of: fn(&Mixture) -> f32| known.rates.as_ref().map(|s| probability(of(s)));
        Self {
            time: clock(known.time_ms),
            search: known.search,
            bearings: known.bearings,
            bias_degrees: known.bias.map(|bias| angle(-bias.mean_rad)),
            bias_sigma_degrees: known.bias.map(|bias| angle(bias.sigma_rad)),
            direct_rate: rate(|rates| rates.direct),
            mirrored_rate: rate(|rates| rates.mirrored),
            outlier_rate: rate(|rates| rates.outlier),
            ..Self::default()
        }
    }

    fn without_fix(self, reason: NotObservable) -> Self {
        let (reason, angles) = match reason {
            NotObservable::TooFewBearings { .. } => ("few", None),
            NotObservable::CrossingAngle {
                have_rad,
                needed_rad,
            } => ("angle", Some((have_rad, needed_rad))),
            NotObservable::NoIntersection => ("apart", None),
            NotObservable::SeveralPlaces { .. } => ("places", None),
            NotObservable::WideRange { .. } => ("wide", None),
            NotObservable::Contradiction { .. } => ("contrary", None),
            _ => ("other", None),
        };
        Self {
            kind: "none".into(),
            reason: Some(reason.into()),
            crossing_degrees: angles.map(|(crossing, _)| angle(crossing)),
            needed_degrees: angles.map(|(_, needed)| angle(needed)),
            ..self
        }
    }

    fn with_source(self, known: &Answered, source: &Source) -> Self {
        let ellipse = source.fix.ellipse(0.95);
        let place = coordinates(&known.plane, source.fix.position);
        let motion = source.motion;
        let velocity = motion.map(|motion| motion.velocity_m_s.map(f64::from));
        Self {
            kind: "fix".into(),
            reason: place.is_none().then(|| "range".into()),
            source: Some(source.identity),
            latitude: place.map(|[_, latitude]| latitude),
            longitude: place.map(|[longitude, _]| longitude),
            semi_major_m: Some(rounded(ellipse.semi_major, 3)),
            semi_minor_m: Some(rounded(ellipse.semi_minor, 3)),
            orientation_degrees: Some(axis(ellipse.orientation)),
            bearings: source.fix.bearings,
            effective_sample_size: Some(rounded(source.fix.effective_sample_size, 1)),
            moving_probability: motion.map(|motion| probability(motion.moving)),
            speed_m_s: velocity.map(|[east, north]| rounded(east.hypot(north), 2)),
            course_degrees: velocity.map(|[east, north]| compass(north.atan2(east))),
            velocity_sigma_m_s: motion.map(|motion| rounded(motion.sigma_m_s, 2)),
            ..self
        }
    }
}

impl BearingRow {
    pub(super) fn of(taken: &Taken) -> Self {
        let place = coordinates(&taken.plane, taken.observation.position());
        let chance = |of: fn(&Mixture) -> f32| taken.chances.as_ref().map(|c| probability(of(c)));
        let bearing = f64::from(taken.observation.bearing().radians());
        Self {
            time: clock(taken.time_ms),
            search: taken.search,
            latitude: place.map(|[_, latitude]| latitude),
            longitude: place.map(|[longitude, _]| longitude),
            bearing_degrees: compass(bearing),
            sigma_degrees: angle(taken.observation.sigma_rad()),
            kind: taken.kind(),
            direct_probability: chance(|chances| chances.direct),
            mirrored_probability: chance(|chances| chances.mirrored),
            outlier_probability: chance(|chances| chances.outlier),
            source: taken.fits.map(|(source, _)| source.identity),
            residual_degrees: taken.fits.map(|(_, off)| rounded(-off.to_degrees(), 2)),
        }
    }
}
