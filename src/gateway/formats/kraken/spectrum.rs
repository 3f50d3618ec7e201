//! The spectrum at the end of a KrakenSDR's line, read as its bytes arrive.

use core::f32::consts::LN_10;

use crate::aoa::spectrum::Spectrum;
use crate::gateway::formats::format::{Ray, Reading};
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::turned;
use crate::math::exp_of_weight;

/// Reads the values of one line after the other, and keeps what tells of their whole.
#[derive(Debug, Clone)]
pub(super) struct SpectrumReader {
    digest: Digest,
    stage: Stage,
    /// The digits of the number so far, no more than two of them after the point.
    digits: u32,
    /// How many of them are after it.
    decimals: u8,
    malformed: bool,
}

/// What is kept of a spectrum whose values are not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Digest {
    count: u16,
    /// The highest level, in hundredths of a decibel.
    highest: u16,
    /// Degrees of the first value that is as high, counter-clockwise from the bow.
    pub top: u16,
    /// The sum of all powers over the highest: the degrees of a peak without flanks that is as high and holds as much.
    pub width: f32,
    /// The same for the same values, and next to never for others; zero before the first.
    pub hash: u32,
}

/// How far a number has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Nothing, or blanks.
    Blank,
    /// A letter that stands before the values.
    Reserved,
    /// Digits before the point.
    Whole,
    /// Digits after it.
    Decimals,
    /// Blanks after it.
    Ended,
}

impl Digest {
    const EMPTY: Self = Self {
        count: 0,
        highest: 0,
        top: 0,
        width: 0.0,
        hash: 0,
    };

    fn push(&mut self, level: u16) {
        let below = power(-f32::from(level.abs_diff(self.highest)));
        if level > self.highest {
            self.highest = level;
            self.top = self.count;
            self.width = self.width * below + 1.0;
        } else {
            self.width += below;
        }
        // By Fowler, Noll and Vo, of levels in place of bytes.
        self.hash = (self.hash ^ u32::from(level) ^ 0x811c_9dc5).wrapping_mul(0x0100_0193);
        self.count = self.count.saturating_add(1);
    }
}

/// A power of so many hundredths of a decibel, which are not above zero. Once in flash is enough.
#[inline(never)]
pub(super) fn power(level: f32) -> f32 {
    exp_of_weight(LN_10 / 1_000.0 * level)
}

impl SpectrumReader {
    pub const EMPTY: Self = Self {
        digest: Digest::EMPTY,
        stage: Stage::Blank,
        digits: 0,
        decimals: 0,
        malformed: false,
    };

    /// A line begins.
    pub fn begin(&mut self) {
        *self = Self::EMPTY;
    }

    /// Takes a byte of what follows the fields that are kept, and gives the level that ends with it, in hundredths of a decibel.
    #[inline(never)]
    pub fn take(&mut self, byte: u8) -> Option<u16> {
        self.stage = match (byte, self.stage) {
            (b',', _) => return self.finish(),
            (b'0'..=b'9', Stage::Blank | Stage::Whole | Stage::Decimals) => {
                return self.digit(byte - b'0');
            }
            (b'.', Stage::Whole) => Stage::Decimals,
            (b' ', Stage::Whole | Stage::Decimals) => Stage::Ended,
            (b' ', same) => same,
            // Where a name has commas of its own, the reserved fields are not among those that are kept.
            (b'R', Stage::Blank) if self.digest.count == 0 => Stage::Reserved,
            (_, same) => {
                self.malformed = true;
                same
            }
        };
        None
    }

    fn digit(&mut self, digit: u8) -> Option<u16> {
        if self.stage != Stage::Decimals {
            self.stage = Stage::Whole;
        } else if self.decimals < 2 {
            self.decimals += 1;
        } else {
            return None;
        }
        self.digits = self.digits.saturating_mul(10);
        self.digits = self.digits.saturating_add(u32::from(digit));
        None
    }

    /// What is known of the spectrum, after [`Self::finish`], if it was well-formed and whole.
    pub fn digest(&self) -> Option<&Digest> {
        let whole = usize::from(self.digest.count) == Spectrum::CELLS;
        (whole && !self.malformed).then_some(&self.digest)
    }

    /// The number has ended, with a comma or with the line: gives its level.
    #[inline(never)]
    pub fn finish(&mut self) -> Option<u16> {
        let stage = core::mem::replace(&mut self.stage, Stage::Blank);
        let scale = match self.decimals {
            0 => 100,
            1 => 10,
            _ => 1,
        };
        let level = self.digits.saturating_mul(scale);
        (self.digits, self.decimals) = (0, 0);
        if stage == Stage::Reserved {
            return None;
        }
        self.malformed |= stage == Stage::Blank || level > u32::from(Spectrum::MAX_LEVEL);
        let level = u16::try_from(level).ok().filter(|_| !self.malformed)?;
        self.digest.push(level);
        Some(level)
    }
}

/// What is kept of a spectrum beside its digest: nothing, or all of it.
pub trait Kept {
    /// All bits are zero.
    const EMPTY: Self;

    /// A line begins.
    fn begin(&mut self) {}

    /// Takes the next level, in hundredths of a decibel.
    fn take(&mut self, _level: u16) {}

    /// Makes the bearings of a reading those of its spectrum.
    ///
    /// # Errors
    /// Why it has none.
    fn read(&self, _: &mut Reading, _is_whole: bool, _temper: f32) -> Result<(), Rejected> {
        Ok(())
    }
}

impl Kept for () {
    const EMPTY: Self = ();
}

impl Kept for Spectrum {
    const EMPTY: Self = Self::new();

    fn begin(&mut self) {
        self.clear();
    }

    fn take(&mut self, level: u16) {
        let _ = self.push_level(level);
    }

    fn read(&self, reading: &mut Reading, is_whole: bool, temper: f32) -> Result<(), Rejected> {
        if !is_whole {
            return Err(Rejected::Unparsable);
        }
        let peaks = self.peaks_of_sigma(temper, reading.best.sigma_rad);
        let [best, others @ ..] = peaks.map(|peak| {
            let peak = peak?;
            Some(Ray {
                degrees: turned(-peak.angle_rad.to_degrees()),
                sigma_rad: Some(peak.sigma_rad),
                probability: peak.probability,
            })
        });
        reading.best = best.ok_or(Rejected::LowQuality)?;
        reading.others = others;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::{format, string::String, vec::Vec};

    fn read(text: &str) -> Option<(Vec<u16>, Digest)> {
        let mut reader = SpectrumReader::EMPTY;
        // What stands there is forgotten.
        reader.take(b'x');
        reader.begin();
        let mut levels: Vec<u16> = text.bytes().filter_map(|byte| reader.take(byte)).collect();
        levels.extend(reader.finish());
        reader.digest().map(|digest| (levels, *digest))
    }

    fn with(first: &str) -> Option<u16> {
        let (levels, _) = read(&format!("{first}{}", ", 1.25".repeat(359)))?;
        assert!(levels.len() == 360 && levels[1..].iter().all(|level| *level == 125));
        Some(levels[0])
    }

    #[test]
    fn values_are_read_as_hundredths() {
        for (text, level) in [
            ("0", 0),
            (" 0.00", 0),
            ("12.34", 1_234),
            ("  7. ", 700),
            ("7.5", 750),
            ("99.995", 9_999),
            ("99.99499999999999999999", 9_999),
            ("600", 60_000),
            (" R, R,3", 300),
        ] {
            assert_eq!(with(text), Some(level), "{text}");
        }
    }

    #[test]
    fn refuses_what_is_no_spectrum() {
        for text in [
            "",
            " ",
            ".5",
            "-1",
            "+1",
            "1.2.3",
            "1 2",
            "1. 2",
            ".",
            "nan",
            "inf",
            "1e3",
            "12a",
            "R1",
            "RR",
            "600.01",
            "650",
            "655.3",
            "656",
            "6554",
            "99999999999999",
        ] {
            assert_eq!(with(text), None, "{text}");
        }
        let values: Vec<String> = (0..361).map(|i| format!("{i}.5")).collect();
        assert!(read(&values[..360].join(", ")).is_some());
        assert!(read(&values[..360].join(",")).is_some());
        assert!(read(&format!("{} ", values[..360].join(", "))).is_some());
        for count in [0, 1, 359, 361] {
            assert!(read(&values[..count].join(",")).is_none(), "{count}");
        }
        assert!(read(&format!("{},", values[..360].join(","))).is_none());
        assert!(read(&format!("1, R{}", ", 1".repeat(358))).is_none());
        assert!(size_of::<SpectrumReader>() <= 32);
    }

    #[test]
    fn a_digest_tells_of_the_whole() {
        let of = |level: &dyn Fn(usize) -> f32| {
            let values: Vec<String> = (0..360).map(|i| format!("{:.2}", level(i))).collect();
            read(&values.join(", ")).unwrap().1
        };
        for top in [0, 1, 77, 359] {
            // A peak of 600 decibels is as wide as its degree, however low the first values are.
            let needle = of(&|degree| if degree == top { 600.0 } else { 0.0 });
            assert_eq!((usize::from(needle.top), needle.width), (top, 1.0));
            let step = of(&|degree| if degree == top { 10.0 } else { 0.0 });
            assert!((step.width - 36.9).abs() < 1e-3, "{}", step.width);
        }
        let flat = of(&|_| 3.0);
        assert!((flat.width - 360.0).abs() < 1e-3);
        let hash = |shift: usize| of(&|degree| ((degree + shift) % 360) as f32).hash;
        // As computed elsewhere by the rule of Fowler, Noll and Vo.
        assert_eq!((hash(0), hash(5)), (0xf9c0_a908, 0xcbd9_ba58));
        let mut hashes: Vec<u32> = (0..360).map(hash).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 360);
    }
}
