//! Lines of direction finders.

use super::clock::TimeOfDay;
use super::decimal::{decimal, fixed};
use super::sentence::columns;
use super::{Finder, KrakenConfidence, Rejected, Sense, Settings};
use crate::aoa::geodesy::Geodetic;

/// The largest maximum over mean of a KrakenSDR's spectrum: 360 values of which all but one are zero.
pub(super) const LARGEST_DECIBELS: f32 = 25.563_025;

/// A bearing as its line gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BearingLine {
    pub finder: Finder,
    /// When, if the line says so.
    pub time: Option<TimeOfDay>,
    /// Clockwise from the bow or from north, in degrees within 0 and 360.
    pub degrees: f32,
    /// 0 to 100.
    pub quality: f32,
    /// How long before that time it was taken.
    pub latency_ms: u32,
    /// Where, if the line says so.
    pub pose: Option<Pose>,
}

/// Where a direction finder says that it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub place: Geodetic,
    /// Degrees clockwise from north.
    pub heading: f32,
    /// It is only known from where the vehicle goes.
    pub heading_is_course: bool,
}

impl BearingLine {
    /// A bearing without time or place.
    pub fn new(finder: Finder, degrees: f32, quality: f32) -> Result<Self, Rejected> {
        if (0.0..=360.0).contains(&degrees) && (0.0..=100.0).contains(&quality) {
            Ok(Self {
                finder,
                time: None,
                degrees,
                quality,
                latency_ms: 0,
                pose: None,
            })
        } else {
            Err(Rejected::OutOfRange)
        }
    }

    /// From the Agrelo form `%BBB/Q`: three digits of bearing, one of quality.
    #[inline(never)]
    pub fn from_agrelo(line: &[u8]) -> Result<Self, Rejected> {
        let [b'%', bearing @ .., b'/', quality] = line else {
            return Err(Rejected::Unparsable);
        };
        let digits = bearing.len() == 3 && bearing.iter().chain([quality]).all(u8::is_ascii_digit);
        let bearing = decimal(bearing)
            .filter(|_| digits)
            .ok_or(Rejected::Unparsable)?;
        let quality = f32::from(quality - b'0') * (100.0 / 9.0);
        Self::new(Finder::Agrelo, bearing, quality)
    }

    /// From the CSV line of KrakenSDR's app format, whose first 13 fields are: time in milliseconds since
    /// 1970, bearing, confidence, power, frequency, array, latency, station, latitude, longitude, GPS
    /// heading, compass heading, and which of the two is the main one.
    ///
    /// A latitude and longitude of zero mean that the receiver does not know where it is.
    #[inline(never)]
    pub fn from_kraken(line: &[u8], settings: &Settings) -> Result<Self, Rejected> {
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
            latitude,
            longitude,
            gps,
            compass,
            main,
        ] = fields;

        let number = |text| decimal(text).ok_or(Rejected::Unparsable);
        let degrees_e7 = |text| {
            let value = fixed(text, 7).ok_or(Rejected::Unparsable)?;
            i32::try_from(value).map_err(|_| Rejected::OutOfRange)
        };
        if let Some(wanted) = settings.kraken_frequency_hz() {
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
        let pose = match (degrees_e7(latitude)?, degrees_e7(longitude)?) {
            (0, 0) => None,
            (latitude, longitude) => {
                let place = Geodetic::new(latitude, longitude).map_err(|_| Rejected::OutOfRange)?;
                let heading_is_course = main != b"Compass";
                let heading = number(if heading_is_course { gps } else { compass })?;
                if !(0.0..=360.0).contains(&heading) {
                    return Err(Rejected::OutOfRange);
                }
                Some(Pose {
                    place,
                    heading,
                    heading_is_course,
                })
            }
        };
        let degrees = match settings.sense() {
            Sense::Clockwise => number(bearing)?,
            Sense::CounterClockwise => 360.0 - number(bearing)?,
        };
        let quality = match settings.kraken_confidence() {
            KrakenConfidence::Percent => number(confidence)?,
            KrakenConfidence::Decibels => number(confidence)? * (100.0 / LARGEST_DECIBELS),
        };
        Ok(Self {
            time: Some(time),
            latency_ms,
            pose,
            ..Self::new(Finder::Kraken, degrees, quality)?
        })
    }
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
    use std::format;

    const KRAKEN: &[u8] = b"1756823719250, 297, 87.80, -32.5, 433920000, UCA, 112, \
        fox-1, 52.2296756, -21.0122287, 12.5, 341.25, Compass, R, R, R, R";

    fn read(line: &[u8]) -> Result<BearingLine, Rejected> {
        BearingLine::from_kraken(line, &Settings::new())
    }

    #[test]
    fn kraken() {
        let line = read(KRAKEN).unwrap();
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
    fn kraken_fields() {
        let with = |field: usize, text: &str| {
            let mut line = heapless::Vec::<u8, 240>::new();
            for (index, old) in KRAKEN.split(|b| *b == b',').enumerate() {
                if index > 0 {
                    line.push(b',').unwrap();
                }
                line.extend_from_slice(if index == field { text.as_bytes() } else { old })
                    .unwrap();
            }
            read(&line)
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
        let nowhere: &[u8] = b"1756823719250,5,50,-30,1,UCA,1,x,0.0,0,nan,nan,GPS";
        assert_eq!(read(nowhere).unwrap().pose, None);
        assert_eq!(read(b"1756823719250,5,50"), Err(Rejected::Unparsable));
    }

    #[test]
    fn kraken_builds() {
        let settings = Settings::new().with_sense(Sense::CounterClockwise);
        let line = BearingLine::from_kraken(KRAKEN, &settings).unwrap();
        assert_eq!(line.degrees, 63.0);

        let settings = Settings::new().with_kraken_confidence(KrakenConfidence::Decibels);
        let quality = |decibels: &str| {
            let line = format!("1756823719250,5,{decibels},-30,1,UCA,1,x,0,0,0,0,GPS");
            BearingLine::from_kraken(line.as_bytes(), &settings).map(|line| line.quality)
        };
        assert_eq!(quality("0"), Ok(0.0));
        assert!((quality("10.2252").unwrap() - 40.0).abs() < 0.01);
        assert!((quality("25.56").unwrap() - 100.0).abs() < 0.02);
        assert_eq!(quality("26"), Err(Rejected::OutOfRange));
        assert_eq!(quality("-1"), Err(Rejected::OutOfRange));
    }

    #[test]
    fn kraken_channels() {
        let with = |hertz| {
            let settings = Settings::new().with_kraken_frequency_hz(hertz).unwrap();
            BearingLine::from_kraken(KRAKEN, &settings)
        };
        assert!(with(433_920_000).is_ok());
        assert_eq!(with(433_920_001), Err(Rejected::OtherFrequency));
        let settings = Settings::new().with_kraken_frequency_hz(1).unwrap();
        let line = b"1756823719250,5,50,-30,UHF,UCA,1,x,0,0,0,0,GPS";
        assert_eq!(
            BearingLine::from_kraken(line, &settings),
            Err(Rejected::Unparsable)
        );
    }

    #[test]
    fn agrelo() {
        let line = BearingLine::from_agrelo(b"%270/9").unwrap();
        assert_eq!(
            (line.degrees, line.quality, line.time),
            (270.0, 100.0, None)
        );
        assert_eq!(BearingLine::from_agrelo(b"%000/0").unwrap().quality, 0.0);
        assert_eq!(
            BearingLine::from_agrelo(b"%361/5"),
            Err(Rejected::OutOfRange)
        );
        for line in [
            "%27/9", "%270/", "%270-9", "%2 0/9", "%-70/9", "%1.0/9", "%270/x", "%",
        ] {
            assert_eq!(
                BearingLine::from_agrelo(line.as_bytes()),
                Err(Rejected::Unparsable)
            );
        }
    }
}
