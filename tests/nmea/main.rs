//! Logs of real receivers through a vehicle's gateway: what they say is used, or refused for a reason that stands in a table.
//!
//! The logs are those of gpsd (BSD-2-Clause), in the folder `nmea` of the directory that `FOXHUNT_DATA` names. Each sentence
//! was decoded independently, with exact decimals.

mod logs;

use foxhunt::ConfigError;
use foxhunt::aoa::{Alternative, Answer, Locate, NotObservable, PushError};
use foxhunt::gateway::formats::All;
use foxhunt::gateway::{Config, Event, Receiver, Rejected, ShortReport, Vehicle};
use foxhunt::random::Rng;
use logs::{Expected, Log};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

/// Nobody looks for anything.
struct Nobody;

impl Locate for Nobody {
    type Config = ();

    const EMPTY: Self = Self;

    fn check(_: &Self::Config) -> Result<(), ConfigError> {
        Ok(())
    }

    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        _: &[Alternative],
        _: &Self::Config,
        _: &mut R,
    ) -> Result<Answer, PushError> {
        Ok(self.answer())
    }

    fn answer(&self) -> Answer {
        Answer::NotObservable(NotObservable::NoIntersection)
    }

    fn reset(&mut self) {}
}

type Gateway = Vehicle<Nobody, All, ShortReport>;

/// What a line led to, and what the receiver has stated after it, by where in the log the line begins.
fn replay(log: &Log, config: &Config<()>) -> HashMap<usize, (Event, Receiver)> {
    let mut gateway = Gateway::EMPTY;
    let mut led = HashMap::new();
    let mut begins = 0;
    for (place, byte) in log.bytes.iter().enumerate() {
        let event = gateway.push(0, *byte, config);
        if let Some(event) = event {
            led.insert(begins, (event, gateway.receiver()));
        }
        if event.is_some() || *byte == b'$' {
            begins = place + usize::from(*byte != b'$');
        }
    }
    led
}

const BELIEVING: Config<()> = Config {
    max_speed_m_s: f32::INFINITY,
    min_speed_m_s: 0.0,
    ..Config::new(())
};

/// What differs between a sentence as it was read and as it should be.
fn differences(expected: &Expected, stated: &Receiver) -> String {
    let mut text = String::new();
    if expected.time_ms.is_some() && expected.time_ms != stated.time_ms {
        write!(text, " time {:?}", stated.time_ms).unwrap();
    }
    let place = stated.place.filter(|place| place.age_ms == 0);
    let place = place.map(|place| [place.value.latitude_e7(), place.value.longitude_e7()]);
    if expected.place.is_some() && expected.place != place {
        write!(text, " place {place:?} not {:?}", expected.place).unwrap();
    }
    let speed = stated.speed_m_s.filter(|speed| speed.age_ms == 0);
    let mut compare = |name: &str, expected: Option<f64>, stated: Option<f32>| {
        let stated = stated.map(f64::from);
        let is_same = expected
            .zip(stated)
            .is_some_and(|(a, b)| (a - b).abs() < 2e-5);
        if expected.is_some() && !is_same {
            write!(text, " {name} {stated:?} not {expected:?}").unwrap();
        }
    };
    let knots = |speed: f64| speed * 1852.0 / 3600.0;
    compare(
        "speed",
        expected.speed_knots.map(knots),
        speed.map(|speed| speed.value),
    );
    // Without a speed a course is not used.
    let course = expected
        .course_deg
        .filter(|_| expected.speed_knots.is_some());
    compare(
        "course",
        course,
        stated.course_deg.map(|course| course.value),
    );
    compare(
        "heading",
        expected.heading_deg,
        stated.heading_deg.map(|heading| heading.value),
    );
    text
}

#[test]
fn every_sentence_is_used_as_it_says_or_refused_for_a_reason() {
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = String::new();
    for log in logs::read("every_sentence_is_used_as_it_says_or_refused_for_a_reason") {
        let led = replay(&log, &BELIEVING);
        for expected in &log.expected {
            let Some((event, stated)) = led.get(&expected.offset) else {
                writeln!(wrong, "{} {}: lost", log.name, expected.offset).unwrap();
                continue;
            };
            match event {
                Event::Used => {
                    let found = differences(expected, stated);
                    if !found.is_empty() {
                        writeln!(
                            wrong,
                            "{} {} {}:{found}",
                            log.name, expected.offset, expected.kind
                        )
                        .unwrap();
                    }
                }
                Event::Rejected(reason) => {
                    let what = format!(
                        "{} {} {reason:?} {}",
                        expected.kind, expected.status, log.name
                    );
                    *reasons.entry(what).or_default() += 1;
                }
                other => writeln!(wrong, "{} {}: {other:?}", log.name, expected.offset).unwrap(),
            }
        }
    }
    for (reason, count) in reasons {
        println!("{count} {reason}");
    }
    assert!(wrong.is_empty(), "{wrong}");
}
