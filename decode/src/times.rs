//! The times that lines state.

use chrono::{NaiveDate, NaiveTime};

/// Milliseconds of a second and of a day.
const SECOND: i64 = 1_000;
const DAY: i64 = 86_400_000;

/// Milliseconds after midnight, if the line states a time: RMC, GGA, GNS, ZDA, or a reading of a KrakenSDR.
pub fn time_of_day(line: &[u8]) -> Option<i64> {
    let line = std::str::from_utf8(line.get(..line.len().min(200))?.trim_ascii()).ok()?;
    let (first, rest) = line.split_once(',')?;
    if let Some(time) = kraken(first) {
        return Some(time.rem_euclid(DAY));
    }
    let kind = first.strip_prefix('$').and_then(|name| name.get(2..))?;
    if !matches!(kind, "RMC" | "GGA" | "GNS" | "ZDA") {
        return None;
    }
    clock(rest.split(',').next()?)
}

/// Milliseconds after 1970, if the line states date and time: RMC, or a reading of a KrakenSDR.
pub fn time_and_date(line: &[u8]) -> Option<i64> {
    let line = std::str::from_utf8(line.get(..line.len().min(120))?).ok()?;
    let mut fields = line.split(',');
    let first = fields.next()?;
    if let Some(time) = kraken(first).filter(|_| line.len() > 14) {
        return Some(time);
    }
    let time = fields.next().filter(|_| first.ends_with("RMC"))?;
    let date = fields.nth(7)?;
    let [day, month, year] = [two(date, 0)?, two(date, 2)?, two(date, 4)?];
    let year = year + if year < 80 { 2000 } else { 1900 };
    let date = NaiveDate::from_ymd_opt(year as i32, month as u32, day as u32)?;
    let midnight = date.and_time(NaiveTime::MIN).and_utc().timestamp_millis();
    Some(midnight + clock(time.get(..6)?)?)
}

/// The time of a reading of a KrakenSDR, in milliseconds after 1970.
fn kraken(field: &str) -> Option<i64> {
    let is_time = field.len() == 13 && field.bytes().all(|byte| byte.is_ascii_digit());
    field.parse().ok().filter(|_| is_time)
}

/// Milliseconds after midnight of `hhmmss.s`.
pub fn clock(time: &str) -> Option<i64> {
    let milliseconds = match time.get(6..)? {
        "" => 0,
        fraction => {
            let digits = fraction.strip_prefix('.')?;
            if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return None;
            }
            let fraction: f64 = format!("0.{digits}").parse().ok()?;
            (SECOND as f64 * fraction).round() as i64
        }
    };
    let seconds = (two(time, 0)? * 60 + two(time, 2)?) * 60 + two(time, 4)?;
    Some((SECOND * seconds + milliseconds).rem_euclid(DAY))
}

/// Two digits.
fn two(text: &str, at: usize) -> Option<i64> {
    let digits = text.get(at..at + 2)?;
    let are_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
    digits.parse().ok().filter(|_| are_digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_lines() {
        let rmc = b"$GPRMC,093000.00,A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A*00";
        assert_eq!(time_and_date(rmc), Some(1_795_339_800_000));
        assert_eq!(
            time_and_date(b"1756823719250, 297.0, 7.35"),
            Some(1_756_823_719_250)
        );
        for none in [
            "",
            "$GPRMC",
            "$GPGGA,093000,,,,,,,,,,",
            "$GPRMC,09,A,,,,,,,2a",
            "$GPRMC,+9-1-1,A,,,,,,,-1-1-1",
        ] {
            assert_eq!(time_and_date(none.as_bytes()), None, "{none}");
        }
    }

    #[test]
    fn times_of_lines() {
        assert_eq!(time_of_day(b"$GPGGA,000002.5,1\r\n"), Some(2_500));
        assert_eq!(time_of_day(b"$GPRMC,235959.9996,A"), Some(0));
        assert_eq!(time_of_day(b"1795824002000, 2.0"), Some(2_000));
        for none in [
            "$GPGGA,0000",
            "$GPGGA,000002.1e300,1",
            "$GPVTG,000002,1",
            "%270/8",
        ] {
            assert_eq!(time_of_day(none.as_bytes()), None, "{none}");
        }
    }
}
