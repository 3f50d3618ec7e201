//! Times of a day as dates, for programs that need them.

/// Milliseconds of a day.
const DAY: i64 = 86_400_000;

/// Times in their order as milliseconds after 1970: a time that is half a day or more before the one before it is of the next
/// day.
pub(super) struct Days {
    midnight_ms: i64,
    last_ms: i64,
}

impl Days {
    /// From the midnight before the first time on.
    pub fn new(midnight_ms: i64) -> Self {
        let last_ms = midnight_ms + DAY / 2;
        Self {
            midnight_ms,
            last_ms,
        }
    }

    /// Milliseconds after 1970 of a time in milliseconds after midnight.
    pub fn at(&mut self, time_ms: u32) -> i64 {
        let mut time = self.midnight_ms + i64::from(time_ms);
        if time - self.last_ms < -DAY / 2 {
            self.midnight_ms += DAY;
            time += DAY;
        }
        self.last_ms = time;
        time
    }
}

/// `09:30:04.005`, of milliseconds after midnight.
pub fn time(time_ms: u32) -> String {
    super::coordinates::clock(time_ms)
}

/// `2026-11-28T09:30:04.005Z`, of milliseconds after 1970.
pub fn date(time_ms: i64) -> String {
    let (days, time) = (time_ms.div_euclid(DAY), time_ms.rem_euclid(DAY));
    // Years begin in March, so that the leap day is the last; eras are of 400 years.
    let shifted = days + 719_468;
    let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    let year = 400 * era + year + next;
    let (seconds, milliseconds) = (time / 1000, time % 1000);
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!(
        "{year:04}-{month:02}-{day:02}T{hours:02}:{minutes:02}:{:02}.{milliseconds:03}Z",
        seconds % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        assert_eq!(date(0), "1970-01-01T00:00:00.000Z");
        assert_eq!(date(951_782_400_000), "2000-02-29T00:00:00.000Z");
        assert_eq!(date(1_756_823_719_250), "2025-09-02T14:35:19.250Z");
        assert_eq!(date(1_795_824_000_000 - 1), "2026-11-27T23:59:59.999Z");
    }

    #[test]
    fn midnight_begins_another_day() {
        let mut days = Days::new(10 * DAY);
        assert_eq!(days.at(86_399_000), 11 * DAY - 1_000);
        assert_eq!(days.at(1_000), 11 * DAY + 1_000);
        // A little late.
        assert_eq!(days.at(500), 11 * DAY + 500);
    }
}
