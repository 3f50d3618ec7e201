//! Bearings of KN5R-RDF and of those that send its "C" sentence, such as rotaryclub: Doppler sets with a clock.
//!
//! 26 characters without blanks, 20 times a second:
//!
//! | place | field | unit, sense | taken as |
//! |---|---|---|---|
//! | 1 | `C` | | |
//! | 2 to 5 | bearing, 0 to 3599 | tenths of a degree clockwise from the bow | bearing |
//! | 6 to 8 | length of the mean of the vectors of all zero crossings, 0 to 999 | thousandths, linear; 1 where all agree | quality, 0 to 100 |
//! | 9 to 11 | peak of the filtered Doppler tone, 0 to 999 | thousandths of full scale | not used: a level, not an accuracy |
//! | 12 to 26 | time at the end of the twentieth of a second that was measured | milliseconds since 1970 | time, half of that earlier |
//!
//! A set without a signal goes on sending: the quality alone tells. Source: rotaryclub's `kn5r-format.md`, which quotes
//! KN5R's `data-format.md` for the places and KR6DD's `RPiDDFengine` for what they hold.

pub use super::format::ByQuality as Config;
use super::format::{Format, Layout, Reading, Sentence};
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::fixed;
use crate::gateway::sigma::{SigmaTable, preset};

/// 346.9 degrees, magnitude 960, tone 84.
pub(super) const EXAMPLE: &str = "C3469960084001663117493011";

/// The "C" sentence of KN5R-RDF.
#[derive(Debug)]
pub struct Kn5r;

/// The standard deviation of the single zero crossing, which follows from the mean's length R as sqrt(-2 ln R). That of the
/// mean of many is less, but for reflections, which are common to all; no less than 3 degrees: an estimate.
pub const SIGMAS: SigmaTable = preset(&[
    (20.0, 103.0),
    (40.0, 77.6),
    (60.0, 57.9),
    (80.0, 38.3),
    (90.0, 26.3),
    (95.0, 18.4),
    (99.0, 8.1),
    (100.0, 3.0),
]);

/// Half of a twentieth of a second.
const LATENCY_MS: u32 = 25;

impl Format for Kn5r {
    type Config = Config;
    const DEFAULT: Config = Config {
        sigmas: Some(&SIGMAS),
    };
    const LAYOUT: Layout = Layout {
        longest: 26,
        begins: |byte| byte == b'C',
        continues: |byte| byte.is_ascii_digit(),
        ..Layout::TEXT
    };
    const EMPTY: Self = Self;

    #[inline(never)]
    fn parse(&mut self, line: &[u8], config: &Config) -> Result<Sentence, Rejected> {
        let [b'C', digits @ ..] = line else {
            return Err(Rejected::Unparsable);
        };
        if digits.len() != 25 || !digits.iter().all(u8::is_ascii_digit) {
            return Err(Rejected::Unparsable);
        }
        let number = |from: usize, to: usize| digits.get(from..to).and_then(|text| fixed(text, 0));
        let (Some(tenths), Some(magnitude), Some(time)) =
            (number(0, 4), number(4, 7), number(10, 25))
        else {
            return Err(Rejected::Unparsable);
        };
        let quality = magnitude as f32 * (100.0 / 999.0);
        Ok(Sentence::Reading(Reading {
            time: Some(TimeOfDay::from_epoch(time)),
            latency_ms: LATENCY_MS,
            ..Reading::new(tenths as f32 * 0.1, quality.min(100.0), config.sigmas)?
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::formats::tests::read;

    #[test]
    fn reads_bearing_magnitude_and_time() {
        let line = read::<Kn5r>(EXAMPLE, &Kn5r::DEFAULT).unwrap();
        assert!((line.best.degrees - 346.9).abs() < 1e-3);
        assert!((line.quality - 96.096).abs() < 1e-3);
        // 1,663,117,493.011 s after 1970: 01:04:53.011 UTC.
        assert_eq!(line.time, TimeOfDay::from_nmea(b"010453.011"));
        assert_eq!(line.latency_ms, 25);
        let full = read::<Kn5r>("C0000999084001663117493011", &Kn5r::DEFAULT).unwrap();
        assert!((full.quality - 100.0).abs() < 1e-4);
    }

    #[test]
    fn refuses_malformed_lines() {
        let refused = |line| read::<Kn5r>(line, &Kn5r::DEFAULT).unwrap_err();
        assert_eq!(refused("C3601960084001663117493011"), Rejected::OutOfRange);
        for line in [
            "C346996008400166311749301",
            "C34699600840016631174930111",
            "C3469960084001663117493 11",
            "C-469960084001663117493011",
            "C34.9960084001663117493011",
            "C",
            "S3469960084001663117493011",
        ] {
            assert_eq!(refused(line), Rejected::Unparsable, "{line}");
        }
    }

    #[test]
    fn sigmas_follow_from_the_length_of_the_mean() {
        for length in [0.4, 0.6, 0.8, 0.9, 0.95, 0.99_f64] {
            let sigma = (-2.0 * length.ln()).sqrt().to_degrees();
            let found = f64::from(SIGMAS.sigma_rad(100.0 * length as f32)).to_degrees();
            assert!((found - sigma).abs() < 0.1, "{length}: {found} {sigma}");
        }
    }
}
