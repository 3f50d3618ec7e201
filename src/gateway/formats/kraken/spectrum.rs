//! The spectrum at the end of a KrakenSDR's line, read as its bytes arrive.

use crate::aoa::spectrum::Spectrum;

/// Reads the values of one line after the other.
#[derive(Debug, Clone)]
pub(super) struct SpectrumReader {
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
    pub const EMPTY: Self = Self {
        spectrum: Spectrum::new(),
        value: Value::Blank,
        malformed: false,
    };

    /// The spectrum of the last line, if [whole](Spectrum::is_whole).
    pub const fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// A line begins.
    pub fn begin(&mut self) {
        self.spectrum.clear();
        self.value = Value::Blank;
        self.malformed = false;
    }

    /// Takes the next byte, from the one after the comma that ends the fields on.
    pub fn take(&mut self, byte: u8) {
        match (byte, self.value) {
            (b',', _) => self.finish(),
            (b'0'..=b'9', _) => self.digit(u32::from(byte - b'0')),
            (b'.', Value::Whole(sum)) => self.value = Value::Decimals(100, sum),
            (b' ', Value::Blank | Value::Ended(_)) => {}
            (b' ', Value::Whole(sum) | Value::Decimals(_, sum)) => self.value = Value::Ended(sum),
            _ => self.malformed = true,
        }
    }

    /// The line has ended: whether its spectrum was whole and well-formed.
    pub fn end(&mut self) -> bool {
        self.finish();
        !self.malformed && self.spectrum.is_whole()
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

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::{format, string::String, vec::Vec};

    fn read(text: &str) -> Option<Spectrum> {
        let mut reader = SpectrumReader::EMPTY;
        // What stands there is forgotten.
        reader.take(b'x');
        reader.begin();
        text.bytes().for_each(|byte| reader.take(byte));
        reader.end().then(|| reader.spectrum().clone())
    }

    fn with(first: &str) -> Option<Spectrum> {
        read(&format!("{first}{}", ", 1.25".repeat(359)))
    }

    #[test]
    fn values_are_read_as_hundredths() {
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
    fn refuses_what_is_no_spectrum() {
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
