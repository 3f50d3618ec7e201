//! Times of the day as dates.

use foxhunt_decode::time_and_date;

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
        if let Some(time_ms) = time_and_date(line) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
