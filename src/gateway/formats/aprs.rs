//! Direction finders that report by APRS: `/BRG/NRQ` in a report of a position, as a packet radio prints it.
//!
//! `N0CALL>APRS,WIDE1-1:@092345z4903.50N/07201.75W\088/036/270/729`
//!
//! | after the colon | field | unit, sense | taken as |
//! |---|---|---|---|
//! | `!` `=` | no time | | the receiver's time: a bearing that states none |
//! | `@` `/` and seven places | time: `DDHHMMz`, `HHMMSSh`; `DDHHMM/` is local | UTC | time; local: none |
//! | 8, `/`, 9, `\` | latitude and longitude, symbol of a direction finder | `ddmm.mmN`, `dddmm.mmW` | place of the direction finder |
//! | 7 | course and speed, or power, or range | | not used |
//! | `/` 3 | BRG: bearing, 0 to 360 | degrees clockwise from true north | bearing |
//! | `/` 1 | N: rate of hits, 1 to 8; 9 by hand; 0 where NRQ says nothing | | quality 0 if 0 |
//! | 1 | R: range | 2^R miles | not used |
//! | 1 | Q: width of the beam, 9 under a degree, 8 two, to 1 under 240, 0 useless | | quality, 0 to 100 |
//!
//! All other packets are left to others. A place of which digits are left out is refused. Reports to the minute are of the
//! minute's beginning; a second one of the same minute on the same port is a duplicate. Source: APRS Protocol Reference 1.0.1,
//! chapters 6 to 8.

use super::format::{Format, Layout, Reading, Reference, Sentence};
use crate::ConfigError;
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{decimal, place};
use crate::gateway::sigma::SigmaTable;

pub(super) const EXAMPLE: &str = "N0CALL>APRS,WIDE1-1:@092345z4903.50N/07201.75W\\088/036/270/729";

/// Packets of APRS with the bearing of a direction finder.
#[derive(Debug)]
pub struct Aprs;

/// What the format is told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config {
    /// The only station that is heard, with its number (`"N0CALL-9"`); `None` hears all, which count as one array.
    pub station: Option<&'static str>,
    /// Standard deviations by the quality, in place of those of [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
}

impl Config {
    /// All stations, by the [width of the beam](SigmaTable::BEAM_WIDTHS).
    pub const DEFAULT: Self = Self {
        station: None,
        sigmas: Some(&SigmaTable::BEAM_WIDTHS),
    };

    /// Checks all fields.
    ///
    /// # Errors
    /// None: every value is right.
    pub const fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }
}

impl Format for Aprs {
    type Config = Config;
    const DEFAULT: Config = Config::DEFAULT;
    /// A callsign begins it, and a comment may hold anything.
    const LAYOUT: Layout = Layout {
        longest: 240,
        begins: |byte| byte.is_ascii_uppercase() || byte.is_ascii_digit(),
        continues: |byte| byte.is_ascii_uppercase() || byte.is_ascii_digit(),
        holds: |line, byte| byte != b'$' && line.contains(&b':'),
        ..Layout::TEXT
    };
    const EMPTY: Self = Self;

    #[inline(never)]
    fn parse(&mut self, line: &[u8], config: &Config) -> Result<Sentence, Rejected> {
        let mut parts = line.splitn(2, |byte| *byte == b':');
        let (Some(header), Some(report)) = (parts.next(), parts.next()) else {
            return Err(Rejected::Unparsable);
        };
        let station = header.split(|byte| *byte == b'>').next();
        if !header.contains(&b'>') {
            return Err(Rejected::Unparsable);
        }
        let Some((time, report)) = dated(report)? else {
            return Ok(Sentence::Other);
        };
        let Some((latitude, rest)) = report.split_first_chunk::<7>() else {
            return Ok(Sentence::Other);
        };
        let Some(([north, table, longitude @ .., east, symbol], rest)) =
            rest.split_first_chunk::<12>()
        else {
            return Ok(Sentence::Other);
        };
        // Course and speed are not used.
        let (b"/\\", Some((_, [b'/', b1, b2, b3, b'/', number, range, quality, ..]))) =
            (&[*table, *symbol], rest.split_first_chunk::<7>())
        else {
            return Ok(Sentence::Other);
        };
        if config
            .station
            .is_some_and(|heard| Some(heard.as_bytes()) != station)
        {
            return Err(Rejected::OtherFinder);
        }
        let place = place([latitude, &[*north], longitude, &[*east]])?;
        let digits = [*b1, *b2, *b3];
        if ![b1, b2, b3, number, range, quality]
            .iter()
            .all(|byte| byte.is_ascii_digit())
        {
            return Err(Rejected::Unparsable);
        }
        let degrees = decimal(&digits).ok_or(Rejected::Unparsable)?;
        let quality = if *number == b'0' { 0 } else { quality - b'0' };
        Ok(Sentence::Reading(Reading {
            time,
            place: Some(place),
            reference: Reference::North,
            ..Reading::new(degrees, f32::from(quality) * (100.0 / 9.0), config.sigmas)?
        }))
    }
}

/// The time of a report of a position, if it states one, and what follows it.
type Dated<'a> = (Option<TimeOfDay>, &'a [u8]);

/// Takes the time off a report of a position; `None` of other packets.
fn dated(report: &[u8]) -> Result<Option<Dated<'_>>, Rejected> {
    let time = |text: [u8; 6]| TimeOfDay::from_nmea(&text).ok_or(Rejected::Unparsable);
    let (time, rest) = match report {
        [b'!' | b'=', rest @ ..] => (None, rest),
        [b'@' | b'/', _, _, a, b, c, d, b'z', rest @ ..] => {
            (Some(time([*a, *b, *c, *d, b'0', b'0'])?), rest)
        }
        [b'@' | b'/', a, b, c, d, e, f, b'h', rest @ ..] => {
            (Some(time([*a, *b, *c, *d, *e, *f])?), rest)
        }
        [b'@' | b'/', _, _, _, _, _, _, b'/', rest @ ..] => (None, rest),
        _ => return Ok(None),
    };
    Ok(Some((time, rest)))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aoa::geodesy::Geodetic;
    use crate::gateway::formats::tests::read;
    use std::format;

    fn parsed(report: &str) -> Result<Sentence, Rejected> {
        Aprs.parse(
            format!("N0CALL-9>APRS,WIDE1-1:{report}").as_bytes(),
            &Config::DEFAULT,
        )
    }

    /// The examples of the reference.
    #[test]
    fn reads_reports_of_direction_finders() {
        let reading = |report: &str| match parsed(report) {
            Ok(Sentence::Reading(reading)) => reading,
            other => panic!("{report}: {other:?}"),
        };
        let time = TimeOfDay::from_nmea(b"234500");
        for (report, time) in [
            ("=4903.50N/07201.75W\\088/036/270/729", None),
            ("=4903.50N/07201.75W\\000/036/270/729", None),
            ("@092345z4903.50N/07201.75W\\088/036/270/729", time),
            ("/092345z4903.50N/07201.75W\\000/000/270/729", time),
            ("@234500h4903.50N/07201.75W\\088/036/270/729 on foot", time),
            ("@092345/4903.50N/07201.75W\\088/036/270/729", None),
            ("!4903.50N/07201.75W\\PHG5132/270/729", None),
        ] {
            let found = reading(report);
            assert_eq!((found.best.degrees, found.time), (270.0, time), "{report}");
            assert!((found.quality - 100.0).abs() < 1e-4);
            let place = Geodetic::new(490_583_333, -720_291_667).unwrap();
            assert_eq!(
                (found.place, found.reference),
                (Some(place), Reference::North)
            );
        }
        // A beam of 32 degrees; and a report whose digits say nothing.
        let quality = |nrq| reading(&format!("=4903.50N/07201.75W\\088/036/270/{nrq}")).quality;
        assert!((quality("724") - 400.0 / 9.0).abs() < 1e-4);
        assert_eq!(quality("029"), 0.0);
        assert!(read::<Aprs>(EXAMPLE, &Config::DEFAULT).is_ok());
    }

    #[test]
    fn leaves_other_packets_to_others() {
        for report in [
            ">status",
            "!4903.50N/07201.75W-Test 001234",
            "!4903.50N/07201.75W\\Test",
            "!4903.50N/07201.75W\\088/036",
            "=4903.50N/07201.75W>088/036/270/729",
            "=4903.50NS07201.75W\\088/036/270/729",
            "/092345z4903.50N/07201.75W>Test1234",
            ";LEADER   *092345z4903.50N/07201.75W>088/036",
            ":WU2Z     :Testing",
            "",
        ] {
            assert_eq!(parsed(report), Ok(Sentence::Other), "{report}");
        }
    }

    #[test]
    fn refuses_malformed_reports() {
        for report in [
            "=4903.5 N/07201.75W\\088/036/270/729",
            "=49  .  N/072  .  W\\088/036/270/729",
            "=4903.50N/07201.75W\\088/036/2x0/729",
            "=4903.50N/07201.75W\\088/036/270/7 9",
            "=4903.50X/07201.75W\\088/036/270/729",
            "@096345z4903.50N/07201.75W\\088/036/270/729",
        ] {
            assert_eq!(parsed(report), Err(Rejected::Unparsable), "{report}");
        }
        let far = parsed("=4903.50N/07201.75W\\088/036/361/729");
        assert_eq!(far, Err(Rejected::OutOfRange));
        for line in ["N0CALL", "N0CALL:=4903.50N/07201.75W\\088/036/270/729"] {
            let refused = Aprs.parse(line.as_bytes(), &Config::DEFAULT);
            assert_eq!(refused, Err(Rejected::Unparsable));
        }
    }

    #[test]
    fn hears_one_station_if_told() {
        let mut config = Config::DEFAULT;
        for (station, heard) in [("N0CALL", true), ("N0CALL-9", false), ("K1ABC", false)] {
            config.station = Some(station);
            let found = read::<Aprs>(EXAMPLE, &config).map(|_| ());
            let expected = if heard {
                Ok(())
            } else {
                Err(Rejected::OtherFinder)
            };
            assert_eq!(found, expected);
        }
    }
}
