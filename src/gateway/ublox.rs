//! Events of u-blox direction finders.

use super::bearing_line::BearingLine;
use super::decimal::fixed;
use super::sentence::columns;
use super::{Finder, Rejected, Sense, Settings, UbloxQuality};

impl BearingLine {
    /// From the event `+UUDF:` of u-connectLocate: tag, RSSI, azimuth, elevation, RSSI of the other polarisation, channel,
    /// "anchor", "text", milliseconds since the board was switched on, and in later versions a counter.
    ///
    /// The board's time is not that of the receiver, so none is taken; it states no quality: see [`UbloxQuality`].
    #[inline(never)]
    pub fn from_ublox(line: &[u8], settings: &Settings) -> Result<Self, Rejected> {
        let fields = line.strip_prefix(b"+UUDF:").ok_or(Rejected::Unparsable)?;
        let columns: [&[u8]; 9] = columns(fields).ok_or(Rejected::Unparsable)?;
        let [tag, _rssi, azimuth, .., time] = columns;
        let known: usize = columns.iter().map(|column| column.len() + 1).sum();
        // What is left after the time and its comma.
        let counter = fields.get(known..);
        let are_digits = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
        if !are_digits(time) || !counter.is_none_or(are_digits) {
            return Err(Rejected::Unparsable);
        }
        let tag = identifier(tag).ok_or(Rejected::Unparsable)?;
        if settings.ublox_tag().is_some_and(|wanted| wanted != tag) {
            return Err(Rejected::OtherTag);
        }
        let azimuth = fixed(azimuth, 0).ok_or(Rejected::Unparsable)?;
        if !(-90..=90).contains(&azimuth) {
            return Err(Rejected::OutOfRange);
        }
        let degrees = match settings.sense() {
            Sense::Clockwise => azimuth as f32,
            Sense::CounterClockwise => -azimuth as f32,
        };
        let quality = match settings.ublox_quality() {
            UbloxQuality::Best => 100.0,
            UbloxQuality::Azimuth => 100.0 - degrees.abs() * (100.0 / 90.0),
        };
        let quality = if quality > 0.0 { quality } else { 0.0 };
        let degrees = if degrees < 0.0 {
            degrees + 360.0
        } else {
            degrees
        };
        Self::new(Finder::Ublox, degrees, quality)
    }
}

/// Twelve hexadecimal digits.
#[inline(never)]
fn identifier(text: &[u8]) -> Option<u64> {
    let digit = |digit: &u8| char::from(*digit).to_digit(16);
    let value = text
        .iter()
        .try_fold(0, |sum, next| Some(sum << 4 | u64::from(digit(next)?)));
    value.filter(|_| text.len() == 12)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// In the form of the manual, and of boards in use.
    const NINE: &[u8] = b"+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"CCF9579B21AE\",\"\",1129320";
    const TEN: &[u8] = b"+UUDF:F4CE5FC91A6A,-50,-12,20,0,20,\"CD84C98B935D\",\"a,b\",238777,40871";

    fn read(line: &[u8]) -> Result<f32, Rejected> {
        BearingLine::from_ublox(line, &Settings::new()).map(|line| line.degrees)
    }

    #[test]
    fn nine_fields_and_ten() {
        assert_eq!(read(NINE), Ok(26.0));
        assert_eq!(read(TEN), Ok(348.0));
        let other_way = Settings::new().with_sense(Sense::CounterClockwise);
        let line = BearingLine::from_ublox(TEN, &other_way).unwrap();
        assert_eq!((line.degrees, line.quality, line.time), (12.0, 100.0, None));
    }

    #[test]
    fn quality_by_azimuth() {
        let settings = Settings::new().with_ublox_quality(UbloxQuality::Azimuth);
        for (azimuth, quality) in [("0", 100.0), ("45", 50.0), ("-45", 50.0), ("-90", 0.0)] {
            let line = std::format!("+UUDF:6C1DEBA4241B,-65,{azimuth},-65,6,37,\"\",\"\",1");
            let line = BearingLine::from_ublox(line.as_bytes(), &settings).unwrap();
            assert!((line.quality - quality).abs() < 1e-4, "{azimuth}");
        }
    }

    #[test]
    fn one_tag_of_many() {
        let settings = Settings::new().with_ublox_tag(0x6c1d_eba4_241b);
        assert!(BearingLine::from_ublox(NINE, &settings).is_ok());
        assert_eq!(
            BearingLine::from_ublox(TEN, &settings),
            Err(Rejected::OtherTag)
        );
    }

    #[test]
    fn refused() {
        for line in [
            "+UUDF:",
            "+UUDFP:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\"",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1,2,3",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1,",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\",1,2",
            "+UUDF:6C1DEBA4241,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241G,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241B,-65,2.6,-65,6,37,\"\",\"\",x",
        ] {
            assert_eq!(read(line.as_bytes()), Err(Rejected::Unparsable), "{line}");
        }
        let line = b"+UUDF:6C1DEBA4241B,-65,91,-65,6,37,\"\",\"\",1";
        assert_eq!(read(line), Err(Rejected::OutOfRange));
    }
}
