//! The sentences, to the last byte.

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
    let mut report = Short::new();
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
    let mut report = Short::new();
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
    let mut report = Short::new();
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
