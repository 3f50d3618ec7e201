//! The whole gateway, line by line.

extern crate std;
use super::*;
use crate::aoa::locator::{self, Locator};
use crate::gateway::sentence::checksum;
use std::{format, string::String, vec::Vec};

type Gateway = Vehicle<Locator<60, 16>>;

fn gateway(settings: Settings) -> Gateway {
    Vehicle::new(settings, Locator::new(locator::Settings::new()))
}

fn sentence(payload: &str) -> String {
    format!("${payload}*{:02X}\r\n", checksum(payload.as_bytes()))
}

/// Position, moving east at 50 knots.
fn rmc(time: &str) -> String {
    sentence(&format!(
        "GPRMC,{time},A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A"
    ))
}

fn kraken(milliseconds: i64, degrees: f32, place: &str) -> String {
    format!("{milliseconds}, {degrees}, 80.0, -30, 433920000, UCA, 0, fox, {place}, R, R, R, R\n")
}

/// 12:00:00 UTC on 22 November 2026.
const NOON: i64 = 1_795_348_800_000;
const NOWHERE: &str = "0.0, 0.0, 0, 0, GPS";

fn push(gateway: &mut Gateway, text: &str) -> Vec<Event> {
    text.bytes().filter_map(|byte| gateway.push(byte)).collect()
}

/// The events of all lines.
fn events(settings: Settings, text: &str) -> Vec<Event> {
    push(&mut gateway(settings), text)
}

/// What the last line leads to, if it is a bearing: degrees clockwise from north, or the reason.
fn last_bearing(settings: Settings, text: &str) -> Result<f32, Rejected> {
    let mut gateway = gateway(settings);
    match push(&mut gateway, text).last() {
        Some(Event::Rejected(reason)) => Err(*reason),
        _ => Ok(gateway.observation().unwrap().bearing().compass_degrees()),
    }
}

#[test]
fn when_and_where_the_vehicle_was() {
    let mut gateway = gateway(Settings::default());
    assert_eq!((gateway.time_ms(), gateway.place()), (None, None));
    let receiver = Geodetic::new(481_173_000, 115_166_667).unwrap();
    push(&mut gateway, &rmc("120000"));
    assert_eq!((gateway.time_ms(), gateway.place()), (None, Some(receiver)));
    push(&mut gateway, &kraken(NOON + 250, 10.0, NOWHERE));
    assert_eq!(gateway.time_ms(), Some(43_200_250));
    gateway.restart();
    assert_eq!((gateway.time_ms(), gateway.place()), (None, Some(receiver)));

    // Where no receiver says it, the direction finder does.
    let mut gateway = super::tests::gateway(Settings::default());
    push(
        &mut gateway,
        &kraken(NOON, 10.0, "48.5, 11.25, 90, 90, GPS"),
    );
    let own = Geodetic::new(485_000_000, 112_500_000).unwrap();
    assert_eq!(gateway.place(), Some(own));
}

#[test]
fn heading_by_compass_by_course_or_none() {
    let settings = Settings::default();
    let near = |result: Result<f32, Rejected>, degrees: f32| {
        assert!(
            (result.unwrap() - degrees).abs() < 1e-3,
            "{result:?} is not {degrees}"
        );
    };
    let fix = rmc("120000");
    near(last_bearing(settings, &format!("{fix}%010/9\r")), 100.0);
    let compass = format!("{fix}{}", sentence("HEHDT,300.0,T"));
    near(last_bearing(settings, &format!("{compass}%010/9\r")), 310.0);
    let north = settings.with_reference(BearingReference::TrueNorth);
    near(last_bearing(north, &format!("{compass}%010/9\r")), 10.0);

    // The course of a vehicle that has slowed down is none.
    let slow = sentence("GPVTG,090.0,T,,M,002.0,N,3.7,K,A");
    assert_eq!(
        last_bearing(settings, &format!("{fix}{slow}%010/9\r")),
        Err(Rejected::NoHeading)
    );
    near(last_bearing(north, &format!("{fix}{slow}%010/9\r")), 10.0);
    // An old heading does not hold: back to the course.
    let later = format!("{compass}{}%010/9\r", rmc("120003"));
    near(last_bearing(settings, &later), 100.0);
}

#[test]
fn a_bearing_belongs_to_where_the_vehicle_was_when_it_was_taken() {
    let turned = |time: &str, degrees: u32| rmc(time) + &sentence(&format!("HEHDT,{degrees}.0,T"));
    let poses = turned("120000", 350) + &turned("120001", 10);
    let line = kraken(NOON + 1_000, 20.0, NOWHERE);
    let at = |latency: u32| {
        let line = line.replace("UCA, 0,", &format!("UCA, {latency},"));
        last_bearing(Settings::default(), &(poses.clone() + &line)).unwrap()
    };
    for (latency, degrees) in [(0, 30.0), (250, 25.0), (500, 20.0), (1_000, 10.0)] {
        assert!(
            (at(latency) - degrees).abs() < 1e-3,
            "{latency} ms: {}",
            at(latency)
        );
    }
    // Half a second after the last heading, as it turned.
    let line = kraken(NOON + 1_500, 20.0, NOWHERE);
    let bearing = last_bearing(Settings::default(), &(poses + &line)).unwrap();
    assert!((bearing - 40.0).abs() < 1e-3);
}

#[test]
fn a_course_is_no_heading_in_a_bend() {
    let fix = rmc("120000");
    let bend = |course: &str| {
        let turned = rmc("120001").replace("090.0", course);
        let payload = turned.trim_start_matches('$').split('*').next().unwrap();
        fix.clone() + &sentence(payload) + "%010/9\r"
    };
    assert!(last_bearing(Settings::default(), &bend("098.0")).is_ok());
    assert_eq!(
        last_bearing(Settings::default(), &bend("105.0")),
        Err(Rejected::Turning)
    );
    let agile = Settings::default()
        .with_maximum_turn_rate_deg_s(20.0)
        .unwrap();
    assert!(last_bearing(agile, &bend("105.0")).is_ok());
}

#[test]
fn the_course_of_a_direction_finder_that_stands_is_no_heading() {
    let line = |second: i64, place: &str, main: &str| {
        let pose = format!("{place}, 11.5, 30.0, 60.0, {main}");
        kraken(NOON + 1_000 * second, 20.0, &pose)
    };
    let moving = line(0, "48.1", "GPS") + &line(1, "48.1001", "GPS");
    let bearing = last_bearing(Settings::default(), &moving).unwrap();
    assert!((bearing - 50.0).abs() < 1e-3);
    let standing = moving + &line(2, "48.1001", "GPS");
    assert_eq!(
        last_bearing(Settings::default(), &standing),
        Err(Rejected::NoHeading)
    );
    let with_compass = standing + &line(3, "48.1001", "Compass");
    let bearing = last_bearing(Settings::default(), &with_compass).unwrap();
    assert!((bearing - 80.0).abs() < 1e-3);
}

#[test]
fn a_direction_finder_that_stands_is_not_judged_by_an_instant() {
    let line = |milliseconds: i64, place: &str| {
        let pose = format!("{place}, 11.5, 30.0, 60.0, GPS");
        kraken(NOON + milliseconds, 20.0, &pose)
    };
    let standing = line(0, "48.1") + &line(1_000, "48.1");
    // Two channels at one time; and a place that is newer than the last by less than it takes to judge.
    for (milliseconds, place) in [(1_000, "48.1"), (1_400, "48.1001")] {
        let text = standing.clone() + &line(milliseconds, place);
        let last = last_bearing(Settings::default(), &text);
        assert_eq!(last, Err(Rejected::NoHeading));
    }
    // Twice a second, with places of once a second, from a vehicle that moves.
    let places = ["48.1", "48.1", "48.1001", "48.1001", "48.1002", "48.1002"];
    let moving: String = (0..)
        .zip(places)
        .map(|(i, place)| line(500 * i, place))
        .collect();
    assert!(last_bearing(Settings::default(), &moving).is_ok());
}

/// Counts the seconds that it is told of.
struct Seconds(f32);

impl Locate for Seconds {
    const DETAILS: bool = false;

    fn push_after<R: crate::random::Rng + ?Sized>(
        &mut self,
        _: Observation,
        seconds: f32,
        _: &mut R,
    ) -> Answer {
        self.0 += seconds;
        self.answer()
    }

    fn answer(&self) -> Answer {
        Answer::NotObservable(NotObservable::NoIntersection)
    }

    fn reset(&mut self) {}
}

#[test]
fn time_is_told_once() {
    let mut gateway: Vehicle<Seconds> = Vehicle::new(Settings::new(), Seconds(0.0));
    let mut push = |text: &str| text.bytes().filter_map(|byte| gateway.push(byte)).count();
    for second in 0..60 {
        // A bearing of this second, and one of half a second ago.
        push(&rmc(&format!("1200{second:02}")));
        push("%045/9\r");
        let late = NOON + 1_000 * second - 500;
        push(&kraken(late, 45.0, NOWHERE));
    }
    assert!(gateway.counters().bearings > 100);
    assert!(
        (gateway.locator().0 - 59.0).abs() < 1.0,
        "{}",
        gateway.locator().0
    );
}

#[test]
fn only_the_configured_direction_finder_is_heard() {
    let fix = rmc("120000");
    let lines = [
        (Finder::Agrelo, String::from("%010/9\r")),
        (Finder::Kraken, kraken(NOON, 10.0, NOWHERE)),
        (
            Finder::Ublox,
            String::from("+UUDF:6C1DEBA4241B,-65,10,0,0,37,\"\",\"\",1\r"),
        ),
    ];
    for (finder, line) in &lines {
        assert!(last_bearing(Settings::default(), &format!("{fix}{line}")).is_ok());
        for (wanted, _) in &lines {
            let settings = Settings::default().with_finder(*wanted);
            let heard = last_bearing(settings, &format!("{fix}{line}"));
            let expected = if wanted == finder {
                Ok(())
            } else {
                Err(Rejected::OtherFinder)
            };
            assert_eq!(heard.map(|_| ()), expected);
        }
    }
}

#[test]
fn a_line_with_its_own_position_needs_no_receiver() {
    let own = kraken(NOON, 20.0, "48.1, -11.5, 5.0, 350.0, Compass");
    let bearing = last_bearing(Settings::default(), &own).unwrap();
    assert!((bearing - 10.0).abs() < 1e-3);
    let none = kraken(NOON, 20.0, NOWHERE);
    assert_eq!(
        last_bearing(Settings::default(), &none),
        Err(Rejected::NoPosition)
    );
}

#[test]
fn positions_must_be_fresh() {
    let settings = Settings::default();
    let fix = rmc("120000");
    for (milliseconds, result) in [
        (0, Ok(())),
        (2_000, Ok(())),
        (-2_000, Ok(())),
        (2_001, Err(Rejected::StalePosition)),
        (-2_001, Err(Rejected::StalePosition)),
    ] {
        let text = format!("{fix}{}", kraken(NOON + milliseconds, 10.0, NOWHERE));
        assert_eq!(
            last_bearing(settings, &text).map(|_| ()),
            result,
            "{milliseconds} ms"
        );
    }
    // The receiver has lost its fix but not its time.
    let void = sentence("GPRMC,120003,V,,,,,,,221126,,,N");
    let text = format!("{fix}{void}%010/9\r");
    assert_eq!(last_bearing(settings, &text), Err(Rejected::StalePosition));
    // Over midnight.
    let text = format!(
        "{}{}",
        rmc("235959.500"),
        kraken(NOON + 43_200_500, 10.0, NOWHERE)
    );
    assert!(last_bearing(settings, &text).is_ok());
}

#[test]
fn a_silent_receiver_becomes_stale() {
    let settings = Settings::default().with_undated_bearings(3);
    let mut gateway = gateway(settings);
    push(&mut gateway, &rmc("120000"));
    for _ in 0..2 {
        push(&mut gateway, &"%010/9\r".repeat(1_000));
        assert_eq!(gateway.counters().bearings, 3);
        // A receiver that hangs says the same again.
        push(&mut gateway, &rmc("120000"));
    }
    assert_eq!(gateway.counters().rejected(Rejected::StalePosition), 1_997);
    push(&mut gateway, &format!("{}%010/9\r", rmc("120001")));
    assert_eq!(gateway.counters().bearings, 4);
}

#[test]
fn a_receiver_in_doubt_lends_no_time() {
    let text = format!("{}{}%010/9\r", rmc("120000"), rmc("115959"));
    assert_eq!(
        last_bearing(Settings::default(), &text),
        Err(Rejected::StalePosition)
    );
    let text = text + &rmc("120001") + "%010/9\r";
    assert!(last_bearing(Settings::default(), &text).is_ok());
}

#[test]
fn rejected_with_the_reason() {
    let fix = rmc("120000");
    let run = |text: String| last_bearing(Settings::default(), &text);
    assert_eq!(run(format!("{fix}%010/3\r")), Err(Rejected::LowQuality));
    assert_eq!(run(format!("{fix}%361/9\r")), Err(Rejected::OutOfRange));
    assert_eq!(run(String::from("%010/9\r")), Err(Rejected::NoPosition));
    assert_eq!(run(format!("{fix}hello\r")), Err(Rejected::Unparsable));
    assert_eq!(
        run(format!("{fix}{}", rmc("115959"))),
        Err(Rejected::TimeBackwards)
    );
    let first = kraken(NOON, 10.0, NOWHERE);
    let second = kraken(NOON - 1, 10.0, NOWHERE);
    assert_eq!(
        run(format!("{fix}{first}{second}")),
        Err(Rejected::TimeBackwards)
    );
    // A thousand kilometres from the first bearing; and one that is first, but at the pole.
    let here = kraken(NOON, 10.0, "48.1, 11.5, 0, 0, GPS");
    let far = kraken(NOON, 10.0, "58.1, 11.5, 0, 0, GPS");
    assert_eq!(run(format!("{here}{far}")), Err(Rejected::OutOfRange));
    assert_eq!(
        run(kraken(NOON, 10.0, "89.9, 11.5, 0, 0, GPS")),
        Err(Rejected::OutOfRange)
    );
}

#[test]
fn a_wild_first_position_does_not_last() {
    let place = |latitude: &str| kraken(NOON, 10.0, &format!("{latitude}, 11.5, 0, 0, GPS"));
    let (wild, wilder, here) = (place("58.1"), place("68.1"), place("48.1"));
    let mut gateway = gateway(Settings::default());
    let mut run = |text: &str| push(&mut gateway, text).pop().unwrap();
    let first = Event::NotObservable(NotObservable::TooFewBearings { have: 1 });
    let far = Event::Rejected(Rejected::OutOfRange);
    assert_eq!(run(&wild), first);
    // Strays must follow each other and be near each other.
    assert_eq!(run(&format!("{here}{here}")), far);
    assert_eq!(run(&wilder), far);
    assert_eq!(run(&format!("{here}{here}")), far);
    assert!(matches!(run(&wild), Event::NotObservable(_)));
    assert_eq!(run(&format!("{here}{here}")), far);
    assert_eq!(run(&here), first);
    assert!(matches!(run(&here), Event::NotObservable(_)));
    assert_eq!(gateway.plane().unwrap().origin().latitude_e7(), 481_000_000);
}

#[test]
fn strays_do_not_move_the_origin_of_a_fix() {
    let mut gateway = gateway(Settings::default());
    push(&mut gateway, &drive(10));
    assert!(gateway.report().starts_with("$PFOXF"));
    let plane = *gateway.plane().unwrap();
    let far = kraken(NOON, 10.0, "58.1, 11.5, 0, 0, GPS").repeat(10);
    assert_eq!(
        push(&mut gateway, &far),
        [Event::Rejected(Rejected::OutOfRange); 10]
    );
    assert_eq!(gateway.plane(), Some(&plane));
}

/// Two seconds apart, 100 m further east each, a source 100 m ahead and 600 m to the left.
fn drive(lines: i32) -> String {
    (0..lines)
        .map(|k| {
            let (east, time) = (100.0 * k as f32, 2 * k);
            let longitude = sentence(&format!(
                "GPRMC,1200{time:02},A,4807.038,N,01131.{:06.0},E,97.2,090.0,221126,,,A",
                east / 1_240.0 * 1e6,
            ));
            let relative = (0.0f32 - 600.0)
                .atan2(500.0 - east)
                .to_degrees()
                .rem_euclid(360.0);
            format!("{longitude}%{relative:03.0}/8\r")
        })
        .collect()
}

#[test]
fn reports_a_fix_and_its_status() {
    let mut gateway = gateway(Settings::default());
    push(&mut gateway, &drive(1));
    assert!(
        gateway.report().starts_with("$PFOXN,120000.000,FEW,1,,*"),
        "{}",
        gateway.report()
    );
    push(&mut gateway, &drive(10));
    let fix = String::from(gateway.report());
    assert!(fix.starts_with("$PFOXF,120018.000,4807."), "{fix}");

    let queried = push(&mut gateway, "$PFOXQ*50\r\n");
    assert_eq!(queried, [Event::Queried]);
    let (again, status) = gateway.report().split_at(fix.len());
    assert_eq!(again, fix);
    assert!(status.starts_with("$PFOXS,23,11,11,0,"), "{status}");

    // The next line takes the report away.
    push(&mut gateway, "\r\n%");
    assert!(!gateway.report().is_empty());
    push(&mut gateway, "x\r\n");
    assert!(gateway.report().is_empty());

    gateway.restart();
    push(&mut gateway, "$PFOXQ*50\r\n");
    assert!(
        gateway.report().starts_with("$PFOXN,,FEW,0,,*"),
        "{}",
        gateway.report()
    );
    push(&mut gateway, "%010/9\r");
    assert!(gateway.report().contains(",FEW,1,,*"));
    assert_eq!(gateway.counters().bearings, 12);

    let restarted = push(&mut gateway, "$PFOXR*53\r\n");
    assert_eq!(restarted, [Event::Restarted]);
    assert!(gateway.report().starts_with("$PFOXN,,FEW,0,,*"));
    assert!(gateway.plane().is_none());
}

#[test]
fn reports_are_rare() {
    let fix = rmc("120000");
    let mut gateway = gateway(Settings::default());
    push(&mut gateway, &fix);
    let mut reports = 0;
    for k in 0..20 {
        let time = NOON + i64::from(k) * 100;
        assert_eq!(push(&mut gateway, &kraken(time, 10.0, NOWHERE)).len(), 1);
        reports += usize::from(!gateway.report().is_empty());
    }
    assert_eq!(reports, 2);
}

#[test]
fn a_heading_before_any_time_is_not_used() {
    let text = sentence("HEHDT,300.0,T") + &sentence("GPVTG,090.0,T,,M,050.0,N,92.6,K,A");
    let mut gateway = gateway(Settings::default());
    let none = Event::Rejected(Rejected::NoFix);
    assert_eq!(push(&mut gateway, &text), [none, none]);
    assert_eq!(gateway.counters().sentences, 0);
    push(&mut gateway, &(rmc("120000") + &text));
    assert_eq!(gateway.counters().sentences, 3);
}

#[test]
fn sentences_are_counted() {
    let settings = Settings::default();
    let text = format!(
        "{}{}{}$GPHDT,1,T*00\r\n",
        rmc("120000"),
        sentence("GPGSV,1,1,00"),
        sentence("GPRMC,120001,A,0000.0,N,00000.0,E,0,,221126,,,A"),
    );
    let mut gateway = gateway(settings);
    push(&mut gateway, &text);
    let counters = gateway.counters();
    assert_eq!(
        (counters.lines, counters.sentences, counters.ignored),
        (4, 1, 1)
    );
    assert_eq!(counters.rejected(Rejected::NullPosition), 1);
    assert_eq!(counters.rejected(Rejected::Checksum), 1);
    assert!(
        events(settings, &text)
            .iter()
            .all(|e| matches!(e, Event::Rejected(_) | Event::Other))
    );
}

#[test]
fn a_restored_gateway_goes_on() {
    use crate::snapshot::{Error, largest};
    let settings = Settings::default().with_report_interval_ms(4_000).unwrap();
    let lines = drive(12);
    // A sentence of the receiver and the bearing after it.
    let steps: Vec<&str> = lines.split_inclusive('\r').collect();
    let steps: Vec<String> = steps.chunks(2).map(|step| step.concat()).collect();
    assert_eq!(steps.len(), 12);
    let reports = |gateway: &mut Gateway, steps: &[String]| -> Vec<String> {
        let report = |step: &String| {
            push(gateway, step);
            String::from(gateway.report())
        };
        steps.iter().map(report).collect()
    };
    let mut buffer = [0; largest::<Gateway>()];
    let mut whole = gateway(settings);
    let all = reports(&mut whole, &steps);
    push(&mut whole, "$PFOXQ*50\r\n");
    for step in 0..=steps.len() {
        let mut before = gateway(settings);
        reports(&mut before, &steps[..step]);
        let bytes = before.snapshot(&mut buffer).unwrap();
        let mut after = gateway(settings.with_seed(99));
        // What it hears before it is restored holds; what it is in the midst of, too.
        push(&mut after, &rmc("115959"));
        push(&mut after, "%0");
        after.restore(bytes).unwrap();
        assert_eq!(after.plane(), before.plane());
        assert_eq!(after.observation(), before.observation());
        assert_eq!(after.counters(), before.counters());
        assert_eq!(after.locator().answer(), before.locator().answer());
        push(&mut after, "\r\n");
        after.restore(bytes).unwrap();
        if step == 0 {
            // Its generator had not been seeded yet.
            continue;
        }
        assert_eq!(reports(&mut after, &steps[step..]), all[step..], "{step}");
        push(&mut after, "$PFOXQ*50\r\n");
        assert_eq!(after.report(), whole.report());
    }

    let bytes = whole.snapshot(&mut buffer).unwrap();
    let other = locator::Settings::new().moves(3).unwrap();
    let mut other: Gateway = Vehicle::new(settings, Locator::new(other));
    assert_eq!(other.restore(bytes), Err(Error::Settings));
    assert!(other.plane().is_none());
}

#[test]
fn sentences_of_others_are_left_to_them() {
    let mut gateway = gateway(Settings::new());
    let text = "PUBX,00,081350.00,4717.113210,N";
    let events = push(&mut gateway, &sentence(text));
    assert_eq!(events, [Event::Other]);
    assert!(
        gateway
            .line()
            .starts_with(b"$PUBX,00,081350.00,4717.113210,N*")
    );
    assert_eq!((gateway.report(), gateway.counters().ignored), ("", 1));
}

mod spectrum;
