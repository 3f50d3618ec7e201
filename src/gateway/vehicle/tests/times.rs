//! Positions, times and the origin.

use super::*;
use crate::ConfigError;
use crate::aoa::{NotObservable, PushError};
use crate::gateway::history::Aged;

#[test]
fn time_and_place_are_those_of_the_last_lines() {
    let mut gateway = gateway(CONFIG);
    assert_eq!(
        (gateway.vehicle().time_ms(), gateway.vehicle().place()),
        (None, None)
    );
    let receiver = Geodetic::new(481_173_000, 115_166_667).unwrap();
    push(&mut gateway, &rmc("120000"));
    assert_eq!(
        (gateway.vehicle().time_ms(), gateway.vehicle().place()),
        (None, Some(receiver))
    );
    push(&mut gateway, &kraken(NOON + 250, 10.0, NOWHERE));
    assert_eq!(gateway.vehicle().time_ms(), Some(43_200_250));
    gateway.vehicle_mut().restart();
    assert_eq!(
        (gateway.vehicle().time_ms(), gateway.vehicle().place()),
        (None, Some(receiver))
    );

    // Where no receiver says it, the direction finder does.
    let mut gateway = super::gateway(CONFIG);
    push(
        &mut gateway,
        &kraken(NOON, 10.0, "48.5, 11.25, 90, 90, GPS"),
    );
    let own = Geodetic::new(485_000_000, 112_500_000).unwrap();
    assert_eq!(gateway.vehicle().place(), Some(own));
}

#[test]
fn a_line_with_its_own_position_needs_no_receiver() {
    let own = kraken(NOON, 20.0, "48.1, -11.5, 5.0, 350.0, Compass");
    let bearing = last_bearing(CONFIG, &own).unwrap();
    assert!((bearing - 10.0).abs() < 1e-3);
    let none = kraken(NOON, 20.0, NOWHERE);
    assert_eq!(last_bearing(CONFIG, &none), Err(Rejected::NoPosition));
}

#[test]
fn positions_must_be_fresh() {
    let config = CONFIG;
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
            last_bearing(config, &text).map(|_| ()),
            result,
            "{milliseconds} ms"
        );
    }
    // The receiver has lost its fix but not its time.
    let void = sentence("GPRMC,120003,V,,,,,,,221126,,,N");
    let text = format!("{fix}{void}%010/9\r");
    assert_eq!(last_bearing(config, &text), Err(Rejected::StalePosition));
    // Over midnight.
    let text = format!(
        "{}{}",
        rmc("235959.500"),
        kraken(NOON + 43_200_500, 10.0, NOWHERE)
    );
    assert!(last_bearing(config, &text).is_ok());
}

#[test]
fn a_silent_receiver_becomes_stale() {
    let config = Config {
        undated_bearings: 3,
        ..CONFIG
    };
    let mut gateway = gateway(config);
    push(&mut gateway, &rmc("120000"));
    for _ in 0..2 {
        push(&mut gateway, &"%010/9\r".repeat(1_000));
        assert_eq!(gateway.vehicle().counters().bearings, 3);
        // A receiver that hangs says the same again.
        push(&mut gateway, &rmc("120000"));
    }
    assert_eq!(
        gateway
            .vehicle()
            .counters()
            .rejected(Rejected::StalePosition),
        1_997
    );
    push(&mut gateway, &format!("{}%010/9\r", rmc("120001")));
    assert_eq!(gateway.vehicle().counters().bearings, 4);
}

#[test]
fn a_receiver_in_doubt_lends_no_time() {
    let text = format!("{}{}%010/9\r", rmc("120000"), rmc("115959"));
    assert_eq!(last_bearing(CONFIG, &text), Err(Rejected::StalePosition));
    let text = text + &rmc("120001") + "%010/9\r";
    assert!(last_bearing(CONFIG, &text).is_ok());
}

#[test]
fn a_wrong_first_position_does_not_last() {
    let mut gateway = gateway(CONFIG);
    let mut time = NOON;
    // Any number of bearings at a latitude, a second apart: what the last leads to.
    let mut run = |latitude: &str, count: usize| {
        let mut last = None;
        for _ in 0..count {
            time += 1_000;
            let line = kraken(time, 10.0, &format!("{latitude}, 11.5, 0, 0, Compass"));
            last = push(&mut gateway, &line).pop();
        }
        last.unwrap()
    };
    let (wrong, other, right) = ("58.1", "68.1", "48.1");
    let first = Event::NotObservable(NotObservable::TooFewBearings { have: 1 });
    let far = Event::Rejected(Rejected::OutOfRange);
    assert_eq!(run(wrong, 1), first);
    // Strays must follow each other and be near each other.
    assert_eq!(run(right, 2), far);
    assert_eq!(run(other, 1), far);
    assert_eq!(run(right, 2), far);
    assert!(matches!(run(wrong, 1), Event::NotObservable(_)));
    assert_eq!(run(right, 2), far);
    assert_eq!(run(right, 1), first);
    assert!(matches!(run(right, 1), Event::NotObservable(_)));
    let plane = gateway.vehicle().plane().unwrap();
    assert_eq!(plane.origin().latitude_e7(), 481_000_000);
}

#[test]
fn strays_do_not_move_the_origin_of_a_fix() {
    let mut gateway = gateway(CONFIG);
    push(&mut gateway, &drive(10));
    assert!(gateway.vehicle().report().starts_with("$PFOXF"));
    let plane = *gateway.vehicle().plane().unwrap();
    let far = kraken(NOON, 10.0, "58.1, 11.5, 0, 0, GPS").repeat(10);
    assert_eq!(
        push(&mut gateway, &far),
        [Event::Rejected(Rejected::OutOfRange); 10]
    );
    assert_eq!(gateway.vehicle().plane(), Some(&plane));
}

#[test]
fn the_receiver_states_ages() {
    let mut gateway = gateway(CONFIG);
    let receiver = |gateway: &Plain| gateway.vehicle().receiver();
    assert_eq!(receiver(&gateway).time_ms, None);
    push(&mut gateway, &(rmc("120000") + &sentence("HEHDT,300.0,T")));
    let void = sentence("GPRMC,120003,V,,,,,,,221126,,,N");
    push(&mut gateway, &void);
    let known = receiver(&gateway);
    assert_eq!(known.time_ms, Some(43_203_000));
    let place = Geodetic::new(481_173_000, 115_166_667).unwrap();
    let aged = |value| {
        Some(Aged {
            value,
            age_ms: 3_000,
        })
    };
    assert_eq!(known.place.map(|place| place.value), Some(place));
    assert_eq!(
        (known.course_deg, known.heading_deg),
        (aged(90.0), aged(300.0))
    );
}

/// Keeps the times of the bearings that it is given, and refuses what the configuration says.
#[derive(Debug)]
struct Times(Vec<u32>);

impl Locate for Times {
    type Config = Option<PushError>;

    const EMPTY: Self = Self(Vec::new());

    fn check(_: &Self::Config) -> Result<(), ConfigError> {
        Ok(())
    }

    fn push<R: crate::random::Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        refused: &Self::Config,
        _: &mut R,
    ) -> Result<Answer, PushError> {
        refused.map_or(Ok(()), Err)?;
        self.0.push(observation.time_ms());
        Ok(self.answer())
    }

    fn answer(&self) -> Answer {
        Answer::NotObservable(NotObservable::NoIntersection)
    }

    fn reset(&mut self) {
        self.0.clear();
    }
}

/// Every position is believed at once.
fn believing<C>(locator: C) -> Config<C> {
    Config {
        max_speed_m_s: f32::INFINITY,
        ..Config::new(locator)
    }
}

fn times_of(text: &str) -> Vec<u32> {
    let mut gateway: Gateway<Times> = Gateway::new(believing(None)).unwrap();
    for byte in text.bytes() {
        gateway.push(0, byte);
    }
    gateway.vehicle().locator().0.clone()
}

#[test]
fn bearings_carry_one_clock_that_runs_on_over_midnight() {
    const DAY: u32 = 86_400_000;
    let bearing = |time: &str| rmc(time) + "%010/9\r";
    let text = bearing("235958") + &bearing("000001") + &bearing("120000") + &bearing("235950");
    let times = [DAY - 2_000, DAY + 1_000, DAY + DAY / 2, 2 * DAY - 10_000];
    assert_eq!(times_of(&text), times);
}

#[test]
fn bearings_keep_their_own_times() {
    let mut text = String::new();
    let mut expected = Vec::new();
    for second in 0..60 {
        // Two bearings of this second that state no time, and one of half a second ago.
        text += &(rmc(&format!("1200{second:02}")) + "%045/9\r%045/9\r");
        let late = 1_000 * second - 500;
        text += &kraken(NOON + late, 45.0, NOWHERE);
        let noon = 43_200_000 + 1_000 * second as u32;
        expected.extend([noon, noon + 1, noon - 500]);
    }
    assert_eq!(times_of(&text), expected);
}

#[test]
fn a_clock_that_was_set_back_goes_on() {
    let bearing = |time: &str| rmc(time) + "%010/9\r";
    let mut text = bearing("120000");
    // After five lines in a row the new time holds.
    for second in 0..8 {
        text += &bearing(&format!("1100{second:02}"));
    }
    let noon = 43_200_000;
    assert_eq!(
        times_of(&text),
        [noon, noon + 1, noon + 1_001, noon + 2_001, noon + 3_001]
    );
}

#[test]
fn what_the_locator_refuses_is_rejected() {
    for (error, reason) in [
        (PushError::TooOld, Rejected::TooOld),
        (PushError::Duplicate, Rejected::Duplicate),
    ] {
        let mut gateway: Gateway<Times> = Gateway::new(believing(Some(error))).unwrap();
        let text = rmc("120000") + "%010/9\r";
        let events: Vec<Event> = (text.bytes())
            .filter_map(|byte| gateway.push(0, byte))
            .collect();
        assert_eq!(events, [Event::Used, Event::Rejected(reason)]);
        assert_eq!(gateway.vehicle().counters().rejected(reason), 1);
        assert_eq!(gateway.vehicle().observation(), None);
        assert_eq!(gateway.vehicle().report(), "");
    }
    // A real one: the page of a KrakenSDR is asked twice.
    let line = rmc("120000") + &kraken(NOON, 45.0, NOWHERE);
    let again = line.clone() + &kraken(NOON, 45.0, NOWHERE);
    assert!(last_bearing(CONFIG, &line).is_ok());
    assert_eq!(last_bearing(CONFIG, &again), Err(Rejected::Duplicate));
}
