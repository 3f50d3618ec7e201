//! Which positions are believed, and what is lost with one that is not.

use super::*;

/// Positions as RMC, each at a second after noon, so many metres east.
fn at(positions: &[(u32, f32)]) -> String {
    positions
        .iter()
        .map(|(second, east)| {
            sentence(&format!(
                "GPRMC,12{:02}{:02},A,4807.038,N,01131.{:06.0},E,0.0,,221126,,,A",
                second / 60,
                second % 60,
                east / 1_240.0 * 1e6,
            ))
        })
        .collect()
}

/// Which of them are used with the defaults.
fn used(positions: &[(u32, f32)]) -> Vec<bool> {
    let mut gateway = gateway(Config::new(clean::Config::DEFAULT));
    let events = push(&mut gateway, &at(positions));
    let is_used = |event| match event {
        Event::Used => true,
        Event::Rejected(Rejected::Unconfirmed) => false,
        other => panic!("{other:?}"),
    };
    events.into_iter().map(is_used).collect()
}

#[test]
fn the_first_position_waits_for_a_second_of_another_time() {
    assert_eq!(used(&[(0, 0.0), (1, 20.0), (2, 40.0)]), [false, true, true]);
    assert_eq!(used(&[(0, 0.0), (0, 0.0), (1, 0.0)]), [false, false, true]);
    // The first was wrong, or the second.
    assert_eq!(
        used(&[(0, 900.0), (1, 0.0), (2, 0.0)]),
        [false, false, true]
    );
    assert_eq!(
        used(&[(0, 0.0), (1, 900.0), (2, 0.0), (3, 0.0)]),
        [false, false, false, true]
    );
}

#[test]
fn a_position_that_is_confirmed_was_right_from_the_start() {
    let mut gateway = gateway(Config::new(clean::Config::DEFAULT));
    push(&mut gateway, &at(&[(0, 0.0), (1, 100.0)]));
    let early = kraken(NOON, 20.0, NOWHERE);
    let north = Config {
        reference: BearingReference::TrueNorth,
        ..Config::new(clean::Config::DEFAULT)
    };
    let mut events = early
        .bytes()
        .filter_map(|byte| gateway.vehicle.push(0, byte, &north));
    assert!(matches!(events.next(), Some(Event::NotObservable(_))));
    drop(events);
    let [east, _] = gateway.vehicle().observation().unwrap().position();
    assert_eq!(east, 0.0);
}

#[test]
fn a_jump_waits() {
    // 150 m in a second may be the receiver's error; 200 m is not.
    assert_eq!(
        used(&[
            (0, 0.0),
            (1, 0.0),
            (2, 149.0),
            (3, 0.0),
            (4, 151.0),
            (5, 0.0)
        ]),
        [false, true, true, true, false, true]
    );
    // A jump that lasts.
    assert_eq!(
        used(&[(0, 0.0), (1, 0.0), (2, 900.0), (2, 900.0), (3, 900.0)]),
        [false, true, false, false, true]
    );
    // Wrong ones that do not agree.
    assert_eq!(
        used(&[
            (0, 0.0),
            (1, 0.0),
            (2, 900.0),
            (3, 300.0),
            (4, 600.0),
            (5, 601.0)
        ]),
        [false, true, false, false, false, true]
    );
}

#[test]
fn the_first_position_after_an_outage_waits() {
    assert_eq!(
        used(&[(0, 0.0), (1, 0.0), (3, 0.0), (33, 0.0), (34, 0.0)]),
        [false, true, true, false, true]
    );
    // A receiver that is always so slow is known after two.
    assert_eq!(
        used(&[(0, 0.0), (30, 0.0), (60, 0.0), (90, 0.0), (120, 0.0)]),
        [false, false, true, true, true]
    );
}

#[test]
fn a_bearing_of_a_position_that_waits_has_none() {
    let mut gateway = gateway(Config::new(clean::Config::DEFAULT));
    push(&mut gateway, &at(&[(0, 0.0)]));
    let bearing = push(&mut gateway, "%010/9\r");
    assert_eq!(bearing, [Event::Rejected(Rejected::NoPosition)]);
    let heading = push(&mut gateway, &sentence("HEHDT,300.0,T"));
    assert_eq!(heading, [Event::Rejected(Rejected::NoFix)]);
    let text = at(&[(1, 0.0)]) + &sentence("HEHDT,300.0,T") + "%010/9\r";
    let events = push(&mut gateway, &text);
    assert_eq!(events[..2], [Event::Used; 2]);
    assert!(matches!(events[2], Event::NotObservable(_)));
}

#[test]
fn what_follows_a_refused_position_has_no_time() {
    let motion = sentence("GPVTG,090.0,T,,M,050.0,N,92.6,K,A");
    let heading = sentence("HEHDT,300.0,T");
    let refused = [
        sentence("GPRMC,,V,,,,,,,,,,N"),
        sentence("GPRMC,120001,A,4807.038,N,01131.000,E,0,,221126,,,S"),
        sentence("GPRMC,1200,A,4807.038,N,01131.000,E,0,,221126,,,A"),
        sentence("GPGGA,120001,4807.038,N,01131.000,E,8,08,0.9,,M,,M,,"),
        rmc("120001").replace("4807.038", "4807.039"),
        rmc("115959"),
    ];
    for position in refused {
        let mut gateway = gateway(CONFIG);
        push(&mut gateway, &rmc("120000"));
        let events = push(&mut gateway, &(position.clone() + &motion + &heading));
        assert!(matches!(events[0], Event::Rejected(_)), "{position}");
        assert_eq!(
            events[1..],
            [Event::Rejected(Rejected::NoFix); 2],
            "{position}"
        );
        let events = push(&mut gateway, &(rmc("120002") + &motion + &heading));
        assert_eq!(events, [Event::Used; 3]);
    }
    // A receiver without a position that knows the time: the compass goes on.
    let mut gateway = gateway(CONFIG);
    let void = sentence("GPRMC,120001,V,,,,,,,221126,,,N");
    let events = push(&mut gateway, &(rmc("120000") + &void + &heading));
    assert_eq!(events[2], Event::Used);
}

#[test]
fn a_magnetic_heading_takes_the_variation_that_is_known() {
    let run = |told: Option<f32>, text: &str| {
        let config = Config {
            variation_deg: told,
            ..CONFIG
        };
        let mut gateway = gateway(config);
        let events = push(&mut gateway, text);
        match events.last() {
            Some(Event::Used) => Ok(gateway.vehicle().receiver().heading_deg.unwrap().value),
            Some(Event::Rejected(reason)) => Err(*reason),
            other => panic!("{other:?}"),
        }
    };
    let fix = rmc("120000");
    let varied = sentence("GPRMC,120000,A,4807.038,N,01131.000,E,50.0,090.0,221126,3.5,E,A");
    let (hdm, hdg) = (
        sentence("HCHDM,358.0,M"),
        sentence("HCHDG,358.0,1.0,W,2.0,W"),
    );
    assert_eq!(run(None, &(fix.clone() + &hdm)), Err(Rejected::NoVariation));
    assert_eq!(run(Some(-4.0), &(fix.clone() + &hdm)), Ok(354.0));
    assert_eq!(run(None, &(varied.clone() + &hdm)), Ok(1.5));
    // Once known, it holds.
    assert_eq!(run(None, &(varied.clone() + &fix + &hdm)), Ok(1.5));
    assert_eq!(run(None, &(fix.clone() + &hdg)), Ok(355.0));
    assert_eq!(run(None, &(varied.clone() + &hdg)), Ok(355.0));
    // What was told goes before what was stated.
    assert_eq!(run(Some(-4.0), &(varied + &hdm)), Ok(354.0));
    assert_eq!(run(Some(-4.0), &(fix + &hdg)), Ok(353.0));
}

#[test]
fn ports_are_counted_apart() {
    let mut gateway: Gateway<Clean<60, 16>, All, ShortReport, 2> = Gateway::new(CONFIG).unwrap();
    for byte in rmc("120000").bytes() {
        gateway.push(0, byte);
    }
    for byte in b"?\r?\r%010/3\r" {
        gateway.push(1, *byte);
    }
    let vehicle = gateway.vehicle();
    let of = |port: usize, reason| vehicle.port_counters(port).unwrap().rejected(reason);
    assert_eq!(vehicle.port_counters(0).unwrap().sentences, 1);
    assert_eq!(
        [of(0, Rejected::Unparsable), of(1, Rejected::Unparsable)],
        [0, 2]
    );
    assert_eq!(
        [of(0, Rejected::LowQuality), of(1, Rejected::LowQuality)],
        [0, 1]
    );
    assert_eq!(vehicle.counters().rejected(Rejected::Unparsable), 2);
    assert_eq!(vehicle.counters().lines, 4);
    assert!(vehicle.port_counters(2).is_none());
}
