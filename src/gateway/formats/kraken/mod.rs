//! Lines of a KrakenSDR, in its app format.

mod spectrum;

use super::format::{Format, Layout, Peaks, Pose, Reading, Sentence};
use super::{Config as All, Finder, Sense};
use crate::ConfigError;
use crate::aoa::geodesy::Geodetic;
use crate::aoa::spectrum::{Spectrum, Temper};
use crate::config::{require, require_all};
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{columns, decimal, fixed};
use crate::gateway::sigma::{self, SigmaTable};
use spectrum::SpectrumReader;

pub(super) const EXAMPLE: &str = "1756823719250, 297, 87.80, -32.5, 433920000, UCA, 112, fox-1, \
    52.2296756, -21.0122287, 12.5, 341.25, Compass, R, R, R, R";

/// The largest maximum over mean of a spectrum, in decibels: 360 values of which all but one are zero.
const LARGEST_DECIBELS: f32 = 25.563_025;

/// The CSV line of the app format, whose first 13 fields are: time in milliseconds since 1970, bearing, confidence, power,
/// frequency, array, latency, station, latitude, longitude, GPS heading, compass heading, and which of the two is the main
/// one. The spectrum at its end is skipped.
///
/// A latitude and longitude of zero mean that the receiver does not know where it is.
#[derive(Debug)]
pub struct Kraken;

/// The same line as for [`Kraken`], with its spectrum read, in 736 bytes: a bearing is what the peaks are, each with its
/// probability and standard deviation, in place of the one that the line states. A locator that takes no alternatives has
/// the largest alone.
///
/// The 360 values are decibels over the lowest, counter-clockwise from the array's axis, a degree apart. (So they are in
/// every version of krakensdr_doa that writes this line, whichever way its bearing counts.) A line with more or fewer or
/// with one that is no such number, or above [`Spectrum::MAX_DECIBELS`], is [`Rejected::Unparsable`]; one without a peak,
/// flat or as good as flat, is [`Rejected::LowQuality`].
#[derive(Debug)]
pub struct KrakenSpectrum(SpectrumReader);

impl KrakenSpectrum {
    /// The spectrum of the last line, if [whole](Spectrum::is_whole).
    pub const fn spectrum(&self) -> &Spectrum {
        self.0.spectrum()
    }
}

/// What the format is told. Builds of the KrakenSDR's software differ in the sense of a bearing and the scale of its
/// confidence.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Direction in which bearings grow.
    pub sense: Sense,
    /// Scale of the confidence.
    pub confidence: Confidence,
    /// The frequency of the source: a KrakenSDR with several channels sends a line for each, and those of another
    /// frequency are rejected as [`Rejected::OtherFrequency`]. `None` reads lines of every frequency.
    pub frequency_hz: Option<u32>,
    /// Standard deviations by the quality, such as [`SIGMAS_BY_DECIBELS`], in place of those of
    /// [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
    /// The power to which a spectrum is raised to become a likelihood: see [`spectrum`](crate::aoa::spectrum).
    pub temper: Temper,
}

/// Scale of the confidence of a KrakenSDR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Confidence {
    /// 0 to 100, taken as the quality.
    #[default]
    Percent,
    /// The maximum of the spectrum over its mean, in decibels. The most that its 360 values allow, 25.6, is
    /// taken as quality 100 and 0 as quality 0, so that a minimum quality of 40 asks for 10.2.
    Decibels,
}

impl Config {
    /// Clockwise, in percent, every frequency.
    pub const DEFAULT: Self = Self {
        sense: Sense::Clockwise,
        confidence: Confidence::Percent,
        frequency_hz: None,
        sigmas: None,
        temper: Temper::DEFAULT,
    };

    /// Checks all fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(
            !matches!(self.frequency_hz, Some(0)),
            "frequency_hz is not above zero"
        );
        require_all!(self.temper);
        Ok(())
    }
}

impl Default for Config {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// By a confidence in [decibels](Confidence::Decibels): users read 1 to 2 dB without any signal and 6 to 11 with one. A
/// right angle up to 2 dB, then from 10 degrees at 6 to 3 at 11; these degrees are an estimate.
pub const SIGMAS_BY_DECIBELS: SigmaTable = sigma::preset(&[
    (2.0 * PER_DECIBEL, 90.0),
    (4.0 * PER_DECIBEL, 25.0),
    (6.0 * PER_DECIBEL, 10.0),
    (11.0 * PER_DECIBEL, 3.0),
]);

/// The quality that stands for a decibel.
const PER_DECIBEL: f32 = 100.0 / LARGEST_DECIBELS;

const LAYOUT: Layout = Layout {
    longest: 8_192,
    fields: 17,
    interrupts: false,
    holds: is_in_station,
};

/// Whether the line that begins with these bytes has come to the name of its station, which may be anything.
fn is_in_station(line: &[u8], _byte: u8) -> bool {
    let commas = line.iter().filter(|byte| **byte == b',').count();
    commas == 7 && columns(line).is_some_and(|[time]| time.iter().all(u8::is_ascii_digit))
}

impl Format for Kraken {
    const FINDER: Option<Finder> = Some(Finder::Kraken);
    const LAYOUT: Layout = LAYOUT;
    const EMPTY: Self = Self;

    fn begins(byte: u8) -> bool {
        byte.is_ascii_digit()
    }

    fn continues(byte: u8) -> bool {
        byte.is_ascii_digit()
    }

    fn parse(&mut self, line: &[u8], config: &All) -> Result<Sentence, Rejected> {
        reading(line, &config.kraken).map(Sentence::Reading)
    }
}

impl Format for KrakenSpectrum {
    const FINDER: Option<Finder> = Some(Finder::Kraken);
    const LAYOUT: Layout = LAYOUT;
    const EMPTY: Self = Self(SpectrumReader::EMPTY);
    const SPECTRA: bool = true;

    fn begins(byte: u8) -> bool {
        byte.is_ascii_digit()
    }

    fn continues(byte: u8) -> bool {
        byte.is_ascii_digit()
    }

    fn begin(&mut self) {
        self.0.begin();
    }

    fn rest(&mut self, byte: u8) {
        self.0.take(byte);
    }

    fn parse(&mut self, line: &[u8], config: &All) -> Result<Sentence, Rejected> {
        let reading = reading(line, &config.kraken)?;
        if !self.0.end() {
            return Err(Rejected::Unparsable);
        }
        Ok(Sentence::Reading(reading))
    }

    fn peaks(&self, config: &All) -> Option<Peaks> {
        Some(self.0.spectrum().peaks(config.kraken.temper))
    }
}

#[inline(never)]
fn reading(line: &[u8], config: &Config) -> Result<Reading, Rejected> {
    let mut fields: [&[u8]; 13] = columns(line).ok_or(Rejected::Unparsable)?;
    for field in &mut fields {
        *field = trim(field);
    }
    let [
        time,
        bearing,
        confidence,
        _power,
        frequency,
        _array,
        latency,
        _station,
        pose @ ..,
    ] = fields;

    if let Some(wanted) = config.frequency_hz {
        let frequency = fixed(frequency, 0).ok_or(Rejected::Unparsable)?;
        if frequency != i64::from(wanted) {
            return Err(Rejected::OtherFrequency);
        }
    }
    let digits = time.len() == 13 && time.iter().all(u8::is_ascii_digit);
    let time = fixed(time, 0)
        .filter(|_| digits)
        .map(TimeOfDay::from_epoch)
        .ok_or(Rejected::Unparsable)?;
    let latency = u32::try_from(fixed(latency, 0).ok_or(Rejected::Unparsable)?);
    let latency_ms = latency.map_err(|_| Rejected::OutOfRange)?;
    let pose = pose_of(pose)?;
    let degrees = match config.sense {
        Sense::Clockwise => number(bearing)?,
        Sense::CounterClockwise => 360.0 - number(bearing)?,
    };
    let quality = match config.confidence {
        Confidence::Percent => number(confidence)?,
        Confidence::Decibels => number(confidence)? * PER_DECIBEL,
    };
    Ok(Reading {
        time: Some(time),
        latency_ms,
        pose,
        ..Reading::new(degrees, quality, config.sigmas)?
    })
}

/// From latitude, longitude, the two headings, and which of them is the main one.
fn pose_of(fields: [&[u8]; 5]) -> Result<Option<Pose>, Rejected> {
    let [latitude, longitude, gps, compass, main] = fields;
    let degrees_e7 = |text| {
        let value = fixed(text, 7).ok_or(Rejected::Unparsable)?;
        i32::try_from(value).map_err(|_| Rejected::OutOfRange)
    };
    let (latitude, longitude) = (degrees_e7(latitude)?, degrees_e7(longitude)?);
    if (latitude, longitude) == (0, 0) {
        return Ok(None);
    }
    let place = Geodetic::new(latitude, longitude).map_err(|_| Rejected::OutOfRange)?;
    let heading_is_course = main != b"Compass";
    let heading = number(if heading_is_course { gps } else { compass })?;
    if !(0.0..=360.0).contains(&heading) {
        return Err(Rejected::OutOfRange);
    }
    Ok(Some(Pose {
        place,
        heading,
        heading_is_course,
    }))
}

fn number(text: &[u8]) -> Result<f32, Rejected> {
    decimal(text).ok_or(Rejected::Unparsable)
}

/// Takes the blanks off both ends of a field. Once in flash is enough, and not unrolled.
#[inline(never)]
fn trim(mut field: &[u8]) -> &[u8] {
    while let [b' ', rest @ ..] | [rest @ .., b' '] = field {
        field = rest;
    }
    field
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::gateway::formats::tests::read;
    use std::{format, string::String, vec::Vec};

    fn line(text: &str) -> Result<Reading, Rejected> {
        with(text, Config::DEFAULT)
    }

    fn with(text: &str, kraken: Config) -> Result<Reading, Rejected> {
        let config = All {
            kraken,
            ..All::DEFAULT
        };
        read::<Kraken>(text, &config)
    }

    #[test]
    fn reads_the_fields_before_the_spectrum() {
        let line = line(EXAMPLE).unwrap();
        assert_eq!(line.time, TimeOfDay::from_nmea(b"143519.25"));
        assert_eq!((line.degrees, line.quality), (297.0, 87.8));
        assert_eq!(line.latency_ms, 112);
        let place = Geodetic::new(522_296_756, -210_122_287).unwrap();
        assert_eq!(
            line.pose,
            Some(Pose {
                place,
                heading: 341.25,
                heading_is_course: false,
            })
        );
    }

    #[test]
    fn refuses_malformed_fields() {
        let with = |field: usize, text: &str| {
            let mut fields: Vec<&str> = EXAMPLE.split(',').collect();
            fields[field] = text;
            let changed: String = fields.join(",");
            line(&changed)
        };
        let pose = with(12, "GPS").unwrap().pose.unwrap();
        assert_eq!((pose.heading, pose.heading_is_course), (12.5, true));
        // On the equator, or on the meridian of Greenwich, but not on both.
        assert!(with(8, "0.0").unwrap().pose.is_some());
        for (field, text, reason) in [
            (0, "1756823719", Rejected::Unparsable),
            (0, "175682371925x", Rejected::Unparsable),
            (0, "17568237192.5", Rejected::Unparsable),
            (0, "1756823719250.0", Rejected::Unparsable),
            (1, "361", Rejected::OutOfRange),
            (1, "-1", Rejected::OutOfRange),
            (1, "nan", Rejected::Unparsable),
            (2, "101", Rejected::OutOfRange),
            (2, "", Rejected::Unparsable),
            (6, "x", Rejected::Unparsable),
            (6, "-1", Rejected::OutOfRange),
            (8, "90.0000001", Rejected::OutOfRange),
            (8, "522296756", Rejected::OutOfRange),
            (9, "-180.1", Rejected::OutOfRange),
            (9, "E21", Rejected::Unparsable),
            (11, "400", Rejected::OutOfRange),
            (11, "inf", Rejected::Unparsable),
        ] {
            assert_eq!(with(field, text), Err(reason), "field {field} {text}");
        }
        let nowhere = "1756823719250,5,50,-30,1,UCA,1,x,0.0,0,nan,nan,GPS";
        assert_eq!(line(nowhere).unwrap().pose, None);
        assert_eq!(line("1756823719250,5,50"), Err(Rejected::Unparsable));
    }

    #[test]
    fn builds_differ_in_sense_and_confidence() {
        let turned = Config {
            sense: Sense::CounterClockwise,
            ..Config::DEFAULT
        };
        assert_eq!(with(EXAMPLE, turned).unwrap().degrees, 63.0);

        let config = Config {
            confidence: Confidence::Decibels,
            ..Config::DEFAULT
        };
        let quality = |decibels: &str| {
            let line = format!("1756823719250,5,{decibels},-30,1,UCA,1,x,0,0,0,0,GPS");
            with(&line, config).map(|line| line.quality)
        };
        assert_eq!(quality("0"), Ok(0.0));
        assert!((quality("10.2252").unwrap() - 40.0).abs() < 0.01);
        assert!((quality("25.56").unwrap() - 100.0).abs() < 0.02);
        assert_eq!(quality("26"), Err(Rejected::OutOfRange));
        assert_eq!(quality("-1"), Err(Rejected::OutOfRange));
    }

    #[test]
    fn only_the_wanted_frequency_is_read() {
        let at = |text: &str, hertz| {
            let config = Config {
                frequency_hz: Some(hertz),
                ..Config::DEFAULT
            };
            with(text, config)
        };
        assert!(at(EXAMPLE, 433_920_000).is_ok());
        assert_eq!(at(EXAMPLE, 433_920_001), Err(Rejected::OtherFrequency));
        let unnamed = "1756823719250,5,50,-30,UHF,UCA,1,x,0,0,0,0,GPS";
        assert_eq!(at(unnamed, 1), Err(Rejected::Unparsable));
        let none = Config {
            frequency_hz: Some(0),
            ..Config::DEFAULT
        };
        assert_eq!(none.check().unwrap_err().field(), "frequency_hz");
    }
}
