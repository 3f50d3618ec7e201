//! Time, as the stream tells it.

use super::outcome::Rejected;
use crate::snapshot::value_as;

/// Milliseconds in a day.
const DAY: i32 = 86_400_000;

/// A time of day, in milliseconds after midnight UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeOfDay(i32);

impl TimeOfDay {
    /// From the NMEA form: six digits `hhmmss`, and a point and decimals if there are any. The leap second counts with the
    /// one before it.
    pub fn from_nmea(text: &[u8]) -> Option<Self> {
        let (digits, rest) = text.split_at_checked(6)?;
        if !digits.iter().all(u8::is_ascii_digit) || !matches!(rest, [] | [b'.', ..]) {
            return None;
        }
        let value = i32::try_from(super::sentence::fixed(text, 3)?).ok()?;
        let (hours, minutes, milliseconds) =
            (value / 10_000_000, value / 100_000 % 100, value % 100_000);
        if !(0..24).contains(&hours) || minutes >= 60 || milliseconds >= 61_000 {
            return None;
        }
        let milliseconds = if milliseconds < 60_000 {
            milliseconds
        } else {
            59_999
        };
        Some(Self((hours * 60 + minutes) * 60_000 + milliseconds))
    }

    /// From hours, minutes, seconds, and nanoseconds that are rounded to milliseconds and may be negative.
    pub fn from_parts([hours, minutes, seconds]: [u8; 3], nanoseconds: i32) -> Option<Self> {
        if hours >= 24 || minutes >= 60 || seconds > 60 {
            return None;
        }
        let whole = (i32::from(hours) * 60 + i32::from(minutes)) * 60 + i32::from(seconds);
        let milliseconds = (nanoseconds / 500_000 + nanoseconds.signum()) / 2;
        Some(Self((1_000 * whole + milliseconds).rem_euclid(DAY)))
    }

    /// From milliseconds since 1970.
    pub fn from_epoch(milliseconds: i64) -> Self {
        Self((milliseconds % i64::from(DAY)) as i32)
    }

    /// So many milliseconds earlier, up to a day.
    pub fn before(self, milliseconds: u32) -> Self {
        let time = self.0 - milliseconds.min(DAY as u32) as i32;
        Self(if time < 0 { time + DAY } else { time })
    }

    /// Since midnight.
    pub const fn milliseconds(self) -> u32 {
        self.0.unsigned_abs()
    }

    /// Hours, minutes, milliseconds.
    pub fn parts(self) -> (u32, u32, u32) {
        let time = self.0.unsigned_abs();
        (time / 3_600_000, time / 60_000 % 60, time % 60_000)
    }

    /// Milliseconds from `earlier` to this time, the short way round the clock: negative if it is the later.
    pub fn since(self, earlier: Self) -> i32 {
        let difference = self.0 - earlier.0;
        if difference > DAY / 2 {
            difference - DAY
        } else if difference <= -DAY / 2 {
            difference + DAY
        } else {
            difference
        }
    }
}

value_as!(TimeOfDay as i32:
    |time| time.0,
    |time| (0..DAY).contains(&time).then_some(Self(time)),
);

/// The clock of one talker: its time may stand still, pass midnight, but not run backwards.
///
/// One wrong stamp far ahead must not silence the talker for hours: when a few lines in a row run backwards, but not among
/// themselves, it is their time that holds.
///
/// Lines that state no time borrow it. When the talker falls silent its time stands still, so how often it may
/// be lent is bounded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    now: Option<TimeOfDay>,
    doubt: Option<TimeOfDay>,
    doubts: u8,
    /// Lines that have borrowed `now`.
    lent: u8,
}

impl Clock {
    /// Lines in a row that run backwards before their time holds: fewer follow a wrong stamp, more lose bearings after a
    /// right one.
    const BELIEF: u8 = 5;

    pub const EMPTY: Self = Self {
        now: None,
        doubt: None,
        doubts: 0,
        lent: 0,
    };

    pub const fn now(&self) -> Option<TimeOfDay> {
        self.now
    }

    /// The time for a line that states none, and how many lines had it before: at most `limit` have it until the talker
    /// moves on, and none while its latest line ran backwards.
    pub fn lend(&mut self, limit: u8) -> Result<(TimeOfDay, u8), Rejected> {
        let now = self.now.ok_or(Rejected::NoPosition)?;
        let lent = self.lent;
        if self.doubts > 0 || lent >= limit {
            return Err(Rejected::StalePosition);
        }
        self.lent = lent.saturating_add(1);
        Ok((now, lent))
    }

    pub fn advance(&mut self, time: TimeOfDay) -> Result<(), Rejected> {
        if self.now.is_some_and(|now| time.since(now) < 0) {
            let runs_on = self.doubt.is_some_and(|doubt| time.since(doubt) >= 0);
            self.doubts = if runs_on {
                self.doubts.saturating_add(1)
            } else {
                1
            };
            self.doubt = Some(time);
            if self.doubts < Self::BELIEF {
                return Err(Rejected::TimeBackwards);
            }
        }
        let stands = self.now == Some(time);
        *self = Self {
            now: Some(time),
            lent: if stands { self.lent } else { 0 },
            ..Self::EMPTY
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> TimeOfDay {
        TimeOfDay::from_nmea(text.as_bytes()).unwrap()
    }

    #[test]
    fn times() {
        assert_eq!(at("000000"), TimeOfDay(0));
        assert_eq!(at("235959.999"), TimeOfDay(DAY - 1));
        assert_eq!(at("235960.50"), TimeOfDay(DAY - 1));
        assert_eq!(at("123519.25").parts(), (12, 35, 19_250));
        assert_eq!(
            TimeOfDay::from_epoch(1_756_823_719_250).parts(),
            (14, 35, 19_250)
        );
        for text in [
            "",
            "240000",
            "126000",
            "120061",
            "-10000",
            "12:35:19",
            "1e5",
            "-005930",
            "+005930",
            "5930",
            "0059301",
            "12351.9",
            "123519.-1",
            "123519-1",
            "123519.1.2",
        ] {
            assert_eq!(TimeOfDay::from_nmea(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn times_in_parts() {
        let parts = |hours, nanoseconds| TimeOfDay::from_parts([hours, 59, 59], nanoseconds);
        for (nanoseconds, milliseconds) in [
            (0, 0),
            (99_999_987, 100),
            (499_999, 0),
            (500_000, 1),
            (-499_999, 0),
            (-500_000, -1),
            (-370_000_000, -370),
            (999_999_999, 1_000),
        ] {
            let time = parts(22, nanoseconds).unwrap();
            assert_eq!(time.since(at("225959")), milliseconds, "{nanoseconds}");
        }
        assert_eq!(parts(23, 999_999_999), Some(TimeOfDay(0)));
        assert_eq!(
            TimeOfDay::from_parts([0, 0, 0], -1_000_000),
            Some(TimeOfDay(DAY - 1))
        );
        // The leap second is the first of the next minute.
        assert_eq!(TimeOfDay::from_parts([12, 59, 60], 0), Some(at("130000")));
        assert_eq!(TimeOfDay::from_parts([12, 59, 61], 0), None);
        assert_eq!(TimeOfDay::from_parts([24, 0, 0], 0), None);
        assert_eq!(TimeOfDay::from_parts([0, 60, 0], 0), None);
    }

    #[test]
    fn before_midnight_is_the_day_before() {
        for (time, milliseconds, earlier) in [
            ("000001", 1_000, "000000"),
            ("000001", 1_001, "235959.999"),
            ("000000", 0, "000000"),
            ("120000", 43_200_000, "000000"),
            ("120000", 86_400_000, "120000"),
            ("120000", u32::MAX, "120000"),
        ] {
            assert_eq!(at(time).before(milliseconds), at(earlier), "{time}");
        }
    }

    #[test]
    fn midnight() {
        assert_eq!(at("000001").since(at("235959")), 2_000);
        assert_eq!(at("235959").since(at("000001")), -2_000);
        assert_eq!(at("120000").since(at("000000")), DAY / 2);
        assert_eq!(at("000000").since(at("120000")), DAY / 2);
        let mut clock = Clock::EMPTY;
        assert_eq!(clock.advance(at("235959")), Ok(()));
        assert_eq!(clock.advance(at("000000")), Ok(()));
        assert_eq!(clock.advance(at("235959")), Err(Rejected::TimeBackwards));
        assert_eq!(clock.now(), Some(at("000000")));
    }

    #[test]
    fn a_time_is_lent_a_limited_number_of_times() {
        let mut clock = Clock::EMPTY;
        assert_eq!(clock.lend(2), Err(Rejected::NoPosition));
        assert_eq!(clock.advance(at("100000")), Ok(()));
        assert_eq!(clock.lend(2), Ok((at("100000"), 0)));
        // Stated again, it is no younger.
        assert_eq!(clock.advance(at("100000")), Ok(()));
        assert_eq!(clock.lend(2), Ok((at("100000"), 1)));
        assert_eq!(clock.lend(2), Err(Rejected::StalePosition));
        assert_eq!(clock.advance(at("100001")), Ok(()));
        assert_eq!(clock.lend(2), Ok((at("100001"), 0)));
        // In doubt it is not lent.
        assert_eq!(clock.advance(at("100000")), Err(Rejected::TimeBackwards));
        assert_eq!(clock.lend(2), Err(Rejected::StalePosition));
        assert_eq!(clock.advance(at("100001")), Ok(()));
        assert_eq!(clock.lend(2), Ok((at("100001"), 1)));
    }

    #[test]
    fn a_wrong_stamp_does_not_last() {
        let mut clock = Clock::EMPTY;
        assert_eq!(clock.advance(at("100000")), Ok(()));
        assert_eq!(clock.advance(at("150000")), Ok(()));
        for second in 1..Clock::BELIEF {
            let time = TimeOfDay(at("100000").0 + i32::from(second) * 1_000);
            assert_eq!(clock.advance(time), Err(Rejected::TimeBackwards));
        }
        assert_eq!(clock.advance(at("100010")), Ok(()));
        assert_eq!(clock.now(), Some(at("100010")));
    }
}
