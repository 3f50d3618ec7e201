//! Where the vehicle was and where it headed, for as long as bearings may be late.

use super::clock::TimeOfDay;
use super::sentence::{half_turned, turned};
use crate::aoa::geodesy::Geodetic;

/// A value that the receiver has stated, and how long ago.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Aged<T> {
    /// The value.
    pub value: T,
    /// Milliseconds by the receiver's own time.
    pub age_ms: u32,
}

/// What has values between two others.
pub(super) trait Between: Copy {
    /// This at a fraction of 0, the other at 1, and on beyond.
    fn towards(self, other: Self, fraction: f32) -> Self;
}

/// Degrees clockwise from north, the short way round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Compass(pub f32);

impl Compass {
    /// Degrees from this to the other, within half a turn either way.
    fn to(self, other: Self) -> f32 {
        half_turned(other.0 - self.0)
    }
}

impl Between for Compass {
    fn towards(self, other: Self, fraction: f32) -> Self {
        Self(turned(self.0 + fraction * self.to(other)))
    }
}

impl Between for Geodetic {
    fn towards(self, other: Self, fraction: f32) -> Self {
        /// A turn does not fit an i32, half of it does.
        const TURN: i64 = 3_600_000_000;
        let wrapped = |x: i64| {
            let x = if x > TURN / 2 {
                x - TURN
            } else if x < -TURN / 2 {
                x + TURN
            } else {
                x
            };
            x as i32
        };
        let along = |from: i32, to: i32| {
            let way = wrapped(i64::from(to) - i64::from(from));
            // Saturates.
            wrapped(i64::from(from) + i64::from((way as f32 * fraction) as i32))
        };
        let latitude = along(self.latitude_e7(), other.latitude_e7());
        let longitude = along(self.longitude_e7(), other.longitude_e7());
        // Beyond a pole there is no place; nobody drives there.
        Geodetic::new(latitude, longitude).unwrap_or(other)
    }
}

/// How many samples are kept.
const KEPT: usize = 8;

/// The last few samples of something, each with its time; the newest first.
#[derive(Debug, Clone)]
pub(super) struct History<T> {
    times: [Option<TimeOfDay>; KEPT],
    values: [Option<T>; KEPT],
}

impl<T: Between> History<T> {
    pub const EMPTY: Self = Self {
        times: [None; KEPT],
        values: [None; KEPT],
    };

    pub fn clear(&mut self) {
        *self = Self::EMPTY;
    }

    /// Whether there ever was a sample.
    pub fn is_empty(&self) -> bool {
        self.times[0].is_none()
    }

    /// The last sample, with its time.
    pub fn last(&self) -> Option<(TimeOfDay, T)> {
        Some((self.times[0]?, self.values[0]?))
    }

    /// The last sample, and its age at a time.
    pub fn newest(&self, now: TimeOfDay) -> Option<Aged<T>> {
        let age = now.since(self.times[0]?);
        Some(Aged {
            value: self.values[0]?,
            age_ms: age.max(0).unsigned_abs(),
        })
    }

    /// Takes a sample. One of the time of the last replaces it; if time has run backwards, the clock was set, and those
    /// before it mean nothing.
    pub fn push(&mut self, time: TimeOfDay, value: T) {
        match self.times[0].map(|newest| time.since(newest)) {
            Some(..0) => self.clear(),
            Some(0) => {}
            _ => {
                self.times.rotate_right(1);
                self.values.rotate_right(1);
            }
        }
        self.times[0] = Some(time);
        self.values[0] = Some(value);
    }

    /// What it was at a time, by samples no further from it than so many milliseconds: between two of them, or as it
    /// went on from the last two, or as the nearest one says.
    pub fn at(&self, time: TimeOfDay, maximum_age_ms: u32) -> Option<T> {
        let (from, to, fraction) = around(&self.times, time, maximum_age_ms)?;
        let [from, to] = [from, to].map(|sample| self.values.get(sample).copied().flatten());
        Some(from?.towards(to?, fraction))
    }
}

/// Which two samples say what it was at a time, and where between them, or beyond the second, that is.
// Apart from the values, so that it is in flash once.
#[inline(never)]
fn around(
    times: &[Option<TimeOfDay>],
    time: TimeOfDay,
    maximum_age_ms: u32,
) -> Option<(usize, usize, f32)> {
    let mut after = None;
    let mut before = None;
    let mut earlier = None;
    for (sample, taken) in times.iter().enumerate() {
        let Some(taken) = taken else {
            break;
        };
        let age = time.since(*taken);
        if age < 0 {
            after = Some((age, sample));
        } else if before.is_none() {
            before = Some((age, sample));
        } else {
            earlier = Some((age, sample));
            break;
        }
    }
    let is_fresh = |age: i32| age.unsigned_abs() <= maximum_age_ms;
    let before = before.filter(|(age, _)| is_fresh(*age));
    let after = after.filter(|(age, _)| is_fresh(*age));
    match (before, after) {
        (Some((age, sample)), Some((ahead, next))) => {
            Some((sample, next, age as f32 / (age - ahead) as f32))
        }
        (Some((age, sample)), None) => {
            let (oldest, last) = earlier.unwrap_or((age, sample));
            let interval = oldest - age;
            // Not from before an outage, and no further ahead than it goes back.
            if interval > 0 && is_fresh(interval) {
                let ahead = age.min(interval) as f32 / interval as f32;
                Some((last, sample, 1.0 + ahead))
            } else {
                Some((sample, sample, 0.0))
            }
        }
        (None, Some((_, next))) => Some((next, next, 0.0)),
        (None, None) => None,
    }
}

impl History<Compass> {
    /// Degrees a second between the last two samples; 0 if there are none.
    pub fn turn_rate(&self) -> f32 {
        let [Some(now), Some(then), ..] = self.times else {
            return 0.0;
        };
        let [Some(heading), Some(before), ..] = self.values else {
            return 0.0;
        };
        // The times differ.
        1000.0 * before.to(heading).abs() / now.since(then) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> TimeOfDay {
        TimeOfDay::from_nmea(text.as_bytes()).unwrap()
    }

    fn headings(samples: &[(&str, f32)]) -> History<Compass> {
        let mut history = History::EMPTY;
        for (time, degrees) in samples {
            history.push(at(time), Compass(*degrees));
        }
        history
    }

    #[test]
    fn between_beyond_and_beside() {
        let history = headings(&[("100000", 350.0), ("100001", 0.0), ("100002", 20.0)]);
        for (time, degrees) in [
            ("100000.500", Some(355.0)),
            ("100001", Some(0.0)),
            ("100001.250", Some(5.0)),
            // As it turned last, for as long as that was.
            ("100002.500", Some(30.0)),
            ("100003", Some(40.0)),
            ("100004", Some(40.0)),
            ("095959", Some(350.0)),
            ("100004.001", None),
            ("095957", None),
        ] {
            let found = history.at(at(time), 2_000).map(|compass| compass.0);
            assert_eq!(found, degrees, "{time}");
        }
        assert_eq!(history.turn_rate(), 20.0);
    }

    #[test]
    fn an_outage_is_not_bridged() {
        let history = headings(&[("100000", 10.0), ("100100", 90.0)]);
        assert_eq!(history.at(at("100001"), 2_000), Some(Compass(10.0)));
        assert_eq!(history.at(at("100030"), 2_000), None);
        assert_eq!(history.at(at("100059"), 2_000), Some(Compass(90.0)));
        assert_eq!(history.at(at("100101"), 2_000), Some(Compass(90.0)));
    }

    #[test]
    fn a_clock_that_was_set_begins_anew() {
        let history = headings(&[("100000", 10.0), ("090000", 20.0)]);
        assert_eq!(history.at(at("100000"), 2_000), None);
        assert_eq!(history.at(at("090000"), 2_000), Some(Compass(20.0)));
        assert_eq!(history.turn_rate(), 0.0);
        let again = headings(&[("100000", 10.0), ("100000", 30.0)]);
        assert_eq!(again.at(at("100001"), 2_000), Some(Compass(30.0)));
        assert!(History::<Compass>::EMPTY.is_empty());
    }

    #[test]
    fn the_second_sample_of_a_time_replaces_the_first() {
        let history = headings(&[("100000", 0.0), ("100001", 10.0), ("100001", 20.0)]);
        assert_eq!(history.at(at("100000.500"), 2_000), Some(Compass(10.0)));
        assert_eq!(history.at(at("100002"), 2_000), Some(Compass(40.0)));
        assert_eq!(history.turn_rate(), 20.0);
        let newest = history.newest(at("100001.250")).unwrap();
        assert_eq!((newest.value, newest.age_ms), (Compass(20.0), 250));
        assert_eq!(history.newest(at("100000")).unwrap().age_ms, 0);
    }

    #[test]
    fn only_the_last_samples_are_kept() {
        let mut history = History::EMPTY;
        for second in 0..20u16 {
            let time = TimeOfDay::from_epoch(i64::from(second) * 1_000);
            history.push(time, Compass(f32::from(second)));
        }
        assert_eq!(
            history.at(TimeOfDay::from_epoch(12_500), 1_000),
            Some(Compass(12.5))
        );
        assert_eq!(history.at(TimeOfDay::from_epoch(10_000), 1_000), None);
    }

    #[test]
    fn places_over_the_date_line() {
        let place = |longitude| Geodetic::new(481_000_000, longitude).unwrap();
        let east = place(1_799_999_900);
        let west = place(-1_799_999_900);
        assert_eq!(east.towards(west, 0.5).longitude_e7().abs(), 1_800_000_000);
        assert_eq!(east.towards(west, 0.25), place(1_799_999_950));
        assert_eq!(east.towards(west, 1.5), place(-1_799_999_800));
        assert_eq!(west.towards(east, 0.25), place(-1_799_999_950));
        assert_eq!(west.towards(east, 1.5), place(1_799_999_800));
        // Half a turn, the longest way there is, is one way or the other.
        let (zero, opposite) = (place(0), place(1_800_000_000));
        assert_eq!(zero.towards(opposite, 0.5).longitude_e7(), 900_000_000);
        assert_eq!(opposite.towards(zero, 0.5).longitude_e7(), 900_000_000);
    }
}
