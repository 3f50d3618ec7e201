//! The vehicle's sentences out.

use super::clock::TimeOfDay;
use super::outcome::{Counters, Rejected};
use super::sentence::{DEGREES, Text, Unit};
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::{
    Advice, Answer, Bearing, Bias, Fix, Hypothesis, Locate, Mixture, NotObservable, Source,
};
use crate::estimate::Ellipse;
use crate::math::{atan2, sqrt};

/// The most sources, and the most hypotheses, of one report.
const MOST: usize = 4;

/// Probability from which on one more source is reported, before it has a fix.
const LIKELY: f32 = 0.1;

/// The time of the last bearing, how many there were since the last restart, and the plane of the fixes.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    pub time: Option<TimeOfDay>,
    pub bearings: u32,
    pub plane: Option<&'a LocalPlane>,
}

/// What a gateway reports: a [`ShortReport`] or a [`FullReport`].
pub trait ReportForm: Form {}

impl<R: Form> ReportForm for R {}

/// A form of reports, with the text of one.
pub trait Form {
    /// No text; all bits are zero.
    const EMPTY: Self;

    /// The text.
    fn as_str(&self) -> &str;

    /// Forgets the text.
    fn clear(&mut self);

    /// Adds what a locator knows.
    fn answer<L: Locate>(&mut self, locator: &L, config: &L::Config, context: Context<'_>);

    /// Adds the status.
    fn status(&mut self, counters: &Counters);
}

/// A form of reports in `BYTES`: of all that a locator knows, or of the best known source.
#[derive(Debug)]
pub struct Report<const ALL: bool, const BYTES: usize>(Text<BYTES>);

/// Reports the best known source: one `$PFOXF` or `$PFOXN`. Has room for a fix and a status.
pub type ShortReport = Report<false, 416>;

/// Reports all that a locator knows: several sources, their motion, hypotheses, one more, advice and the errors of
/// bearings. Has room for four sources, one more, what is known of the errors, and a status.
pub type FullReport = Report<true, 1_280>;

impl<const ALL: bool, const BYTES: usize> Report<ALL, BYTES> {
    /// Room for a report.
    pub const BYTES: usize = BYTES;
}

impl<const ALL: bool, const BYTES: usize> Form for Report<ALL, BYTES> {
    const EMPTY: Self = Self(Text::new());

    fn as_str(&self) -> &str {
        self.0.as_str()
    }

    fn clear(&mut self) {
        self.0.clear();
    }

    fn answer<L: Locate>(&mut self, locator: &L, config: &L::Config, context: Context<'_>) {
        if ALL {
            return self.0.all(locator, config, context);
        }
        match locator.answer() {
            Answer::Fix(fix) => self.0.fix(context, &fix),
            Answer::NotObservable(reason) => self.0.not_observable(context, reason),
        }
    }

    fn status(&mut self, counters: &Counters) {
        self.0.counts(counters);
    }
}

impl<const N: usize> Text<N> {
    /// All that a locator knows.
    fn all<L: Locate>(&mut self, locator: &L, config: &L::Config, context: Context<'_>) {
        match locator.answer() {
            Answer::Fix(_) => {
                for source in (0..MOST).map_while(|index| locator.source(index)) {
                    self.source(&source, context);
                }
                if let Some(one) = locator.candidate(0)
                    && one.probability >= LIKELY
                {
                    self.hypothesis("PFOXC", &one, context.plane);
                }
            }
            Answer::NotObservable(reason) => {
                self.not_observable(context, reason);
                for hypothesis in (0..MOST).map_while(|index| locator.hypothesis(index)) {
                    self.hypothesis("PFOXH", &hypothesis, context.plane);
                }
                if let Some(advice) = locator.advice(config) {
                    self.advice(&advice);
                }
            }
        }
        if let Some(rates) = locator.rates(config) {
            self.errors(locator.bias(config), &rates);
        }
    }

    /// `$PFOXF`, and `$PFOXM` of a source that may move or of one of several.
    fn source(&mut self, source: &Source, context: Context<'_>) {
        self.fix(context, &source.fix);
        if source.motion.is_none() && source.identity == 0 {
            return;
        }
        self.begin("PFOXM");
        self.field(u32::from(source.identity));
        match source.motion {
            Some(motion) => {
                let [east, north] = motion.velocity_m_s;
                let course = Bearing::from_radians(atan2(north, east)).compass_degrees();
                self.decimal(100.0 * motion.moving, Unit::Tenth);
                self.decimal(sqrt(east * east + north * north), Unit::Tenth);
                self.decimal(course, Unit::Tenth);
                self.decimal(motion.sigma_m_s, Unit::Tenth);
            }
            None => self.put(",,,,"),
        }
        self.decimal(100.0 * source.probability, Unit::Tenth);
        self.end();
    }

    /// `$PFOXH`, or `$PFOXC` of one more source; nothing of one that is too far away for coordinates.
    fn hypothesis(&mut self, form: &str, hypothesis: &Hypothesis, plane: Option<&LocalPlane>) {
        let place = plane.and_then(|plane| plane.to_geodetic(hypothesis.position).ok());
        if let Some(place) = place {
            self.begin(form);
            self.place(place);
            self.ellipse(&Ellipse::of_sigmas(
                hypothesis.position,
                hypothesis.covariance,
                1.0,
            ));
            self.decimal(100.0 * hypothesis.probability, Unit::Tenth);
            self.end();
        }
    }

    /// `$PFOXA`
    fn advice(&mut self, advice: &Advice) {
        self.begin("PFOXA");
        self.decimal(advice.direction.compass_degrees(), Unit::Tenth);
        self.decimal(advice.distance_m, Unit::Tenth);
        self.decimal(advice.information, Unit::Tenth);
        self.end();
    }

    /// `$PFOXE`
    fn errors(&mut self, bias: Option<Bias>, rates: &Mixture) {
        self.begin("PFOXE");
        match bias {
            Some(bias) => {
                // Clockwise.
                self.signed(-bias.mean_rad * DEGREES, Unit::Tenth);
                self.decimal(bias.sigma_rad * DEGREES, Unit::Tenth);
            }
            None => self.put(",,"),
        }
        for rate in [rates.direct, rates.mirrored, rates.outlier] {
            self.decimal(100.0 * rate, Unit::Tenth);
        }
        self.end();
    }

    /// `$PFOXF`, or `$PFOXN` with the reason `RANGE` where the fix is too far away for coordinates.
    fn fix(&mut self, context: Context<'_>, fix: &Fix) {
        let place = (context.plane).and_then(|plane| plane.to_geodetic(fix.position).ok());
        let Some(place) = place else {
            self.begin("PFOXN");
            self.time(context.time);
            self.put(",RANGE");
            self.field(fix.bearings);
            self.put(",,");
            return self.end();
        };
        self.begin("PFOXF");
        self.time(context.time);
        self.place(place);
        self.ellipse(&Ellipse::of_sigmas(fix.position, fix.covariance, 1.0));
        self.field(fix.bearings);
        self.decimal(fix.effective_sample_size, Unit::Tenth);
        self.end();
    }

    /// `$PFOXN`
    fn not_observable(&mut self, context: Context<'_>, reason: NotObservable) {
        let (reason, figures) = match reason {
            NotObservable::TooFewBearings { .. } => (",FEW", None),
            NotObservable::CrossingAngle {
                have_rad,
                needed_rad,
            } => (
                ",ANGLE",
                Some([have_rad, needed_rad].map(|angle| angle * DEGREES)),
            ),
            NotObservable::NoIntersection => (",APART", None),
            NotObservable::SeveralPlaces { .. } => (",PLACES", None),
            NotObservable::WideRange { have, needed } => {
                (",WIDE", Some([have, needed].map(|part| 100.0 * part)))
            }
            NotObservable::Contradiction { .. } => (",CONTRARY", None),
        };
        self.begin("PFOXN");
        self.time(context.time);
        self.put(reason);
        self.field(context.bearings);
        match figures {
            Some([have, needed]) => {
                self.decimal(have, Unit::Tenth);
                self.decimal(needed, Unit::Tenth);
            }
            None => self.put(",,"),
        }
        self.end();
    }

    /// `$PFOXS`
    fn counts(&mut self, counters: &Counters) {
        self.begin("PFOXS");
        for count in counters.of_lines() {
            self.field(count);
        }
        for reason in Rejected::ALL {
            self.field(counters.rejected(reason));
        }
        self.end();
    }

    fn time(&mut self, time: Option<TimeOfDay>) {
        self.put(",");
        if let Some(time) = time {
            let (hours, minutes, milliseconds) = time.parts();
            self.digits(hours, 2);
            self.digits(minutes, 2);
            self.digits(milliseconds / 1_000, 2);
            self.put(".");
            self.digits(milliseconds % 1_000, 3);
        }
    }

    /// The semi-axes and the direction of the longer one.
    fn ellipse(&mut self, ellipse: &Ellipse) {
        self.decimal(ellipse.semi_major, Unit::Thousandth);
        self.decimal(ellipse.semi_minor, Unit::Thousandth);
        // From radians counter-clockwise from east to degrees clockwise from north, within half a turn.
        let orientation = 90.0 - ellipse.orientation * DEGREES;
        let orientation = if orientation < 179.95 {
            orientation
        } else {
            0.0
        };
        self.decimal(orientation, Unit::Tenth);
    }

    fn place(&mut self, place: Geodetic) {
        self.coordinate(place.latitude_e7(), 2, ["N", "S"]);
        self.coordinate(place.longitude_e7(), 3, ["E", "W"]);
    }

    /// Degrees in `width` digits and minutes with six decimals, which hold 1e-7 degree exactly.
    fn coordinate(&mut self, degrees_e7: i32, width: u32, sides: [&str; 2]) {
        let magnitude = degrees_e7.unsigned_abs();
        let micro_minutes = magnitude % 10_000_000 * 6;
        self.put(",");
        self.digits(magnitude / 10_000_000, width);
        self.digits(micro_minutes / 1_000_000, 2);
        self.put(".");
        self.digits(micro_minutes % 1_000_000, 6);
        self.put(",");
        let [positive, negative] = sides;
        self.put(if degrees_e7 < 0 { negative } else { positive });
    }
}

#[cfg(test)]
mod tests;
