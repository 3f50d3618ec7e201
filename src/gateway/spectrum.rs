//! The spectrum at the end of a KrakenSDR's line, read as its bytes arrive.

use crate::aoa::spectrum::{Peak, Spectrum, Temper};

/// What becomes of the spectrum of a KrakenSDR's line: [`SkipSpectrum`] or a [`SpectrumReader`].
pub trait TakeSpectrum: sealed::Take {}

impl<S: sealed::Take> TakeSpectrum for S {}

/// Spectra are skipped: a bearing is the one that its line states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SkipSpectrum;

/// Reads spectra, in 736 bytes: a bearing is what the peaks are, each with its share and deviation, in place of the one
/// that the line states. A locator that takes no alternatives has the largest alone.
///
/// The 360 values are decibels over the lowest, counter-clockwise from the array's axis, a degree apart. (So they are in
/// every version of krakensdr_doa that writes this line, whichever way its bearing counts.) A line with more or fewer or
/// with one that is no such number, or above [`Spectrum::MAX_DECIBELS`], is [`Unparsable`](super::Rejected::Unparsable);
/// one without a peak, flat or as good as flat, has [`LowQuality`](super::Rejected::LowQuality).
#[derive(Debug, Clone)]
pub struct SpectrumReader {
    temper: Temper,
    spectrum: Spectrum,
    value: Value,
    malformed: bool,
}

/// A number so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Value {
    /// Nothing, or blanks.
    Blank,
    /// Digits before the point, as hundredths.
    Whole(u32),
    /// Digits after it: what the next counts for, and the sum.
    Decimals(u32, u32),
    /// Blanks after it.
    Ended(u32),
}

/// No level is as high.
const LIMIT: u32 = Spectrum::MAX_LEVEL as u32;

impl SpectrumReader {
    /// To take spectra for likelihoods by `temper`.
    pub const fn new(temper: Temper) -> Self {
        Self {
            temper,
            spectrum: Spectrum::new(),
            value: Value::Blank,
            malformed: false,
        }
    }

    /// That of the last line, if [whole](Spectrum::is_whole).
    pub const fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    fn finish(&mut self) {
        let value = match self.value {
            Value::Blank => None,
            Value::Whole(sum) | Value::Decimals(_, sum) | Value::Ended(sum) => {
                u16::try_from(sum).ok()
            }
        };
        self.malformed |= value.is_none_or(|level| self.spectrum.push_level(level).is_err());
        self.value = Value::Blank;
    }

    fn digit(&mut self, digit: u32) {
        self.value = match self.value {
            Value::Blank => Value::Whole(100 * digit),
            Value::Whole(sum) if sum <= LIMIT => Value::Whole(10 * sum + 100 * digit),
            Value::Decimals(weight, sum) => {
                let part = match weight {
                    0 => 0,
                    // The first digit too many rounds.
                    1 => u32::from(digit >= 5),
                    weight => digit * (weight / 10),
                };
                Value::Decimals(weight / 10, sum + part)
            }
            other => {
                self.malformed = true;
                other
            }
        };
    }
}

impl sealed::Take for SkipSpectrum {
    const READS: bool = false;

    fn begin(&mut self) {}
    fn take(&mut self, _byte: u8) {}
    fn end(&mut self) {}
    fn is_valid(&self) -> bool {
        true
    }
    fn peaks(&self) -> Option<[Option<Peak>; 3]> {
        None
    }
}

impl sealed::Take for SpectrumReader {
    const READS: bool = true;

    fn begin(&mut self) {
        self.spectrum.clear();
        self.value = Value::Blank;
        self.malformed = false;
    }

    fn take(&mut self, byte: u8) {
        match (byte, self.value) {
            (b',', _) => self.finish(),
            (b'0'..=b'9', _) => self.digit(u32::from(byte - b'0')),
            (b'.', Value::Whole(sum)) => self.value = Value::Decimals(100, sum),
            (b' ', Value::Blank | Value::Ended(_)) => {}
            (b' ', Value::Whole(sum) | Value::Decimals(_, sum)) => self.value = Value::Ended(sum),
            _ => self.malformed = true,
        }
    }

    fn end(&mut self) {
        self.finish();
    }

    fn is_valid(&self) -> bool {
        !self.malformed && self.spectrum.is_whole()
    }

    fn peaks(&self) -> Option<[Option<Peak>; 3]> {
        Some(self.spectrum.peaks(self.temper))
    }
}

pub(super) mod sealed {
    use crate::aoa::spectrum::Peak;

    /// Takes the bytes after the fields of a KrakenSDR's line.
    pub trait Take {
        /// Whether it takes anything: what does not costs nothing.
        const READS: bool;
        /// A line begins.
        fn begin(&mut self);
        /// Another byte, from the one after the comma that ends the fields on.
        fn take(&mut self, byte: u8);
        /// The line has ended.
        fn end(&mut self);
        /// Whether its spectrum was one.
        fn is_valid(&self) -> bool;
        /// What was seen in its stead, if it is taken at all.
        fn peaks(&self) -> Option<[Option<Peak>; 3]>;
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::sealed::Take;
    use super::*;
    use std::{format, string::String, vec::Vec};

    fn read(text: &str) -> Option<Spectrum> {
        let mut reader = SpectrumReader::new(Temper::new(0.2).unwrap());
        // What stands there is forgotten.
        reader.take(b'x');
        reader.begin();
        text.bytes().for_each(|byte| reader.take(byte));
        reader.end();
        reader.is_valid().then(|| reader.spectrum().clone())
    }

    fn with(first: &str) -> Option<Spectrum> {
        read(&format!("{first}{}", ", 1.25".repeat(359)))
    }

    #[test]
    fn values_are_hundredths() {
        for (text, decibels) in [
            ("0", 0.0),
            (" 0.00", 0.0),
            ("12.34", 12.34),
            ("  7. ", 7.0),
            ("7.5", 7.5),
            ("99.995", 100.0),
            ("99.99499999999999999999", 99.99),
            ("600", 600.0),
        ] {
            let mut exact = Spectrum::new();
            exact.push(decibels).unwrap();
            (0..359).for_each(|_| exact.push(1.25).unwrap());
            assert_eq!(with(text), Some(exact), "{text}");
        }
    }

    #[test]
    fn refused() {
        for text in [
            "",
            " ",
            ".5",
            "-1",
            "+1",
            "1.2.3",
            "1 2",
            "nan",
            "inf",
            "1e3",
            "12a",
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
            assert_eq!(read(&values[..count].join(",")), None, "{count}");
        }
        assert_eq!(read(&format!("{},", values[..360].join(","))), None);
        assert!(
            size_of::<SpectrumReader>() <= 744,
            "{}",
            size_of::<SpectrumReader>()
        );
    }
}
