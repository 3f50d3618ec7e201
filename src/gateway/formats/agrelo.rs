//! Bearings of an Agrelo: `%BBB/Q`.

use super::format::{Format, Layout, Reading, Sentence};
use super::{Config as All, Finder};
use crate::ConfigError;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::decimal;
use crate::gateway::sigma::{SigmaTable, preset};

pub(super) const EXAMPLE: &str = "%270/9";

/// The format `%BBB/Q`: three digits of bearing, one of quality.
#[derive(Debug)]
pub struct Agrelo;

/// What the format is told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Standard deviations by the quality, such as [`SIGMAS`], in place of those of
    /// [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
}

impl Config {
    /// No standard deviations of its own.
    pub const DEFAULT: Self = Self { sigmas: None };

    /// Checks all fields.
    ///
    /// # Errors
    /// None: every value is right.
    pub const fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }
}

impl Default for Config {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Half of the beam width that the digit stands for in APRS, from which the form comes: less than 240 degrees for 1, 120
/// for 2, 64 for 3 and half of the one before from there on (APRS Protocol Reference 1.0.1, chapter 7). No less than 2
/// degrees, as nothing on a car is better.
pub const SIGMAS: SigmaTable = preset(&[
    (100.0 / 9.0, 120.0),
    (200.0 / 9.0, 60.0),
    (300.0 / 9.0, 32.0),
    (400.0 / 9.0, 16.0),
    (500.0 / 9.0, 8.0),
    (600.0 / 9.0, 4.0),
    (700.0 / 9.0, 2.0),
]);

impl Format for Agrelo {
    const FINDER: Option<Finder> = Some(Finder::Agrelo);
    const LAYOUT: Layout = Layout {
        longest: 6,
        fields: u8::MAX,
        interrupts: true,
        holds: |_, _| false,
    };
    const EMPTY: Self = Self;

    fn begins(byte: u8) -> bool {
        byte == b'%'
    }

    #[inline(never)]
    fn parse(&mut self, line: &[u8], config: &All) -> Result<Sentence, Rejected> {
        let [b'%', bearing @ .., b'/', quality] = line else {
            return Err(Rejected::Unparsable);
        };
        let digits = bearing.len() == 3 && bearing.iter().chain([quality]).all(u8::is_ascii_digit);
        let bearing = decimal(bearing)
            .filter(|_| digits)
            .ok_or(Rejected::Unparsable)?;
        let quality = f32::from(quality - b'0') * (100.0 / 9.0);
        Reading::new(bearing, quality, config.agrelo.sigmas).map(Sentence::Reading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::formats::tests::read;

    #[test]
    fn reads_bearing_and_quality() {
        let line = read::<Agrelo>("%270/9", &All::DEFAULT).unwrap();
        assert_eq!(
            (line.best.degrees, line.quality, line.time),
            (270.0, 100.0, None)
        );
        let quality = read::<Agrelo>("%000/0", &All::DEFAULT).map(|line| line.quality);
        assert_eq!(quality, Ok(0.0));
    }

    #[test]
    fn refuses_malformed_lines() {
        let refused = |line| read::<Agrelo>(line, &All::DEFAULT).unwrap_err();
        assert_eq!(refused("%361/5"), Rejected::OutOfRange);
        for line in [
            "%27/9", "%270/", "%270-9", "%2 0/9", "%-70/9", "%1.0/9", "%270/x", "%",
        ] {
            assert_eq!(refused(line), Rejected::Unparsable, "{line}");
        }
    }

    #[test]
    fn sigmas_follow_the_beam_width_of_aprs() {
        for (digit, degrees) in [
            (9.0, 2.0),
            (7.0, 2.0),
            (6.0, 4.0),
            (3.0, 32.0),
            (0.0, 120.0_f32),
        ] {
            let sigma = SIGMAS.sigma_rad(digit * (100.0 / 9.0)).to_degrees();
            assert!((sigma - degrees).abs() < 1e-3, "{digit}");
        }
    }
}
