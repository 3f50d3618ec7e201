//! Sentences of the NMEA form, read and written: `$payload*hh`.

use heapless::String;

/// What stands between `$` or `!` and `*hh`, if its exclusive or is `hh`.
pub(super) fn checked(line: &[u8]) -> Option<&[u8]> {
    let [b'$' | b'!', payload @ .., b'*', high, low] = line else {
        return None;
    };
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let stated = digit(*high)
        .zip(digit(*low))
        .map(|(high, low)| high << 4 | low);
    (stated == Some(u32::from(checksum(payload)))).then_some(payload)
}

/// The exclusive or of all bytes.
pub(super) fn checksum(payload: &[u8]) -> u8 {
    payload.iter().fold(0, |sum, byte| sum ^ byte)
}

/// The first `C` fields, if there are so many.
pub(super) fn columns<const C: usize>(fields: &[u8]) -> Option<[&[u8]; C]> {
    let mut columns = [&[] as &[u8]; C];
    split(fields, &mut columns).then_some(columns)
}

/// Splits at commas that are not within quotes; whether there are as many fields as columns.
// Called for every kind of line: once in flash is enough.
#[inline(never)]
fn split<'a>(fields: &'a [u8], columns: &mut [&'a [u8]]) -> bool {
    let mut is_quoted = false;
    let mut rest = fields.split(|byte| {
        is_quoted ^= *byte == b'"';
        *byte == b',' && !is_quoted
    });
    columns.iter_mut().all(|column| {
        let field = rest.next();
        *column = field.unwrap_or_default();
        field.is_some()
    })
}

/// In a radian.
pub(super) const DEGREES: f32 = 180.0 / core::f32::consts::PI;

/// How finely a number is written.
#[derive(Clone, Copy)]
pub(super) enum Unit {
    Tenth,
    Thousandth,
}

/// The text of the sentences that one line leads to. Writing never fails: `N` has room for the longest, which the
/// tests of each report check.
#[derive(Debug)]
pub(super) struct Text<const N: usize> {
    text: String<N>,
    /// Where the sentence that is being written begins.
    start: usize,
}

impl<const N: usize> Text<N> {
    pub const fn new() -> Self {
        Self {
            text: String::new(),
            start: 0,
        }
    }

    pub fn clear(&mut self) {
        self.text.clear();
    }

    pub fn as_str(&self) -> &str {
        &self.text
    }

    pub fn begin(&mut self, name: &str) {
        self.start = self.text.len();
        self.put("$");
        self.put(name);
    }

    pub fn end(&mut self) {
        let sentence = self
            .text
            .as_bytes()
            .get(self.start + 1..)
            .unwrap_or_default();
        let sum = checksum(sentence);
        self.put("*");
        for digit in [sum >> 4, sum & 15] {
            let letter = if digit < 10 {
                b'0' + digit
            } else {
                b'A' + (digit - 10)
            };
            self.letter(letter);
        }
        self.put("\r\n");
    }

    pub fn field(&mut self, value: u32) {
        self.put(",");
        self.digits(value, 1);
    }

    /// A value in tenths or thousandths; nothing if it is not finite.
    pub fn signed(&mut self, value: f32, unit: Unit) {
        self.put(",");
        // What rounds to zero has no sign.
        let least = match unit {
            Unit::Tenth => -0.05,
            Unit::Thousandth => -0.000_5,
        };
        if value < least && value.is_finite() {
            self.put("-");
        }
        self.magnitude(value.abs(), unit);
    }

    /// A value that is not negative, in tenths or thousandths; nothing if it is not finite.
    pub fn decimal(&mut self, value: f32, unit: Unit) {
        self.put(",");
        self.magnitude(value, unit);
    }

    fn magnitude(&mut self, value: f32, unit: Unit) {
        if value.is_finite() {
            let (per_one, width) = match unit {
                Unit::Tenth => (10, 1),
                Unit::Thousandth => (1_000, 3),
            };
            let scaled = (value * per_one as f32 + 0.5) as u32;
            self.digits(scaled / per_one, 1);
            self.put(".");
            self.digits(scaled % per_one, width);
        }
    }

    /// At least `width` digits.
    #[inline(never)]
    pub fn digits(&mut self, value: u32, width: u32) {
        let mut rest = value;
        let mut reversed = 0u64;
        let mut count = 0;
        // Four bits a digit, the first in the lowest.
        while count < width || rest > 0 {
            reversed = reversed << 4 | u64::from(rest % 10);
            rest /= 10;
            count += 1;
        }
        for _ in 0..count {
            self.letter(b'0' + (reversed & 15) as u8);
            reversed >>= 4;
        }
    }

    #[inline(never)]
    fn letter(&mut self, letter: u8) {
        // The capacity is checked by a test; a report that were too long would be cut.
        let _ = self.text.push(char::from(letter));
    }

    #[inline(never)]
    pub fn put(&mut self, text: &str) {
        let _ = self.text.push_str(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed() {
        let mut text = Text::<64>::new();
        for value in [-1.25, -0.04, 0.0, 2.0, f32::NEG_INFINITY] {
            text.signed(value, Unit::Tenth);
        }
        text.signed(-0.001, Unit::Thousandth);
        assert_eq!(text.as_str(), ",-1.3,0.0,0.0,2.0,,-0.001");
    }

    #[test]
    fn digits() {
        for (value, width, text) in [
            (0, 1, "0"),
            (0, 3, "000"),
            (7, 2, "07"),
            (4_294_967_295, 2, "4294967295"),
            (100, 1, "100"),
        ] {
            let mut report = Text::<16>::new();
            report.digits(value, width);
            assert_eq!(report.as_str(), text);
        }
    }
}
