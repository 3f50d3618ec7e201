//! Times of the day as dates.

/// Milliseconds of a day.
pub const DAY: i64 = 86_400_000;

/// What lines say of the date.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dates {
    /// A time that is not far from now, in milliseconds after 1970; 0 if none is known.
    near_ms: i64,
    /// Whether a line has said so.
    is_stated: bool,
}

impl Dates {
    /// The time at which something came in, which a line that states a date overrules.
    pub fn arrived(&mut self, time_ms: i64) {
        if !self.is_stated && time_ms > 0 {
            self.near_ms = time_ms;
        }
    }

    /// Looks for a date in a line.
    pub fn line(&mut self, line: &[u8]) {
        if let Some(time_ms) = stated(line) {
            self.stated(time_ms);
        }
    }

    /// A line or message has stated when it was.
    pub fn stated(&mut self, time_ms: i64) {
        self.near_ms = time_ms;
        self.is_stated = true;
    }

    /// Milliseconds after 1970 of a time in milliseconds after midnight.
    pub fn at(&self, time_ms: u32) -> i64 {
        let time = self.near_ms - self.near_ms.rem_euclid(DAY) + i64::from(time_ms);
        match time - self.near_ms {
            _ if self.near_ms == 0 => i64::from(time_ms),
            off if off > DAY / 2 => time - DAY,
            off if off < -DAY / 2 => time + DAY,
            _ => time,
        }
    }
}

/// The date and time of a line, if it has both: RMC, or the time of a KrakenSDR.
fn stated(line: &[u8]) -> Option<i64> {
    let line = std::str::from_utf8(line.get(..line.len().min(120))?).ok()?;
    if line.len() > 14 && line.as_bytes().first()?.is_ascii_digit() {
        let (time, _) = line.split_once(',')?;
        let is_time = time.len() == 13 && time.bytes().all(|b| b.is_ascii_digit());
        return time.parse().ok().filter(|_| is_time);
    }
    let mut fields = line.split(',');
    let is_rmc = fields.next().is_some_and(|name| name.ends_with("RMC"));
    let time = fields.next().filter(|_| is_rmc)?;
    let date = fields.nth(7)?;
    let two = |text: &str, at: usize| text.get(at..at + 2)?.parse::<i64>().ok();
    let [hours, minutes, seconds] = [two(time, 0)?, two(time, 2)?, two(time, 4)?];
    let [day, month, year] = [two(date, 0)?, two(date, 2)?, two(date, 4)?];
    // The Gregorian calendar, in years that begin in March.
    let year = year + if year < 80 { 2000 } else { 1900 };
    let shifted = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = 365 * shifted + shifted / 4 - shifted / 100 + shifted / 400 + of_year - 719_468;
    Some(days * DAY + 1_000 * ((hours * 60 + minutes) * 60 + seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_lines() {
        let rmc = b"$GPRMC,093000.00,A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A*00";
        assert_eq!(stated(rmc), Some(1_795_339_800_000));
        assert_eq!(
            stated(b"1756823719250, 297.0, 7.35"),
            Some(1_756_823_719_250)
        );
        for none in [
            "",
            "$GPRMC",
            "$GPGGA,093000,,,,,,,,,,",
            "$GPRMC,09,A,,,,,,,2a",
        ] {
            assert_eq!(stated(none.as_bytes()), None, "{none}");
        }
    }

    #[test]
    fn a_time_is_of_the_nearest_day() {
        let mut dates = Dates::default();
        assert_eq!(dates.at(5), 5);
        dates.arrived(100 * DAY + 1_000);
        assert_eq!(dates.at(2_000), 100 * DAY + 2_000);
        assert_eq!(dates.at(86_399_000), 100 * DAY - 1_000);
        dates.line(b"1756823719250, 297.0, 7.35");
        dates.arrived(1);
        assert_eq!(dates.at(52_519_000), 1_756_823_719_000);
    }
}
