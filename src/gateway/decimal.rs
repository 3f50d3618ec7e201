//! Exact decimals: an f32 would lose half a metre of a longitude.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact() {
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
    fn not_a_number() {
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
