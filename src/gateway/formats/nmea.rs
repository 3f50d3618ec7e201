//! Sentences of the navigation receiver.
//!
//! The fields stay bytes until they are exact integers: an f32 would lose half a metre of a longitude.
//!
//! Read here and not by a crate, because every `no_std` parser of NMEA leaves panics in the firmware that links
//! it (float parsing, slices of strings). The tests hold this one to what the `nmea` crate reads.

use super::format::{Format, Layout, Motion, Sentence};
use super::{Config, Finder};
use crate::aoa::geodesy::Geodetic;
use crate::gateway::clock::TimeOfDay;
use crate::gateway::decimal::{decimal, fixed};
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence;

const METRES_PER_SECOND_PER_KNOT: f32 = 1852.0 / 3600.0;

/// The sentences of NMEA 0183, and those of the gateway's own host.
#[derive(Debug)]
pub struct Nmea;

impl Format for Nmea {
    const FINDER: Option<Finder> = None;
    /// The standard says 82 bytes, receivers send up to 102.
    const LAYOUT: Layout = Layout {
        longest: 120,
        fields: u8::MAX,
        interrupts: true,
        holds: b"%",
    };
    const EMPTY: Self = Self;

    fn begins(byte: u8) -> bool {
        byte == b'$'
    }

    fn parse(&mut self, line: &[u8], _config: &Config) -> Result<Sentence, Rejected> {
        parse(line)
    }
}

/// Checks the sentence `$payload*hh` and reads it.
#[inline(never)]
fn parse(line: &[u8]) -> Result<Sentence, Rejected> {
    let payload = sentence::checked(line).ok_or(Rejected::Checksum)?;
    match payload {
        b"PFOXQ" => return Ok(Sentence::Query),
        b"PFOXR" => return Ok(Sentence::Restart),
        _ => {}
    }
    // Two letters of the talker, three of the sentence, a comma, the fields.
    let Some((address, fields)) = payload.split_at_checked(6) else {
        return Ok(Sentence::Other);
    };
    match address {
        [b'P', ..] => Ok(Sentence::Other),
        [_, _, b'R', b'M', b'C', b','] => rmc(fields),
        [_, _, b'G', b'G', b'A', b','] => gga(fields),
        [_, _, b'V', b'T', b'G', b','] => vtg(fields),
        [_, _, b'H', b'D', b'T', b','] => heading(fields, b"T"),
        [_, _, b'T', b'H', b'S', b','] => heading(fields, b"AEMS"),
        _ => Ok(Sentence::Other),
    }
}

#[inline(never)]
fn rmc(fields: &[u8]) -> Result<Sentence, Rejected> {
    let [
        clock,
        status,
        latitude,
        latitude_side,
        longitude,
        longitude_side,
        speed,
        course,
    ] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let time = time(clock)?;
    let mode = fields.split(|byte| *byte == b',').nth(11);
    let void = status != b"A" || mode == Some(b"N");
    match (time, void) {
        (Some(time), false) => {
            let place = place(latitude, latitude_side, longitude, longitude_side)?;
            Ok(Sentence::Position(time, place, motion(course, speed)?))
        }
        _ => Ok(Sentence::NoFix(time)),
    }
}

#[inline(never)]
fn gga(fields: &[u8]) -> Result<Sentence, Rejected> {
    let [
        clock,
        latitude,
        latitude_side,
        longitude,
        longitude_side,
        quality,
    ] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let time = time(clock)?;
    match (time, quality) {
        (Some(time), [b'1'..=b'9']) => {
            let place = place(latitude, latitude_side, longitude, longitude_side)?;
            Ok(Sentence::Position(time, place, None))
        }
        (_, b"0" | b"") | (None, _) => Ok(Sentence::NoFix(time)),
        _ => Err(Rejected::Unparsable),
    }
}

#[inline(never)]
fn vtg(fields: &[u8]) -> Result<Sentence, Rejected> {
    let [course, _, _, _, speed] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let mode = fields.split(|byte| *byte == b',').nth(8);
    match motion(course, speed)? {
        Some(motion) if mode != Some(b"N") => Ok(Sentence::Motion(motion)),
        _ => Ok(Sentence::NoFix(None)),
    }
}

/// `heading,mode` with one of the `valid` modes: HDT and THS.
fn heading(fields: &[u8], valid: &[u8]) -> Result<Sentence, Rejected> {
    let mut parts = fields.split(|byte| *byte == b',');
    match (parts.next(), parts.next()) {
        (Some([]), _) => Ok(Sentence::NoFix(None)),
        (Some(degrees), Some([mode])) if valid.contains(mode) => {
            Ok(Sentence::Heading(angle(degrees)?))
        }
        (_, Some([b'V'])) => Ok(Sentence::NoFix(None)),
        _ => Err(Rejected::Unparsable),
    }
}

#[inline(never)]
fn time(text: &[u8]) -> Result<Option<TimeOfDay>, Rejected> {
    if text.is_empty() {
        return Ok(None);
    }
    TimeOfDay::from_nmea(text)
        .map(Some)
        .ok_or(Rejected::Unparsable)
}

#[inline(never)]
fn motion(course: &[u8], speed: &[u8]) -> Result<Option<Motion>, Rejected> {
    if speed.is_empty() {
        return Ok(None);
    }
    let knots = decimal(speed).ok_or(Rejected::Unparsable)?;
    let course = if course.is_empty() {
        None
    } else {
        Some(angle(course)?)
    };
    Ok(Some(Motion {
        course,
        speed: knots * METRES_PER_SECOND_PER_KNOT,
    }))
}

fn angle(degrees: &[u8]) -> Result<f32, Rejected> {
    let degrees = decimal(degrees).ok_or(Rejected::Unparsable)?;
    if (0.0..=360.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err(Rejected::OutOfRange)
    }
}

#[inline(never)]
fn place(
    latitude: &[u8],
    latitude_side: &[u8],
    longitude: &[u8],
    longitude_side: &[u8],
) -> Result<Geodetic, Rejected> {
    let latitude = degrees_e7(latitude, latitude_side, *b"NS")?;
    let longitude = degrees_e7(longitude, longitude_side, *b"EW")?;
    if latitude == 0 && longitude == 0 {
        return Err(Rejected::NullPosition);
    }
    Geodetic::new(latitude, longitude).map_err(|_| Rejected::OutOfRange)
}

/// From `dddmm.mmmm` and one of the two `sides`, of which the second is negative.
#[inline(never)]
fn degrees_e7(text: &[u8], side: &[u8], sides: [u8; 2]) -> Result<i32, Rejected> {
    let value = fixed(text, 7)
        .filter(|v| *v >= 0)
        .ok_or(Rejected::Unparsable)?;
    let (degrees, minutes_e7) = (value / 1_000_000_000, value % 1_000_000_000);
    if minutes_e7 >= 600_000_000 || degrees > 180 {
        return Err(Rejected::OutOfRange);
    }
    let degrees_e7 = (degrees * 10_000_000 + (minutes_e7 + 30) / 60) as i32;
    match sides.map(|s| side == [s]) {
        [true, _] => Ok(degrees_e7),
        [_, true] => Ok(-degrees_e7),
        _ => Err(Rejected::Unparsable),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    fn read(payload: &str) -> Result<Sentence, Rejected> {
        parse(format!("${payload}*{:02X}", sentence::checksum(payload.as_bytes())).as_bytes())
    }

    fn at(time: &str) -> TimeOfDay {
        TimeOfDay::from_nmea(time.as_bytes()).unwrap()
    }

    #[test]
    fn rmc_tells_position_and_motion() {
        let munich = Geodetic::new(481_173_000, 115_166_667).unwrap();
        let Ok(Sentence::Position(time, place, Some(motion))) =
            parse(b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A")
        else {
            panic!("not a position");
        };
        assert_eq!(
            (time, place, motion.course),
            (at("123519"), munich, Some(84.4))
        );
        assert!((motion.speed - 11.523_556).abs() < 1e-5);

        // NMEA 4.1, seven decimals of a minute, standing: no course.
        let standing = Motion {
            course: None,
            speed: 0.0,
        };
        assert_eq!(
            read("GNRMC,000000.10,A,3352.1234567,S,15112.7654321,W,0.000,,221126,,,A,V"),
            Ok(Sentence::Position(
                at("000000.10"),
                Geodetic::new(-338_687_243, -1_512_127_572).unwrap(),
                Some(standing)
            ))
        );
    }

    #[test]
    fn other_sentences() {
        let munich = Geodetic::new(481_173_000, 115_166_667).unwrap();
        assert_eq!(
            parse(b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47"),
            Ok(Sentence::Position(at("123519"), munich, None))
        );
        let Ok(Sentence::Motion(motion)) = parse(b"$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48")
        else {
            panic!("not a motion");
        };
        assert_eq!(motion.course, Some(54.7));
        assert!((motion.speed - 2.829_444).abs() < 1e-6);
        assert_eq!(read("HEHDT,274.07,T"), Ok(Sentence::Heading(274.07)));
        assert_eq!(read("GNTHS,77.5,A"), Ok(Sentence::Heading(77.5)));
        assert_eq!(read("PFOXQ"), Ok(Sentence::Query));
        assert_eq!(parse(b"$PFOXR*53"), Ok(Sentence::Restart));
        for payload in [
            "GPGSV,1,1,00",
            "GPTXT,01,01,02,ANTSTATUS=OK",
            "PUBX,00",
            "X",
            "",
        ] {
            assert_eq!(read(payload), Ok(Sentence::Other), "{payload}");
        }
    }

    #[test]
    fn no_fix() {
        let time = Some(at("123519.00"));
        for (payload, time) in [
            ("GPRMC,123519.00,V,,,,,,,230394,,,N", time),
            ("GPRMC,,V,,,,,,,,,,N", None),
            (
                "GPRMC,123519.00,A,4807.038,N,01131.000,E,0,,230394,,,N",
                time,
            ),
            ("GPGGA,123519.00,,,,,0,00,99.99,,,,,,", time),
            ("GPVTG,,,,,,,,,N", None),
            ("GPHDT,,T", None),
            ("GPTHS,,V", None),
            ("GPTHS,10.0,V", None),
        ] {
            assert_eq!(read(payload), Ok(Sentence::NoFix(time)), "{payload}");
        }
    }

    #[test]
    fn rejected() {
        for (line, reason) in [
            ("$GPHDT,274.07,T*04", Rejected::Checksum),
            ("$GPHDT,274.07,T", Rejected::Checksum),
            ("$GPHDT,274.07,T*0", Rejected::Checksum),
            ("$GPHDT,274.07,T*+3", Rejected::Checksum),
            ("$", Rejected::Checksum),
        ] {
            assert_eq!(parse(line.as_bytes()), Err(reason), "{line}");
        }
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
            assert_eq!(read(payload), Err(reason), "{payload}");
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
            let gga = format!(
                "GNGGA,{time},{latitude},{north},{longitude},{east},1,08,0.9,545.4,M,46.9,M,,"
            );
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
        let same_place = |place: &Geodetic, latitude: Option<f64>, longitude: Option<f64>| {
            // Half of the last digit, and the rounding of theirs.
            near(
                f64::from(place.latitude_e7()),
                latitude.unwrap() * 1e7,
                0.51,
            );
            near(
                f64::from(place.longitude_e7()),
                longitude.unwrap() * 1e7,
                0.51,
            );
        };
        let same_motion = |motion: &Motion, knots: Option<f32>, course: Option<f32>| {
            let knots = knots.unwrap() * METRES_PER_SECOND_PER_KNOT;
            near(f64::from(motion.speed), f64::from(knots), 1e-5);
            near(
                f64::from(motion.course.unwrap()),
                f64::from(course.unwrap()),
                1e-4,
            );
        };
        match (ours, theirs) {
            (Sentence::Position(_, place, Some(motion)), ParseResult::RMC(rmc)) => {
                same_place(place, rmc.lat, rmc.lon);
                same_motion(motion, rmc.speed_over_ground, rmc.true_course);
            }
            (Sentence::Position(_, place, None), ParseResult::GGA(gga)) => {
                same_place(place, gga.latitude, gga.longitude);
            }
            (Sentence::Motion(motion), ParseResult::VTG(vtg)) => {
                same_motion(motion, vtg.speed_over_ground, vtg.true_course);
            }
            (Sentence::Heading(degrees), ParseResult::HDT(hdt)) => {
                near(f64::from(*degrees), f64::from(hdt.heading.unwrap()), 1e-4);
            }
            _ => panic!("{line}: {ours:?} is not {theirs:?}"),
        }
    }
}
