//! Sentences of the NMEA form, read and written: `$payload*hh`; and their numbers, exactly: an f32 would lose half a metre
//! of a longitude.

use heapless::String;

use super::outcome::Rejected;
use crate::aoa::geodesy::Geodetic;

/// What stands between one of the bytes that `begin` a line and `*hh`, if its exclusive or is `hh`.
pub(super) fn checked<'a>(line: &'a [u8], begin: &[u8]) -> Option<&'a [u8]> {
    let [first, payload @ .., b'*', high, low] = line else {
        return None;
    };
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let stated = digit(*high)
        .zip(digit(*low))
        .map(|(high, low)| high << 4 | low);
    let is_right = begin.contains(first) && stated == Some(u32::from(checksum(payload)));
    is_right.then_some(payload)
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

/// The decimal number `text` times 10 to the power `places`, rounded half away from zero.
///
/// `None` unless it is an optional sign and digits with at most one point among them, below 10^17.
// Called for every field: once in flash is enough.
#[inline(never)]
pub(super) fn fixed(text: &[u8], places: u32) -> Option<i64> {
    const LIMIT: i64 = 100_000_000_000_000_000;
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    let mut value = 0i64;
    let mut any = false;
    // Decimals still to come, once the point is passed.
    let mut missing = None;
    for &byte in digits {
        match (byte, missing) {
            (b'.', None) => missing = Some(places),
            (b'0'..=b'9', _) => {
                let digit = i64::from(byte - b'0');
                any = true;
                match missing {
                    Some(0) => {
                        // The first digit too many rounds; those after it only have to be digits.
                        value += i64::from(digit >= 5);
                        missing = Some(u32::MAX);
                    }
                    Some(u32::MAX) => {}
                    _ => {
                        value = value * 10 + digit;
                        missing = missing.map(|m| m - 1);
                    }
                }
            }
            _ => return None,
        }
        if value >= LIMIT {
            return None;
        }
    }
    let missing = missing.unwrap_or(places);
    if missing != u32::MAX {
        for _ in 0..missing {
            value *= 10;
            if value >= LIMIT {
                return None;
            }
        }
    }
    any.then_some(if negative { -value } else { value })
}

/// The decimal number `text`, to four decimals.
#[inline(never)]
pub(super) fn decimal(text: &[u8]) -> Option<f32> {
    i32::try_from(fixed(text, 4)?)
        .ok()
        .map(|value| value as f32 / 1e4)
}

/// From `ddmm.m`, `N` or `S`, `dddmm.m`, `E` or `W`.
#[inline(never)]
pub(super) fn place(fields: [&[u8]; 4]) -> Result<Geodetic, Rejected> {
    let [latitude, north, longitude, east] = fields;
    let latitude = degrees_e7(latitude, 4, north, *b"NS")?;
    let longitude = degrees_e7(longitude, 5, east, *b"EW")?;
    if latitude == 0 && longitude == 0 {
        return Err(Rejected::NullPosition);
    }
    Geodetic::new(latitude, longitude).map_err(|_| Rejected::OutOfRange)
}

/// From `dddmm.mmmm`, with so many digits before the point, and one of the two `sides`, of which the second is negative.
#[inline(never)]
fn degrees_e7(text: &[u8], digits: usize, side: &[u8], sides: [u8; 2]) -> Result<i32, Rejected> {
    let are_so_many = text.iter().take_while(|byte| byte.is_ascii_digit()).count() == digits
        && text.get(digits) == Some(&b'.');
    // Finer than the result, so that it is rounded once.
    let value = fixed(text, 9)
        .filter(|_| are_so_many)
        .ok_or(Rejected::Unparsable)?;
    let (degrees, minutes_e9) = (value / 100_000_000_000, value % 100_000_000_000);
    if minutes_e9 >= 60_000_000_000 || degrees > 180 {
        return Err(Rejected::OutOfRange);
    }
    let degrees_e7 = (degrees * 10_000_000 + (minutes_e9 + 3_000) / 6_000) as i32;
    match sides.map(|s| side == [s]) {
        [true, _] => Ok(degrees_e7),
        [_, true] => Ok(-degrees_e7),
        _ => Err(Rejected::Unparsable),
    }
}

/// In a radian.
pub(super) const DEGREES: f32 = 180.0 / core::f32::consts::PI;

/// The same direction within 0 and 360 degrees.
pub(super) fn turned(degrees: f32) -> f32 {
    let rest = within_a_turn(degrees);
    if rest < 0.0 { rest + 360.0 } else { rest }
}

/// The same direction within half a turn either way.
pub(super) fn half_turned(degrees: f32) -> f32 {
    match within_a_turn(degrees) {
        rest if rest > 180.0 => rest - 360.0,
        rest if rest < -180.0 => rest + 360.0,
        rest => rest,
    }
}

/// The same direction without whole turns.
// Once in flash is enough.
#[inline(never)]
fn within_a_turn(degrees: f32) -> f32 {
    let turns = (degrees * (1.0 / 360.0)) as i32;
    degrees - 360.0 * turns as f32
}

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

    #[inline(never)]
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
    fn directions_are_the_same_within_a_turn() {
        for (degrees, whole, half) in [
            (0.0, 0.0, 0.0),
            (-10.0, 350.0, -10.0),
            (180.0, 180.0, 180.0),
            (-180.0, 180.0, -180.0),
            (190.0, 190.0, -170.0),
            (-190.0, 170.0, 170.0),
            (270.0, 270.0, -90.0),
            (360.0, 0.0, 0.0),
            (725.0, 5.0, 5.0),
            (-725.0, 355.0, -5.0),
        ] {
            assert_eq!((turned(degrees), half_turned(degrees)), (whole, half));
        }
    }

    #[test]
    fn places_are_up_to_the_poles_and_the_date_line() {
        let read = |latitude: &str, longitude: &str| {
            place([latitude.as_bytes(), b"S", longitude.as_bytes(), b"E"])
        };
        let place = |latitude, longitude| Ok(Geodetic::new(latitude, longitude).unwrap());
        assert_eq!(
            read("9000.0", "18000.0"),
            place(-900_000_000, 1_800_000_000)
        );
        assert_eq!(read("0000.0", "18000.0"), place(0, 1_800_000_000));
        assert_eq!(read("4859.9999995", "00000.0"), place(-490_000_000, 0));
        // Of 1e-7 degree a minute has 166,666 and two thirds.
        assert_eq!(read("0000.0", "00000.000003"), place(0, 1));
        assert_eq!(read("0000.0", "00000.0000029"), Err(Rejected::NullPosition));
        for (latitude, longitude) in [
            ("4860.0", "01100.0"),
            ("9000.00001", "01100.0"),
            ("4800.0", "18000.00001"),
            ("4800.0", "18100.0"),
        ] {
            assert_eq!(read(latitude, longitude), Err(Rejected::OutOfRange));
        }
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

    #[test]
    fn decimals_are_exact() {
        for (text, places, value) in [
            ("52.2296756", 7, 522_296_756),
            ("-0.1278", 7, -1_278_000),
            ("179.99999995", 7, 1_800_000_000),
            ("0.00000004999", 7, 0),
            ("-12.5", 0, -13),
            ("12.49999", 0, 12),
            ("7", 3, 7_000),
            ("7.", 3, 7_000),
            (".5", 1, 5),
            ("+3.25", 1, 33),
            ("123519.00", 3, 123_519_000),
            ("1756800000123", 0, 1_756_800_000_123),
        ] {
            assert_eq!(fixed(text.as_bytes(), places), Some(value), "{text}");
        }
    }

    #[test]
    fn what_is_no_decimal_is_no_number() {
        for text in [
            "",
            ".",
            "-",
            "+.",
            "1.2.3",
            "1e5",
            "nan",
            "12a",
            "--1",
            "1-",
            " 1",
            "1,2",
            "100000000000000000",
            "99999999999999999999999999999999",
        ] {
            assert_eq!(fixed(text.as_bytes(), 0), None, "{text}");
        }
        assert_eq!(fixed(b"99999999999", 7), None);
        assert_eq!(fixed(&[b'0'; 300], 7), Some(0));
        assert_eq!(decimal(b"214748.3648"), None);
        assert_eq!(decimal(b"-359.5"), Some(-359.5));
    }
}
