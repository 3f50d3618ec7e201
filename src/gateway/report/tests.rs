//! The sentences, to the last byte.

extern crate std;

use super::*;
use crate::ConfigError;
use crate::aoa::{Motion, Observation, PushError};
use crate::estimate::Symmetric2;
use crate::random::Rng;

fn time() -> Option<TimeOfDay> {
    TimeOfDay::from_nmea(b"235959.999")
}

fn plane() -> LocalPlane {
    LocalPlane::new(Geodetic::new(-481_173_001, -1_799_999_999).unwrap()).unwrap()
}

const FIX: Fix = Fix {
    position: [0.0; 2],
    covariance: Symmetric2 {
        xx: 1.0,
        xy: 0.0,
        yy: 4.0,
    },
    effective_sample_size: 87.66,
    bearings: 60,
};

fn fix(position: [f32; 2], covariance: [[f32; 2]; 2]) -> Fix {
    Fix {
        position,
        covariance: covariance.into(),
        ..FIX
    }
}

/// What a report is about: a time or none.
fn about(plane: &LocalPlane, time: Option<TimeOfDay>, bearings: u32) -> Context<'_> {
    Context {
        time,
        bearings,
        plane: Some(plane),
    }
}

#[test]
fn a_fix_is_written_with_place_and_ellipse() {
    let plane = plane();
    let written = |time, fix: Fix| {
        let mut report = ShortReport::EMPTY;
        report.0.fix(about(&plane, time, 60), &fix);
        std::string::String::from(report.as_str())
    };
    assert_eq!(
        written(time(), fix([0.0, 0.0], [[1.0, 0.0], [0.0, 4.0]])),
        "$PFOXF,235959.999,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60,87.7*50\r\n"
    );
    let wide = written(None, fix([0.0, 0.0], [[4.0, 0.0], [0.0, 1.0]]));
    assert!(wide.contains(",W,2.000,1.000,90.0,60,"));
    let nowhere = written(None, fix([f32::NAN, 0.0], [[4.0, 0.0], [0.0, 1.0]]));
    assert_eq!(nowhere, "$PFOXN,,RANGE,60,,*3A\r\n");
}

#[test]
fn no_fix_is_written_with_its_reason() {
    let plane = plane();
    let written = |reason, bearings| {
        let mut report = ShortReport::EMPTY;
        (report.0).not_observable(about(&plane, time(), bearings), reason);
        std::string::String::from(report.as_str())
    };
    assert_eq!(
        written(NotObservable::TooFewBearings { have: 1 }, 1),
        "$PFOXN,235959.999,FEW,1,,*10\r\n"
    );
    let reason = NotObservable::CrossingAngle {
        have_rad: 0.05,
        needed_rad: 0.1,
    };
    assert_eq!(
        written(reason, 12),
        "$PFOXN,235959.999,ANGLE,12,2.9,5.7*3E\r\n"
    );
    let wide = NotObservable::WideRange {
        have: 0.5,
        needed: 0.25,
    };
    for (reason, said) in [
        (wide, "WIDE,7,50.0,25.0"),
        (NotObservable::NoIntersection, "APART,7,,"),
        (NotObservable::SeveralPlaces { have: 3 }, "PLACES,7,,"),
        (
            NotObservable::Contradiction { outliers: 0.9 },
            "CONTRARY,7,,",
        ),
    ] {
        let text = written(reason, 7);
        let (sentence, _) = text.split_once('*').unwrap();
        assert_eq!(sentence, std::format!("$PFOXN,235959.999,{said}"));
    }
}

/// Knows everything that there is to report.
struct Knowing {
    answer: Answer,
    source: Source,
    hypothesis: Hypothesis,
    bias: Bias,
}

impl Locate for Knowing {
    type Config = ();

    const EMPTY: Self = Self {
        answer: Answer::NotObservable(NotObservable::NoIntersection),
        source: Source {
            probability: 1.0,
            identity: 0,
            fix: FIX,
            motion: None,
        },
        hypothesis: Hypothesis {
            position: [0.0; 2],
            covariance: FIX.covariance,
            probability: 0.0,
        },
        bias: Bias {
            mean_rad: 0.0,
            sigma_rad: 0.0,
        },
    };

    fn check(_: &()) -> Result<(), ConfigError> {
        Ok(())
    }

    fn push<R: Rng + ?Sized>(
        &mut self,
        _: &Observation,
        _: &(),
        _: &mut R,
    ) -> Result<Answer, PushError> {
        Ok(self.answer)
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {}

    fn source(&self, _: usize) -> Option<Source> {
        Some(self.source)
    }

    fn candidate(&self, index: usize) -> Option<Hypothesis> {
        self.hypothesis(index)
    }

    fn hypothesis(&self, _: usize) -> Option<Hypothesis> {
        Some(self.hypothesis)
    }

    fn bias(&self, _: &()) -> Option<Bias> {
        Some(self.bias)
    }

    fn rates(&self, _: &()) -> Option<Mixture> {
        Some(Mixture {
            direct: 0.75,
            mirrored: 0.05,
            outlier: 0.2,
        })
    }

    fn advice(&self, _: &()) -> Option<Advice> {
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
            probability: 0.9,
            identity: 3,
            fix,
            motion: Some(Motion {
                moving: 0.875,
                velocity_m_s: [-3.0, 4.0],
                sigma_m_s: 1.5,
            }),
        },
        hypothesis: Hypothesis {
            position: [0.0, 0.0],
            covariance: fix.covariance,
            probability: 0.6,
        },
        bias: Bias {
            mean_rad: -0.05,
            sigma_rad: 0.01,
        },
    }
}

#[test]
fn a_full_report_says_all_that_is_known() {
    let plane = plane();
    let context = about(&plane, None, 9);
    let mut report = FullReport::EMPTY;
    let located = knowing(Answer::Fix(fix([0.0; 2], [[1.0; 2]; 2])));
    report.answer(&located, &(), context);
    let text = report.as_str();
    assert_eq!(text.matches("$PFOXF,").count(), MOST);
    assert!(text.contains("$PFOXC,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60.0*"));
    assert!(text.contains("$PFOXM,3,87.5,5.0,323.1,1.5,90.0*"), "{text}");
    let errors = "$PFOXE,2.9,0.6,75.0,5.0,20.0*4E\r\n";
    assert!(text.ends_with(errors), "{text}");

    report.clear();
    let lost = knowing(Answer::NotObservable(NotObservable::NoIntersection));
    report.answer(&lost, &(), context);
    let text = report.as_str();
    assert!(text.starts_with("$PFOXN,,APART,9,,*"));
    let hypothesis = "$PFOXH,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60.0*";
    assert_eq!(text.matches(hypothesis).count(), MOST);
    assert!(text.contains("$PFOXA,247.5,1220.7,1.3*"), "{text}");

    let mut report = ShortReport::EMPTY;
    report.answer(&located, &(), context);
    assert_eq!(report.as_str().matches('$').count(), 1);
}

#[test]
fn the_longest_reports_fit() {
    let mut longest = knowing(Answer::Fix(fix([9e4, 4e4], [[3e38, 0.0], [0.0, 3e38]])));
    longest.source.identity = u16::MAX;
    longest.source.fix = fix([9e4, 4e4], [[3e38, 0.0], [0.0, 3e38]]);
    longest.source.fix.effective_sample_size = 3e38;
    longest.source.fix.bearings = u32::MAX;
    longest.source.motion = Some(Motion {
        moving: 1.0,
        velocity_m_s: [-3e9, 3e9],
        sigma_m_s: 3e38,
    });
    longest.answer = Answer::Fix(longest.source.fix);
    longest.hypothesis.position = longest.source.fix.position;
    longest.hypothesis.covariance = longest.source.fix.covariance;
    longest.bias = Bias {
        mean_rad: -9.0,
        sigma_rad: 9.0,
    };
    let plane = plane();
    let context = about(&plane, time(), u32::MAX);
    // Every count, now one digit, may have ten.
    let counts = (Counters::EMPTY.of_lines().len() + Rejected::ALL.len()) * 9;
    let mut short = ShortReport::EMPTY;
    short.answer(&longest, &(), context);
    short.status(&Counters::EMPTY);
    assert!(short.as_str().ends_with("\r\n"));
    let bytes = short.as_str().len() + counts;
    assert!(bytes <= ShortReport::BYTES, "{bytes}");
    let mut full = FullReport::EMPTY;
    full.answer(&longest, &(), context);
    full.status(&Counters::EMPTY);
    assert!(full.as_str().ends_with("\r\n"));
    let bytes = full.as_str().len() + counts;
    assert!(bytes <= FullReport::BYTES, "{bytes}");
}
