//! Bearings of an Agrelo, and of those that send its line, such as PicoDopp: `%BBB/Q`.
//!
//! Six characters, ended by CR, up to 15 times a second:
//!
//! | place | field | unit, sense | taken as |
//! |---|---|---|---|
//! | 1 | `%` | | |
//! | 2 to 4 | BBB: bearing, 0 to 360 | degrees clockwise from the bow, or from north: see [`BearingReference`](crate::gateway::BearingReference) | bearing |
//! | 5 | `/` | | |
//! | 6 | Q: quality, 0 to 9; some sets always send the same | | quality, 0 to 100 |
//!
//! The line states no time: a bearing is taken at the receiver's. Sources: APRS Protocol Reference 1.0.1, chapter 5, for the
//! set, APRS12c, appendix 1, for the line; the manual of WB6EYV's PicoDopp, which sends `%240/7`.

pub use super::format::ByQuality as Config;
use super::format::{Format, Layout, Reading, Sentence};
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::decimal;

pub(super) const EXAMPLE: &str = "%270/9";

/// The format `%BBB/Q`: three digits of bearing, one of quality.
#[derive(Debug)]
pub struct Agrelo;

impl Format for Agrelo {
    type Config = Config;
    const DEFAULT: Config = Config { sigmas: None };
    const LAYOUT: Layout = Layout {
        longest: 6,
        begins: |byte| byte == b'%',
        interrupts: true,
        ..Layout::TEXT
    };
    const EMPTY: Self = Self;

    #[inline(never)]
    fn parse(&mut self, line: &[u8], config: &Config) -> Result<Sentence, Rejected> {
        let [b'%', bearing @ .., b'/', quality] = line else {
            return Err(Rejected::Unparsable);
        };
        let digits = bearing.len() == 3 && bearing.iter().chain([quality]).all(u8::is_ascii_digit);
        let bearing = decimal(bearing)
            .filter(|_| digits)
            .ok_or(Rejected::Unparsable)?;
        let quality = f32::from(quality - b'0') * (100.0 / 9.0);
        Reading::new(bearing, quality, config.sigmas).map(Sentence::Reading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::formats::tests::read;

    #[test]
    fn reads_bearing_and_quality() {
        let line = read::<Agrelo>("%270/9", &Agrelo::DEFAULT).unwrap();
        assert_eq!(
            (line.best.degrees, line.quality, line.time),
            (270.0, 100.0, None)
        );
        // As PicoDopp's manual has it.
        let line = read::<Agrelo>("%240/7", &Agrelo::DEFAULT).unwrap();
        assert_eq!(line.best.degrees, 240.0);
        assert!((line.quality - 700.0 / 9.0).abs() < 1e-4);
        let quality = read::<Agrelo>("%000/0", &Agrelo::DEFAULT).map(|line| line.quality);
        assert_eq!(quality, Ok(0.0));
    }

    #[test]
    fn refuses_malformed_lines() {
        let refused = |line| read::<Agrelo>(line, &Agrelo::DEFAULT).unwrap_err();
        assert_eq!(refused("%361/5"), Rejected::OutOfRange);
        for line in [
            "%27/9", "%270/", "%270-9", "%2 0/9", "%-70/9", "%1.0/9", "%270/x", "%",
        ] {
            assert_eq!(refused(line), Rejected::Unparsable, "{line}");
        }
    }
}
