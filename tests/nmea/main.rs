//! Logs of real receivers through a vehicle's gateway: what they say is used, or refused for a reason that stands in a table.
//!
//! The logs are those of gpsd (BSD-2-Clause), in the folder `nmea` of the directory that `FOXHUNT_DATA` names. Each sentence
//! was decoded independently, with exact decimals.

mod logs;

use foxhunt::ConfigError;
use foxhunt::aoa::{Answer, Locate, NotObservable, Observation, PushError};
use foxhunt::gateway::formats::All;
use foxhunt::gateway::{Config, Counters, Event, Receiver, Rejected, ShortReport, Vehicle};
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

    fn push<R: Rng + ?Sized>(
        &mut self,
        _: &Observation,
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

/// What differs between a sentence as it was read and as it should be: nothing in times and places, in speeds half of the
/// fourth decimal of a knot, in angles the last bit of an f32.
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
            .is_some_and(|(a, b)| (a - b).abs() < 3e-5);
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

/// How many of a log's sentences were refused, by kind, status and reason.
type Refused = BTreeMap<String, usize>;

/// Reads a log, whatever the receiver's jumps; collects what is refused, and returns what is wrong.
fn compare(log: &Log, refused: &mut Refused) -> String {
    let mut wrong = String::new();
    let led = replay(log, &BELIEVING);
    for expected in &log.expected {
        let Expected {
            offset,
            kind,
            status,
            ..
        } = expected;
        match led.get(offset) {
            Some((Event::Used, stated)) => {
                let found = differences(expected, stated);
                if !found.is_empty() {
                    writeln!(wrong, "{} {offset} {kind}:{found}", log.name).unwrap();
                }
            }
            Some((Event::Rejected(reason), _)) => {
                let what = format!("{kind:4}{status:3}{reason:?}");
                *refused.entry(what).or_default() += 1;
            }
            other => writeln!(wrong, "{} {offset} {kind}: {other:?}", log.name).unwrap(),
        }
    }
    wrong
}

#[test]
fn every_sentence_is_used_as_it_says_or_refused_for_a_reason() {
    let logs = logs::read("every_sentence_is_used_as_it_says_or_refused_for_a_reason");
    if logs.is_empty() {
        return;
    }
    let mut refused = Refused::new();
    let wrong: String = logs.iter().map(|log| compare(log, &mut refused)).collect();
    assert!(wrong.is_empty(), "{wrong}");
    let mut table = String::new();
    for (what, count) in refused {
        writeln!(table, "{count:4} {what}").unwrap();
    }
    hold("refused.txt", &table);
}

/// Every line of every log, by what became of it with the defaults: positions wait to be confirmed.
#[test]
fn lines_of_logs_by_what_became_of_them() {
    let logs = logs::read("lines_of_logs_by_what_became_of_them");
    if logs.is_empty() {
        return;
    }
    let mut table = String::new();
    for log in logs {
        let mut gateway = Gateway::EMPTY;
        for byte in &log.bytes {
            gateway.push(0, *byte, &Config::new(()));
        }
        let counters = gateway.counters();
        row(&mut table, &log.name, counters);
        assert_eq!(gateway.port_counters(0), Some(counters));
    }
    hold("counts.txt", &table);
}

fn row(table: &mut String, name: &str, counters: &Counters) {
    let (lines, used, others) = (counters.lines, counters.sentences, counters.ignored);
    write!(
        table,
        "{name}: {lines} lines, {used} used, {others} for others"
    )
    .unwrap();
    let mut sum = used + others;
    for reason in Rejected::ALL {
        let count = counters.rejected(reason);
        if count > 0 {
            write!(table, ", {count} {reason:?}").unwrap();
        }
        sum += count;
    }
    table.push('\n');
    assert_eq!(sum, lines);
}

/// Compares a table with the one that is checked in, or, with `BLESS` in the environment, takes its place.
fn hold(name: &str, table: &str) {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/nmea")
        .join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&file, table).unwrap();
    }
    let known = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(known == table, "{} is not\n{table}", file.display());
}
