//! The vehicle's sentences out.

use super::clock::TimeOfDay;
use super::sentence::{DEGREES, Text, Unit};
use super::{Counters, Rejected};
use crate::aoa::advice::Advice;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{Answer, Fix, NotObservable};
use crate::aoa::robust::{Bias, Hypothesis, Shares};
use crate::aoa::{Bearing, Locate, Source};
use crate::estimate::Ellipse;
use crate::math::{atan2, sqrt};

/// Room for a fix and a status.
pub const SHORT_REPORT: usize = 320;

/// Bytes of the longest report of a locator that knows of several sources, of their motion, of hypotheses and of errors.
pub const LONG_REPORT: usize = 1_024;

/// The most sources, and the most hypotheses, of one report.
const MOST: usize = 4;

pub(super) type Report<const N: usize> = Text<N>;

/// When, how many bearings since the last restart, and about which origin.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub time: Option<TimeOfDay>,
    pub bearings: u32,
    pub plane: Option<&'a LocalPlane>,
}

impl<const N: usize> Text<N> {
    /// All that a locator knows.
    pub fn answer<L: Locate>(&mut self, locator: &L, context: Context<'_>) {
        match locator.answer() {
            Answer::Fix(_) => {
                for source in (0..MOST).map_while(|index| locator.source(index)) {
                    self.source(&source, context);
                }
            }
            Answer::NotObservable(reason) => {
                self.not_observable(context.time, reason, context.bearings);
                for hypothesis in (0..MOST).map_while(|index| locator.hypothesis(index)) {
                    self.hypothesis(&hypothesis, context.plane);
                }
                if let Some(advice) = locator.advice() {
                    self.advice(&advice);
                }
            }
        }
        if let Some(shares) = locator.shares() {
            self.errors(locator.bias(), &shares);
        }
    }

    /// `$PFOXF`, and `$PFOXM` of a source that may move or of one of several.
    fn source(&mut self, source: &Source, context: Context<'_>) {
        self.fix(context.time, &source.fix, context.plane);
        if source.motion.is_none() && source.identity == 0 {
            return;
        }
        self.begin("PFOXM");
        self.field(u32::from(source.identity));
        match source.motion {
            Some(motion) => {
                let [east, north] = motion.velocity;
                let course = Bearing::from_radians(atan2(north, east)).compass_degrees();
                self.decimal(100.0 * motion.moving, Unit::Tenth);
                self.decimal(sqrt(east * east + north * north), Unit::Tenth);
                self.decimal(course, Unit::Tenth);
                self.decimal(motion.deviation, Unit::Tenth);
            }
            None => self.put(",,,,"),
        }
        self.end();
    }

    /// `$PFOXH`; nothing of one that is too far away for coordinates.
    fn hypothesis(&mut self, hypothesis: &Hypothesis, plane: Option<&LocalPlane>) {
        let place = plane.and_then(|plane| plane.to_geodetic(hypothesis.position).ok());
        if let Some(place) = place {
            self.begin("PFOXH");
            self.place(place);
            self.ellipse(&hypothesis.ellipse(Ellipse::ONE_SIGMA));
            self.decimal(100.0 * hypothesis.mass, Unit::Tenth);
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
    fn errors(&mut self, bias: Option<Bias>, shares: &Shares) {
        self.begin("PFOXE");
        match bias {
            Some(bias) => {
                // Clockwise.
                self.signed(-bias.mean * DEGREES, Unit::Tenth);
                self.decimal(bias.deviation * DEGREES, Unit::Tenth);
            }
            None => self.put(",,"),
        }
        for share in [shares.direct, shares.mirror, shares.wild] {
            self.decimal(100.0 * share, Unit::Tenth);
        }
        self.end();
    }

    /// `$PFOXF`, or `$PFOXN` with the reason `RANGE` where the fix is too far away for coordinates.
    fn fix(&mut self, time: Option<TimeOfDay>, fix: &Fix, plane: Option<&LocalPlane>) {
        let place = plane.and_then(|plane| plane.to_geodetic(fix.position).ok());
        let Some(place) = place else {
            self.begin("PFOXN");
            self.time(time);
            self.put(",RANGE");
            self.field(fix.bearings);
            self.put(",,");
            return self.end();
        };
        self.begin("PFOXF");
        self.time(time);
        self.place(place);
        self.ellipse(&fix.ellipse(Ellipse::ONE_SIGMA));
        self.field(fix.bearings);
        self.decimal(fix.effective_sample_size, Unit::Tenth);
        self.end();
    }

    /// `$PFOXN`
    fn not_observable(&mut self, time: Option<TimeOfDay>, reason: NotObservable, bearings: u32) {
        let (reason, angles) = match reason {
            NotObservable::TooFewBearings { .. } => (",FEW", None),
            NotObservable::CrossingAngle { radians, needed } => (",ANGLE", Some((radians, needed))),
            NotObservable::NoIntersection => (",APART", None),
        };
        self.begin("PFOXN");
        self.time(time);
        self.put(reason);
        self.field(bearings);
        match angles {
            Some((radians, needed)) => {
                self.decimal(radians * DEGREES, Unit::Tenth);
                self.decimal(needed * DEGREES, Unit::Tenth);
            }
            None => self.put(",,"),
        }
        self.end();
    }

    /// `$PFOXS`
    pub fn counts(&mut self, counters: &Counters) {
        self.begin("PFOXS");
        for count in [
            counters.lines,
            counters.sentences,
            counters.bearings,
            counters.ignored,
        ] {
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
mod tests {
    use super::*;
    use crate::aoa::Motion;

    fn time() -> Option<TimeOfDay> {
        TimeOfDay::from_nmea(b"235959.999")
    }

    fn plane() -> LocalPlane {
        LocalPlane::new(Geodetic::new(-481_173_001, -1_799_999_999).unwrap()).unwrap()
    }

    fn fix(position: [f32; 2], covariance: [[f32; 2]; 2]) -> Fix {
        Fix {
            position,
            covariance,
            effective_sample_size: 87.66,
            bearings: 60,
        }
    }

    #[test]
    fn fix_sentence() {
        let mut report = Report::<SHORT_REPORT>::new();
        report.fix(
            time(),
            &fix([0.0, 0.0], [[1.0, 0.0], [0.0, 4.0]]),
            Some(&plane()),
        );
        assert_eq!(
            report.as_str(),
            "$PFOXF,235959.999,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60,87.7*50\r\n"
        );
        report.clear();
        report.fix(
            None,
            &fix([0.0, 0.0], [[4.0, 0.0], [0.0, 1.0]]),
            Some(&plane()),
        );
        assert!(report.as_str().contains(",W,2.000,1.000,90.0,60,"));
        report.clear();
        report.fix(
            None,
            &fix([f32::NAN, 0.0], [[4.0, 0.0], [0.0, 1.0]]),
            Some(&plane()),
        );
        assert_eq!(report.as_str(), "$PFOXN,,RANGE,60,,*3A\r\n");
    }

    #[test]
    fn not_observable_sentence() {
        let mut report = Report::<SHORT_REPORT>::new();
        report.not_observable(time(), NotObservable::TooFewBearings { have: 1 }, 1);
        assert_eq!(report.as_str(), "$PFOXN,235959.999,FEW,1,,*10\r\n");
        report.clear();
        let reason = NotObservable::CrossingAngle {
            radians: 0.05,
            needed: 0.1,
        };
        report.not_observable(time(), reason, 12);
        assert_eq!(report.as_str(), "$PFOXN,235959.999,ANGLE,12,2.9,5.7*3E\r\n");
    }

    /// Knows everything that there is to report.
    struct Knowing {
        answer: Answer,
        source: Source,
        hypothesis: Hypothesis,
        bias: Bias,
    }

    impl Locate for Knowing {
        fn push_after<R: crate::random::Rng + ?Sized>(
            &mut self,
            _: crate::aoa::Observation,
            _: f32,
            _: &mut R,
        ) -> Answer {
            self.answer
        }

        fn answer(&self) -> Answer {
            self.answer
        }

        fn reset(&mut self) {}

        fn source(&self, _: usize) -> Option<Source> {
            Some(self.source)
        }

        fn hypothesis(&self, _: usize) -> Option<Hypothesis> {
            Some(self.hypothesis)
        }

        fn bias(&self) -> Option<Bias> {
            Some(self.bias)
        }

        fn shares(&self) -> Option<Shares> {
            Some(Shares {
                direct: 0.75,
                mirror: 0.05,
                wild: 0.2,
            })
        }

        fn advice(&self) -> Option<Advice> {
            Some(Advice {
                direction: Bearing::from_compass_degrees(247.5),
                information: 1.25,
                distance_m: 1_220.7,
            })
        }
    }

    fn knowing(answer: Answer) -> Knowing {
        let fix = fix([0.0, 0.0], [[1.0, 0.0], [0.0, 4.0]]);
        Knowing {
            answer,
            source: Source {
                identity: 3,
                fix,
                motion: Some(Motion {
                    moving: 0.875,
                    velocity: [-3.0, 4.0],
                    deviation: 1.5,
                }),
            },
            hypothesis: Hypothesis {
                position: [0.0, 0.0],
                covariance: fix.covariance,
                mass: 0.6,
            },
            bias: Bias {
                mean: -0.05,
                deviation: 0.01,
            },
        }
    }

    #[test]
    fn all_that_is_known() {
        let plane = plane();
        let context = Context {
            time: None,
            bearings: 9,
            plane: Some(&plane),
        };
        let mut report = Report::<LONG_REPORT>::new();
        report.answer(&knowing(Answer::Fix(fix([0.0; 2], [[1.0; 2]; 2]))), context);
        let text = report.as_str();
        assert_eq!(text.matches("$PFOXF,").count(), MOST);
        assert!(text.contains("$PFOXM,3,87.5,5.0,323.1,1.5*"), "{text}");
        assert!(
            text.ends_with("$PFOXE,2.9,0.6,75.0,5.0,20.0*4E\r\n"),
            "{text}"
        );

        report.clear();
        let reason = NotObservable::NoIntersection;
        report.answer(&knowing(Answer::NotObservable(reason)), context);
        let text = report.as_str();
        assert!(text.starts_with("$PFOXN,,APART,9,,*"));
        let hypothesis = "$PFOXH,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60.0*";
        assert_eq!(text.matches(hypothesis).count(), MOST);
        assert!(text.contains("$PFOXA,247.5,1220.7,1.3*"), "{text}");
    }

    #[test]
    fn the_longest_reports_of_several_sources_fit() {
        let mut most = knowing(Answer::Fix(fix([0.0; 2], [[1.0; 2]; 2])));
        most.source.identity = u16::MAX;
        most.source.fix = fix([9e4, 4e4], [[3e38, 0.0], [0.0, 3e38]]);
        most.source.fix.effective_sample_size = 3e38;
        most.source.fix.bearings = u32::MAX;
        most.source.motion = Some(Motion {
            moving: 1.0,
            velocity: [-3e9, 3e9],
            deviation: 3e38,
        });
        most.bias = Bias {
            mean: -9.0,
            deviation: 9.0,
        };
        let plane = plane();
        let context = Context {
            time: time(),
            bearings: u32::MAX,
            plane: Some(&plane),
        };
        let mut report = Report::<{ 2 * LONG_REPORT }>::new();
        report.answer(&most, context);
        assert!(
            report.as_str().len() <= LONG_REPORT,
            "{}",
            report.as_str().len()
        );
        let mut counters = Counters::new();
        counters.lines = u32::MAX;
        report.counts(&counters);
        assert!(report.as_str().len() + (3 + Rejected::ALL.len()) * 9 <= LONG_REPORT);
    }

    #[test]
    fn the_longest_reports_fit() {
        let mut report = Report::<SHORT_REPORT>::new();
        let mut longest = fix([9e4, 4e4], [[3e38, 0.0], [0.0, 3e38]]);
        longest.effective_sample_size = 3e38;
        longest.bearings = u32::MAX;
        report.fix(time(), &longest, Some(&plane()));
        let mut counters = Counters::new();
        counters.lines = u32::MAX;
        report.counts(&counters);
        // Every other count, now one digit, may have ten.
        let counts = 4 + Rejected::ALL.len();
        assert!(report.as_str().ends_with("\r\n"));
        assert!(report.as_str().len() + (counts - 1) * 9 <= SHORT_REPORT);
    }
}
