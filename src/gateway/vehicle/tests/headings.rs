//! How a bearing finds its heading.

use super::*;
use crate::gateway::Station;

#[test]
fn heading_by_compass_by_course_or_none() {
    let config = CONFIG;
    let near = |result: Result<f32, Rejected>, degrees: f32| {
        assert!(
            (result.unwrap() - degrees).abs() < 1e-3,
            "{result:?} is not {degrees}"
        );
    };
    let fix = rmc("120000");
    near(last_bearing(config, &format!("{fix}%010/9\r")), 100.0);
    let compass = format!("{fix}{}", sentence("HEHDT,300.0,T"));
    near(last_bearing(config, &format!("{compass}%010/9\r")), 310.0);
    let north = Config {
        reference: BearingReference::TrueNorth,
        ..config
    };
    near(last_bearing(north, &format!("{compass}%010/9\r")), 10.0);

    // The course of a vehicle that has slowed down is none.
    let slow = sentence("GPVTG,090.0,T,,M,002.0,N,3.7,K,A");
    assert_eq!(
        last_bearing(config, &format!("{fix}{slow}%010/9\r")),
        Err(Rejected::NoHeading)
    );
    near(last_bearing(north, &format!("{fix}{slow}%010/9\r")), 10.0);
    // An old heading does not hold: back to the course.
    let later = format!("{compass}{}%010/9\r", rmc("120003"));
    near(last_bearing(config, &later), 100.0);
}

#[test]
fn a_bearing_belongs_to_where_the_vehicle_was_when_it_was_taken() {
    let turned = |time: &str, degrees: u32| rmc(time) + &sentence(&format!("HEHDT,{degrees}.0,T"));
    let poses = turned("120000", 350) + &turned("120001", 10);
    let line = kraken(NOON + 1_000, 20.0, NOWHERE);
    // In the middle of the interval that the line states.
    let at = |latency: u32| {
        let line = line.replace("UCA, 0,", &format!("UCA, {latency},"));
        last_bearing(CONFIG, &(poses.clone() + &line)).unwrap()
    };
    for (latency, degrees) in [(0, 30.0), (500, 25.0), (1_000, 20.0), (2_000, 10.0)] {
        assert!(
            (at(latency) - degrees).abs() < 1e-3,
            "{latency} ms: {}",
            at(latency)
        );
    }
    // Half a second after the last heading, as it turned.
    let line = kraken(NOON + 1_500, 20.0, NOWHERE);
    let bearing = last_bearing(CONFIG, &(poses + &line)).unwrap();
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
    assert!(last_bearing(CONFIG, &bend("098.0")).is_ok());
    assert_eq!(last_bearing(CONFIG, &bend("105.0")), Err(Rejected::Turning));
    let agile = Config {
        max_turn_rate_deg_s: 20.0,
        ..CONFIG
    };
    assert!(last_bearing(agile, &bend("105.0")).is_ok());
}

#[test]
fn the_course_of_a_direction_finder_that_stands_is_no_heading() {
    let line = |second: i64, place: &str, main: &str| {
        let pose = format!("{place}, 11.5, 30.0, 60.0, {main}");
        kraken(NOON + 1_000 * second, 20.0, &pose)
    };
    let moving = line(0, "48.1", "GPS") + &line(1, "48.1001", "GPS");
    let bearing = last_bearing(CONFIG, &moving).unwrap();
    assert!((bearing - 50.0).abs() < 1e-3);
    let standing = moving + &line(2, "48.1001", "GPS");
    assert_eq!(last_bearing(CONFIG, &standing), Err(Rejected::NoHeading));
    let with_compass = standing + &line(3, "48.1001", "Compass");
    let bearing = last_bearing(CONFIG, &with_compass).unwrap();
    assert!((bearing - 80.0).abs() < 1e-3);
}

#[test]
fn a_direction_finder_that_stands_is_not_judged_by_an_instant() {
    let line = |milliseconds: i64, place: &str| {
        let pose = format!("{place}, 11.5, 0.0, 60.0, GPS");
        kraken(NOON + milliseconds, 20.0, &pose)
    };
    let standing = line(0, "48.1") + &line(1_000, "48.1");
    // Two channels at one time; and a place that is newer than the last by less than it takes to judge.
    for (milliseconds, place) in [(1_000, "48.1"), (1_400, "48.1001")] {
        let text = standing.clone() + &line(milliseconds, place);
        let last = last_bearing(CONFIG, &text);
        assert_eq!(last, Err(Rejected::NoHeading));
    }
    // Twice a second, with places of once a second, from a vehicle that moves.
    let places = ["48.1", "48.1", "48.1001", "48.1001", "48.1002", "48.1002"];
    let moving: String = (0..)
        .zip(places)
        .map(|(i, place)| line(500 * i, place))
        .collect();
    assert!(last_bearing(CONFIG, &moving).is_ok());
}

#[test]
fn bearings_by_a_heading_that_nobody_has_entered_are_retracted() {
    let line = |milliseconds: i64, place: &str| {
        let pose = format!("{place}, 11.5, 0.0, 0.0, GPS");
        kraken(NOON + milliseconds, 20.0, &pose)
    };
    let text: String = (0..3).map(|i| line(400 * i, "48.1")).collect();
    let from_north = BearingRecord {
        time_ms: Some(43_201_000),
        place: Geodetic::new(481_000_000, 115_000_000).ok(),
        ..BearingRecord::new(10.0)
    };
    // One that moves has a course: its bearings take the place of those, unless others are among them.
    for (others, kept) in [(0, 2), (1, 3 + 1 + 2)] {
        let mut gateway = gateway(CONFIG);
        push(&mut gateway, &text);
        assert_eq!(gateway.vehicle().locator().observations().len(), 3);
        for _ in 0..others {
            gateway.vehicle.push_record(0, &from_north, &CONFIG);
        }
        let standing = push(&mut gateway, &line(1_200, "48.1"));
        assert_eq!(standing, [Event::Rejected(Rejected::NoHeading)]);
        let moving: String = (0..3)
            .map(|i| line(2_000 + 1_000 * i, &format!("48.100{i}")))
            .collect();
        push(&mut gateway, &moving);
        assert_eq!(gateway.vehicle().locator().observations().len(), kept);
    }
}

/// A direction finder that faces east, and says of its bearings that they count from north.
#[test]
fn a_bearing_from_north_is_not_turned() {
    let station = Station {
        place: Geodetic::new(481_000_000, 115_000_000).unwrap(),
        heading_deg: 90.0,
    };
    let report = "N0CALL>APRS:=4807.04N/01131.00E\\088/036/010/729\r";
    for station in [None, Some(station)] {
        for reference in [BearingReference::Relative, BearingReference::TrueNorth] {
            let config = Config {
                station,
                reference,
                ..CONFIG
            };
            let bearing = last_bearing(config, &(rmc("120000") + report)).unwrap();
            assert!((bearing - 10.0).abs() < 1e-3, "{config:?}: {bearing}");
        }
    }
}

#[test]
fn an_azimuth_counts_from_where_its_board_faces() {
    const BOARD: Station = Station {
        place: match Geodetic::new(481_000_000, 115_000_000) {
            Ok(place) => place,
            Err(_) => panic!("it is on earth"),
        },
        heading_deg: 90.0,
    };
    let line = "+UUDF:6C1DEBA4241B,-65,10,0,0,37,\"CCF9579B21AE\",\"\",1\r";
    for reference in [BearingReference::Relative, BearingReference::TrueNorth] {
        let mut config = Config {
            reference,
            ..CONFIG
        };
        config.formats.ublox.anchors = &[(0xccf9_579b_21ae, BOARD)];
        let bearing = last_bearing(config, &(rmc("120000") + line)).unwrap();
        assert!((bearing - 100.0).abs() < 1e-3, "{reference:?}: {bearing}");
    }
}

#[test]
fn a_station_is_where_it_is_said_to_be() {
    let place = Geodetic::new(481_000_000, 115_000_000).unwrap();
    let station = Station {
        place,
        heading_deg: 30.0,
    };
    let config = Config {
        station: Some(station),
        ..CONFIG
    };
    for pose in [NOWHERE, "58.1, 11.5, 0.0, 0.0, GPS"] {
        let bearing = last_bearing(config, &kraken(NOON, 20.0, pose)).unwrap();
        assert!((bearing - 50.0).abs() < 1e-3);
    }
    // Whoever states no time needs a receiver for it.
    assert_eq!(last_bearing(config, "%020/9\r"), Err(Rejected::NoPosition));
    assert!(last_bearing(config, &(rmc("120000") + "%020/9\r")).is_ok());
    let turned = Station {
        heading_deg: 361.0,
        ..station
    };
    let wrong = Config {
        station: Some(turned),
        ..CONFIG
    };
    assert_eq!(wrong.check().unwrap_err().field(), "heading_deg");
}
