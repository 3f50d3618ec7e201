//! What sentences say.

extern crate std;
use super::*;
use crate::aoa::geodesy::Geodetic;
use std::{format, string::String};

fn parse(line: &[u8]) -> Result<Sentence, Rejected> {
    super::parse(line, false)
}

fn with_checksum(payload: &str) -> String {
    format!("${payload}*{:02X}", sentence::checksum(payload.as_bytes()))
}

fn read(payload: &str) -> Result<Sentence, Rejected> {
    parse(with_checksum(payload).as_bytes())
}

fn position(time: TimeOfDay, place: Geodetic, motion: Option<Motion>) -> Sentence {
    Sentence::Statement(Statement {
        time: Some(time),
        place: Some(place),
        motion,
        ..Statement::NOTHING
    })
}

fn moving(motion: Motion) -> Sentence {
    Sentence::Statement(Statement {
        motion: Some(motion),
        ..Statement::NOTHING
    })
}

fn heading(degrees: f32) -> Statement {
    Statement {
        heading: Some(Heading {
            degrees,
            is_magnetic: false,
        }),
        ..Statement::NOTHING
    }
}

fn at(time: &str) -> TimeOfDay {
    TimeOfDay::from_nmea(time.as_bytes()).unwrap()
}

#[test]
fn rmc_tells_position_and_motion() {
    let munich = Geodetic::new(481_173_000, 115_166_667).unwrap();
    let line = b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A";
    let Ok(Sentence::Statement(stated)) = parse(line) else {
        panic!("not a position");
    };
    let motion = stated.motion.unwrap();
    assert_eq!(
        (stated.time, stated.place, motion.course, stated.variation),
        (Some(at("123519")), Some(munich), Some(84.4), Some(-3.1))
    );
    assert!((motion.speed - 11.523_556).abs() < 1e-5);

    // NMEA 4.1, seven decimals of a minute, standing: no course.
    let standing = Motion {
        course: None,
        speed: 0.0,
    };
    assert_eq!(
        read("GNRMC,000000.10,A,3352.1234567,S,15112.7654321,W,0.000,,221126,,,A,V"),
        Ok(position(
            at("000000.10"),
            Geodetic::new(-338_687_243, -1_512_127_572).unwrap(),
            Some(standing)
        ))
    );
}

#[test]
fn a_variation_that_is_none_costs_no_position() {
    for (variation, degrees) in [
        ("11.5985,E", Some(11.5985)),
        ("003.1,W", Some(-3.1)),
        (",", None),
        ("999.9000,E", None),
        ("01,", None),
    ] {
        let payload = format!("GPRMC,123519,A,4807.038,N,01131.000,E,0.0,,230394,{variation},A");
        let Ok(Sentence::Statement(stated)) = read(&payload) else {
            panic!("{payload}");
        };
        assert!(stated.place.is_some());
        assert_eq!(stated.variation, degrees, "{payload}");
    }
}

#[test]
fn digits_before_the_point_are_counted() {
    let of = |latitude: &str, longitude: &str| {
        read(&format!(
            "GPGGA,123519,{latitude},N,{longitude},E,1,08,0.9,,M,,M,,"
        ))
    };
    assert!(matches!(of("4807.", "01131."), Ok(Sentence::Statement(_))));
    // Rounded once, half up: 0.05 of a minute's ten-thousandth would make it 7 if rounded to 1e-7 minutes before.
    let Ok(Sentence::Statement(stated)) = of("4807.00000299999", "01131.000003") else {
        panic!("not a position");
    };
    let place = stated.place.unwrap();
    assert_eq!(
        (place.latitude_e7(), place.longitude_e7()),
        (481_166_667, 115_166_667)
    );
    for (latitude, longitude) in [
        ("48.117300", "11.516667"),
        ("807.038", "01131.000"),
        ("48007.038", "01131.000"),
        ("4807.038", "1131.000"),
        ("4807.038", "001131.000"),
        ("4807", "01131.000"),
        ("+807.038", "01131.000"),
        ("4807.038", "-1131.000"),
    ] {
        let refused = of(latitude, longitude);
        assert_eq!(
            refused,
            Ok(Sentence::Lost(Rejected::Unparsable)),
            "{latitude} {longitude}"
        );
    }
}

#[test]
fn other_sentences() {
    let munich = Geodetic::new(481_173_000, 115_166_667).unwrap();
    assert_eq!(
        parse(b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47"),
        Ok(position(at("123519"), munich, None))
    );
    let motion = Motion {
        course: Some(54.7),
        speed: 5.5 * METRES_PER_SECOND_PER_KNOT,
    };
    assert_eq!(
        parse(b"$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48"),
        Ok(moving(motion))
    );
    assert_eq!(read("PFOXQ"), Ok(Sentence::Query));
    assert_eq!(parse(b"$PFOXR*53"), Ok(Sentence::Restart));
    for payload in [
        "GPGSV,1,1,00",
        "GPTXT,01,01,02,ANTSTATUS=OK",
        "PASHR,POS,0,09,165003.00,3722.4,N",
        "PUBX,00",
        "X",
        "",
    ] {
        assert_eq!(read(payload), Ok(Sentence::Other), "{payload}");
    }
}

/// Lines of a gyro compass, of fluxgate compasses, of a boat's simulator, an inertial unit and a True North Revolution, as
/// their makers' and others' documentation quotes them.
#[test]
fn headings_of_compasses() {
    let magnetic = |degrees, variation| Statement {
        heading: Some(Heading {
            degrees,
            is_magnetic: true,
        }),
        variation,
        ..Statement::NOTHING
    };
    let dated = Statement {
        time: Some(at("164100.190")),
        ..heading(138.24)
    };
    for (line, expected) in [
        ("HEHDT,274.07,T", heading(274.07)),
        ("GNTHS,77.5,A", heading(77.5)),
        ("HCHDG,101.1,,,7.1,W", magnetic(101.1, Some(-7.1))),
        ("HCHDG,129.5,,,8.7,E", magnetic(129.5, Some(8.7))),
        ("HCHDG,176.2,2.0,E,22.1,E", magnetic(178.2, Some(22.1))),
        ("HCHDG,98.5,1.5,W,,", magnetic(97.0, None)),
        ("HCHDM,238.0,M", magnetic(238.0, None)),
        (
            "PASHR,164100.190,138.24,T,+32.56,+48.49,+00.00,3.141,3.141,35.000,1,0",
            dated,
        ),
        ("PTNTHTM,71.3,N,-0.4,N,-1.4,N,75.9,2618", heading(71.3)),
    ] {
        assert_eq!(read(line), Ok(Sentence::Statement(expected)), "{line}");
    }
}

#[test]
fn headings_have_their_published_checksums() {
    for line in [
        "$HCHDG,101.1,,,7.1,W*3C",
        "$HCHDG,129.5,,,8.7,E*29",
        "$PTNTHTM,71.3,N,-0.4,N,-1.4,N,75.9,2618*03",
        "$PTNTHTM,285.2,N,-2.4,N,10.7,N,59.1,3844*27",
    ] {
        let read = parse(line.as_bytes());
        assert!(
            matches!(read, Ok(Sentence::Statement(_))),
            "{line} {read:?}"
        );
    }
}

#[test]
fn compasses_without_a_heading_have_none() {
    for line in [
        "HCHDG,,,,,",
        "HCHDM,,M",
        "PTNTHTM,,N,-2.4,N,10.7,N,59.1,3844",
        "PTNTHTM,71.3,P,-0.4,N,-1.4,N,75.9,2618",
        "PASHR,,138.24,T,",
    ] {
        assert_eq!(read(line), Ok(Sentence::NoFix(None)), "{line}");
    }
    for (line, reason) in [
        ("HCHDG,101.1,,,7.1,N", Rejected::Unparsable),
        ("HCHDG,361.0,,,7.1,E", Rejected::OutOfRange),
        ("HCHDM,101.1,T", Rejected::Unparsable),
        (
            "PTNTHTM,14223,N,169,N,-43,N,13641,2454",
            Rejected::OutOfRange,
        ),
        (
            "PASHR,164100190,138.24,T,+32.56,+48.49",
            Rejected::Unparsable,
        ),
    ] {
        assert_eq!(read(line), Err(reason), "{line}");
    }
}

#[test]
fn what_was_not_measured_is_used_if_configured() {
    for payload in [
        "GPRMC,123519,A,4807.038,N,01131.000,E,0,,230394,,,M",
        "GPRMC,123519,A,4807.038,N,01131.000,E,0,,230394,,,S",
        "GPGGA,123519,4807.038,N,01131.000,E,7,08,0.9,545.4,M,46.9,M,,",
        "GPGGA,123519,4807.038,N,01131.000,E,8,08,0.9,545.4,M,46.9,M,,",
        "GPVTG,054.7,T,034.4,M,005.5,N,010.2,K,S",
        "GNTHS,77.5,M",
    ] {
        let refused = read(payload);
        assert!(
            matches!(
                refused,
                Ok(Sentence::Lost(Rejected::Simulated)) | Err(Rejected::Simulated)
            ),
            "{payload}"
        );
        let line = with_checksum(payload);
        let used = super::parse(line.as_bytes(), true);
        assert!(matches!(used, Ok(Sentence::Statement(_))), "{payload}");
    }
    // Estimated, differential, real-time kinematic.
    for quality in [2, 4, 5, 6, 9] {
        let payload = format!("GPGGA,123519,4807.038,N,01131.000,E,{quality},08,0.9,545.4,M,,,,");
        assert!(matches!(read(&payload), Ok(Sentence::Statement(_))));
    }
}

#[test]
fn what_makers_call_like_others_is_for_others() {
    for payload in ["PGRMC,A,237.1,100,6378137.000", "PAGGA,1", "PXHDT,12.0,T"] {
        assert_eq!(read(payload), Ok(Sentence::Other), "{payload}");
    }
}

#[test]
fn a_position_without_a_time_is_none() {
    for payload in [
        "GPGGA,,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        "GPRMC,,A,4807.038,N,01131.000,E,022.4,084.4,230394,,,A",
    ] {
        let lost = Ok(Sentence::Lost(Rejected::NoFix));
        assert_eq!(read(payload), lost, "{payload}");
    }
}

#[test]
fn a_variation_is_up_to_half_a_turn() {
    let variation = |text: &str| match read(&format!("HCHDG,10.0,,,{text}")) {
        Ok(Sentence::Statement(stated)) => Ok(stated.variation),
        other => other.map(|_| None),
    };
    assert_eq!(variation("180.0,E"), Ok(Some(180.0)));
    assert_eq!(variation("180.0,W"), Ok(Some(-180.0)));
    assert_eq!(variation("180.1,E"), Err(Rejected::OutOfRange));
    assert_eq!(variation(","), Ok(None));
}

#[test]
fn ais_is_for_others() {
    assert_eq!(
        parse(b"!AIVDM,1,1,,A,15RTgt0PAso;90TKcjM8h6g208CQ,0*4A"),
        Ok(Sentence::Other)
    );
    assert_eq!(parse(b"!AIVDM,1,1,,A,15RT,0*4A"), Err(Rejected::Checksum));
    assert_eq!(parse(b"!GPHDT,274.07,T*03"), Ok(Sentence::Other));
}

#[test]
fn no_fix() {
    let time = Some(at("123519.00"));
    for (payload, time) in [
        ("GPRMC,123519.00,V,,,,,,,230394,,,N", time),
        (
            "GPRMC,123519.00,A,4807.038,N,01131.000,E,0,,230394,,,N",
            time,
        ),
        ("GPGGA,123519.00,,,,,0,00,99.99,,,,,,", time),
        ("GPVTG,,,,,,,,,N", None),
        ("GPVTG,84.4,T,,M,,N,,K,A", None),
        ("GPVTG,84.4,T,,M,22.4,N,41.5,K,N", None),
        ("GPHDT,,T", None),
        ("GPTHS,,V", None),
        ("GPTHS,10.0,V", None),
    ] {
        assert_eq!(read(payload), Ok(Sentence::NoFix(time)), "{payload}");
    }
}

#[test]
fn sentences_with_a_wrong_checksum_are_rejected() {
    assert_eq!(
        read("GPRMC,,V,,,,,,,,,,N"),
        Ok(Sentence::Lost(Rejected::NoFix))
    );
    assert_eq!(
        parse(b"$GPRMC,123519,A,4807.038,N,01131.001,E,022.4,084.4,230394,003.1,W*6A"),
        Ok(Sentence::Lost(Rejected::Checksum))
    );
    for (line, reason) in [
        ("$GPHDT,274.07,T*04", Rejected::Checksum),
        ("$GPHDT,274.07,T", Rejected::Checksum),
        ("$GPHDT,274.07,T*0", Rejected::Checksum),
        ("$GPHDT,274.07,T*+3", Rejected::Checksum),
        ("$", Rejected::Checksum),
    ] {
        assert_eq!(parse(line.as_bytes()), Err(reason), "{line}");
    }
}

#[test]
fn sentences_with_a_wrong_field_are_rejected() {
    for (payload, reason) in [
        (
            "GPRMC,123519,A,0000.000,N,00000.000,E,0.0,,230394,,",
            Rejected::NullPosition,
        ),
        (
            "GPRMC,123519,A,4860.000,N,01131.000,E,0.0,,230394,,",
            Rejected::OutOfRange,
        ),
        (
            "GPRMC,123519,A,9000.001,N,01131.000,E,0.0,,230394,,",
            Rejected::OutOfRange,
        ),
        (
            "GPRMC,123519,A,4807.038,N,18000.001,E,0.0,,230394,,",
            Rejected::OutOfRange,
        ),
        (
            "GPRMC,123519,A,4807.038,X,01131.000,E,0.0,,230394,,",
            Rejected::Unparsable,
        ),
        (
            "GPRMC,123519,A,4807.038,E,01131.000,N,0.0,,230394,,",
            Rejected::Unparsable,
        ),
        (
            "GPRMC,123519,A,-4807.038,N,01131.000,E,0.0,,230394,,",
            Rejected::Unparsable,
        ),
        ("GPRMC,123519,A,,,,,0.0,,230394,,", Rejected::Unparsable),
        ("GPRMC,123519,A,4807.038,N", Rejected::Unparsable),
        (
            "GPRMC,253519,A,4807.038,N,01131.000,E,0.0,,230394,,",
            Rejected::Unparsable,
        ),
        (
            "GPRMC,123519,A,4807.038,N,01131.000,E,0.0,361,230394,,",
            Rejected::OutOfRange,
        ),
        (
            "GPGGA,123519,4807.038,N,01131.000,E,x,08,0.9,545.4,M,46.9,M,,",
            Rejected::Unparsable,
        ),
        ("HEHDT,274.07", Rejected::Unparsable),
        ("HEHDT,-1,T", Rejected::OutOfRange),
    ] {
        let found = match read(payload) {
            Ok(Sentence::Lost(reason)) => Err(reason),
            other => other,
        };
        assert_eq!(found, Err(reason), "{payload}");
    }
}

/// Thousands of sentences over all hemispheres and precisions, read by an established parser as well.
#[test]
fn the_nmea_crate_reads_the_same() {
    use crate::random::{Rng, SeedableRng, Xoshiro128PlusPlus};
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(71);
    let mut below = |limit: u32| rng.next_u32() % limit;
    for _ in 0..5_000 {
        let minute = |minutes: u32, decimals: usize, fraction: u32| {
            format!(
                "{minutes:02}.{:0decimals$}",
                fraction % 10u32.pow(decimals as u32)
            )
        };
        let decimals = 3 + below(5) as usize;
        let latitude = format!(
            "{:02}{}",
            below(90),
            minute(below(60), decimals, below(u32::MAX))
        );
        let longitude = format!(
            "{:03}{}",
            below(180),
            minute(below(60), decimals, below(u32::MAX))
        );
        let north = ["N", "S"][below(2) as usize];
        let east = ["E", "W"][below(2) as usize];
        let time = format!(
            "{:02}{:02}{:02}.{:02}",
            below(24),
            below(60),
            below(60),
            below(100)
        );
        let (speed, course) = (below(2_000) as f32 / 10.0, below(3_600) as f32 / 10.0);

        let rmc = format!(
            "GPRMC,{time},A,{latitude},{north},{longitude},{east},{speed:.1},{course:.1},221126,,,A"
        );
        let gga =
            format!("GNGGA,{time},{latitude},{north},{longitude},{east},1,08,0.9,545.4,M,46.9,M,,");
        let vtg = format!("GPVTG,{course:.1},T,,M,{speed:.1},N,,K");
        let hdt = format!("HEHDT,{course:.1},T");
        for payload in [rmc, gga, vtg, hdt] {
            let line = format!("${payload}*{:02X}", sentence::checksum(payload.as_bytes()));
            assert_agree(
                &line,
                &parse(line.as_bytes()).unwrap(),
                &::nmea::parse_str(&line).unwrap(),
            );
        }
    }
}

fn assert_agree(line: &str, ours: &Sentence, theirs: &::nmea::ParseResult) {
    use ::nmea::ParseResult;
    let near = |a: f64, b: f64, limit: f64| assert!((a - b).abs() <= limit, "{line}: {a} {b}");
    let same_place = |latitude: Option<f64>, longitude: Option<f64>, place: Option<Geodetic>| {
        let place = place.unwrap();
        let ours = [place.latitude_e7(), place.longitude_e7()].map(f64::from);
        for (ours, theirs) in ours.into_iter().zip([latitude, longitude]) {
            // Half of the last digit, and the rounding of theirs.
            near(ours, theirs.unwrap() * 1e7, 0.51);
        }
    };
    let same_motion = |knots: Option<f32>, course: Option<f32>, motion: Option<Motion>| {
        let motion = motion.unwrap();
        let speed = knots.unwrap() * METRES_PER_SECOND_PER_KNOT;
        near(f64::from(motion.speed), f64::from(speed), 1e-5);
        let courses = [motion.course, course].map(|course| f64::from(course.unwrap()));
        near(courses[0], courses[1], 1e-4);
    };
    let Sentence::Statement(ours) = ours else {
        panic!("{line}: {ours:?}");
    };
    match theirs {
        ParseResult::RMC(rmc) => {
            same_place(rmc.lat, rmc.lon, ours.place);
            same_motion(rmc.speed_over_ground, rmc.true_course, ours.motion);
        }
        ParseResult::GGA(gga) => same_place(gga.latitude, gga.longitude, ours.place),
        ParseResult::VTG(vtg) => same_motion(vtg.speed_over_ground, vtg.true_course, ours.motion),
        ParseResult::HDT(hdt) => {
            let headings = [Some(ours.heading.unwrap().degrees), hdt.heading];
            let [ours, theirs] = headings.map(|heading| f64::from(heading.unwrap()));
            near(ours, theirs, 1e-4);
        }
        _ => panic!("{line}: {ours:?} is not {theirs:?}"),
    }
}
