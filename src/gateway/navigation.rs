//! Where the vehicle is and how it heads, as its receiver and its direction finder state it.

use super::clock::{Clock, TimeOfDay};
use super::config::{BearingReference, Config};
use super::formats::format::{Heading, Motion, Reading, Reference, Sentence, Statement};
use super::history::{Aged, Compass, History};
use super::outcome::Rejected;
use super::sentence::turned;
use crate::aoa::Bearing;
use crate::aoa::geodesy::{Geodetic, LocalPlane};

/// What the navigation receiver has stated last.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Receiver {
    /// Its time, in milliseconds after midnight UTC; `None` before it has stated any.
    pub time_ms: Option<u32>,
    /// Where the vehicle was.
    pub place: Option<Aged<Geodetic>>,
    /// Course over ground, in degrees clockwise from true north; `None` while the vehicle is slower than
    /// [`Config::min_speed_m_s`].
    pub course_deg: Option<Aged<f32>>,
    /// Speed over ground, in metres per second.
    pub speed_m_s: Option<Aged<f32>>,
    /// True heading of the bow, in degrees clockwise from north.
    pub heading_deg: Option<Aged<f32>>,
}

/// Samples of the receiver, and the last place that the direction finder stated.
#[derive(Debug)]
pub(super) struct Navigation {
    clock: Clock,
    /// The last sentence that should have stated a time was refused: what follows without a time has none.
    is_lost: bool,
    /// The last place that was stated, believed or not.
    heard: Option<(TimeOfDay, Geodetic)>,
    /// Milliseconds between the last two such places; 0 if they are of one time.
    heard_every: i32,
    places: History<Geodetic>,
    headings: History<Compass>,
    courses: History<Compass>,
    speed: Option<(TimeOfDay, f32)>,
    /// Of magnetic north from true north, as stated last, in degrees clockwise.
    variation: Option<f32>,
    /// The last place that the direction finder has stated.
    own_place: Option<Geodetic>,
}

/// How the bearings of a line become directions on the map.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub time: TimeOfDay,
    /// Lines without a time that were taken at this time before.
    pub lent: u8,
    pub place: Geodetic,
    /// Whether the place is the vehicle's, which moves no faster than it can, and not that of one of several stations.
    pub is_vehicle: bool,
    /// Heading that is added to a bearing, in degrees; `None` where bearings count from north.
    heading: Option<f32>,
}

impl Frame {
    /// The direction of an angle in degrees clockwise.
    pub fn bearing(&self, degrees: f32) -> Bearing {
        match self.heading {
            None => Bearing::from_compass_degrees(degrees),
            Some(heading) => Bearing::from_relative_degrees(degrees, heading),
        }
    }
}

/// Whether so many milliseconds are a way back that a clock was set by: bearings of two clocks may alternate by twice the
/// age that is fresh.
pub(super) fn was_set(elapsed_ms: i32, max_age_ms: u32) -> bool {
    elapsed_ms < 0 && elapsed_ms.unsigned_abs() > 2 * max_age_ms
}

/// Metres that positions of a receiver may jump by: more lets wrong ones pass, less has right ones wait among houses.
const POSITION_NOISE_M: f32 = 50.0;

/// How far a vehicle of a speed may seem to have got in so many milliseconds, or have come from, in metres.
#[inline(never)]
pub(super) fn reach_m(elapsed_ms: i32, max_speed_m_s: f32) -> f32 {
    // No speed limits that of no time, either.
    let reach = POSITION_NOISE_M + max_speed_m_s * (1e-3 * elapsed_ms.unsigned_abs() as f32);
    reach.min(LocalPlane::MAX_RANGE_M)
}

impl Navigation {
    pub const EMPTY: Self = Self {
        clock: Clock::EMPTY,
        is_lost: false,
        heard: None,
        heard_every: 0,
        places: History::EMPTY,
        headings: History::EMPTY,
        courses: History::EMPTY,
        speed: None,
        variation: None,
        own_place: None,
    };

    /// What the receiver has stated last.
    pub fn receiver(&self) -> Receiver {
        let now = self.clock.now();
        let degrees = |history: &History<Compass>| {
            let Aged {
                value: Compass(value),
                age_ms,
            } = history.newest(now?)?;
            Some(Aged { value, age_ms })
        };
        Receiver {
            time_ms: now.map(TimeOfDay::milliseconds),
            place: now.and_then(|now| self.places.newest(now)),
            course_deg: degrees(&self.courses),
            speed_m_s: self.speed.and_then(|(time, value)| {
                let age_ms = now?.since(time).max(0).unsigned_abs();
                Some(Aged { value, age_ms })
            }),
            heading_deg: degrees(&self.headings),
        }
    }

    /// The last place: by the direction finder, where no receiver has said it.
    pub fn place(&self) -> Option<Geodetic> {
        let stated = self.receiver().place.map(|place| place.value);
        stated.or(self.own_place)
    }

    /// Takes what the receiver says.
    #[inline(never)]
    pub fn sentence<C>(&mut self, sentence: Sentence, config: &Config<C>) -> Result<(), Rejected> {
        match sentence {
            Sentence::Statement(stated) => self.statement(&stated, config),
            Sentence::NoFix(Some(time)) => {
                self.advance(time)?;
                Err(Rejected::NoFix)
            }
            Sentence::Lost(reason) => {
                self.is_lost = true;
                Err(reason)
            }
            _ => Err(Rejected::NoFix),
        }
    }

    fn advance(&mut self, time: TimeOfDay) -> Result<(), Rejected> {
        let advanced = self.clock.advance(time);
        self.is_lost = advanced.is_err();
        advanced
    }

    fn statement<C>(&mut self, stated: &Statement, config: &Config<C>) -> Result<(), Rejected> {
        let time = match stated.time {
            Some(time) => {
                if let Some(place) = stated.place {
                    self.confirm((time, place), config)?;
                }
                self.advance(time)?;
                time
            }
            None if self.is_lost => return Err(Rejected::NoFix),
            None => self.clock.now().ok_or(Rejected::NoFix)?,
        };
        if let Some(place) = stated.place {
            self.places.push(time, place);
        }
        self.variation = stated.variation.or(self.variation);
        if let Some(motion) = stated.motion {
            self.motion(time, motion, config.min_speed_m_s);
        }
        if let Some(heading) = stated.heading {
            let degrees = self.true_heading(heading, config.variation_deg)?;
            self.headings.push(time, Compass(degrees));
        }
        Ok(())
    }

    /// Whether a place is to be believed: the vehicle can have got there from the last one believed, if that is no older than
    /// a bearing's may be, or from the last one stated, if that is of another time. Otherwise it waits for the next.
    #[inline(never)]
    fn confirm<C>(
        &mut self,
        (time, place): (TimeOfDay, Geodetic),
        config: &Config<C>,
    ) -> Result<(), Rejected> {
        if config.max_speed_m_s == f32::INFINITY {
            return Ok(());
        }
        let is_near = |(then, there): (TimeOfDay, Geodetic), longest_ms: i32| {
            let elapsed = time.since(then);
            let way = reach_m(elapsed, config.max_speed_m_s);
            (0..=longest_ms).contains(&elapsed) && there.is_within(place, way)
        };
        let longest_ms = config.max_age_ms as i32;
        let is_believed = self
            .places
            .last()
            .is_some_and(|last| is_near(last, longest_ms));
        let heard = self.heard.replace((time, place));
        let before = self.heard_every;
        self.heard_every = heard.map_or(0, |(then, _)| time.since(then));
        // A receiver may be slower than bearings ask for.
        let confirming = heard.filter(|heard| {
            self.heard_every > 0 && is_near(*heard, longest_ms.max(before.saturating_mul(2)))
        });
        match (is_believed, confirming) {
            (true, _) => {}
            (false, Some((then, there))) => {
                // What was before is not on the way to here.
                self.places.clear();
                self.places.push(then, there);
            }
            (false, None) => {
                self.is_lost = true;
                return Err(Rejected::Unconfirmed);
            }
        }
        Ok(())
    }

    /// Degrees clockwise from true north, within 0 and 360, by the variation that the configuration tells, or that was stated
    /// last.
    fn true_heading(&self, heading: Heading, told: Option<f32>) -> Result<f32, Rejected> {
        if !heading.is_magnetic {
            return Ok(heading.degrees);
        }
        let variation = told.or(self.variation).ok_or(Rejected::NoVariation)?;
        Ok(turned(heading.degrees + variation))
    }

    fn motion(&mut self, time: TimeOfDay, motion: Motion, min_speed_m_s: f32) {
        self.speed = Some((time, motion.speed));
        let moves = motion.speed >= min_speed_m_s;
        match motion.course.filter(|_| moves) {
            Some(degrees) => self.courses.push(time, Compass(degrees)),
            // The course of a vehicle that stands is noise, and what it was before is no longer so.
            None => self.courses.clear(),
        }
    }

    /// When and where a bearing was taken, and how the vehicle headed then.
    #[inline(never)]
    pub fn frame<C>(&mut self, reading: &Reading, config: &Config<C>) -> Result<Frame, Rejected> {
        let (time, lent) = match reading.time {
            Some(time) => (time.before(reading.latency_ms), 0),
            None => self.clock.lend(config.undated_bearings)?,
        };
        let place = match (&config.station, reading.place) {
            (Some(station), _) => station.place,
            (None, Some(place)) => {
                self.own_place = Some(place);
                place
            }
            (None, None) => self.place_at(time, config.max_age_ms)?,
        };
        let heading = match (reading.reference, config.reference) {
            (Reference::North, _) | (Reference::Told(_), BearingReference::TrueNorth) => None,
            (Reference::Bow(own) | Reference::Told(own), _) => {
                let told = config.station.map(|station| station.heading_deg).or(own);
                Some(told.map_or_else(|| self.heading_at(time, config), Ok)?)
            }
        };
        let is_of_one = reading.station.is_none() && reading.reference != Reference::North;
        Ok(Frame {
            time,
            lent,
            place,
            is_vehicle: config.station.is_none() && is_of_one,
            heading,
        })
    }

    #[inline(never)]
    fn place_at(&self, time: TimeOfDay, max_age_ms: u32) -> Result<Geodetic, Rejected> {
        if self.places.is_empty() {
            return Err(Rejected::NoPosition);
        }
        let place = self.places.at(time, max_age_ms);
        place.ok_or(Rejected::StalePosition)
    }

    /// Heading by the receiver, in degrees clockwise from true north.
    fn heading_at<C>(&self, time: TimeOfDay, config: &Config<C>) -> Result<f32, Rejected> {
        if let Some(Compass(degrees)) = self.headings.at(time, config.max_age_ms) {
            return Ok(degrees);
        }
        let course = self.courses.at(time, config.max_age_ms);
        let Compass(degrees) = course.ok_or(Rejected::NoHeading)?;
        // In a bend the bow points elsewhere, and where to has changed since.
        if self.courses.turn_rate() > config.max_turn_rate_deg_s {
            return Err(Rejected::Turning);
        }
        Ok(degrees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> TimeOfDay {
        TimeOfDay::from_nmea(text.as_bytes()).unwrap()
    }

    /// What the course says at the last time, after two of a second apart at a speed.
    fn heading(courses: [f32; 2], speed: f32) -> Result<f32, Rejected> {
        let mut navigation = Navigation::EMPTY;
        for (time, degrees) in ["120000", "120001"].into_iter().zip(courses) {
            let course = Some(degrees);
            navigation.motion(at(time), Motion { course, speed }, 1.5);
        }
        navigation.heading_at(at("120001"), &Config::new(()))
    }

    #[test]
    fn a_course_is_the_heading_of_who_drives_and_does_not_turn() {
        assert_eq!(heading([350.0, 0.0], 5.0), Ok(0.0));
        assert_eq!(heading([350.0, 0.5], 5.0), Err(Rejected::Turning));
        assert_eq!(heading([5.0, 355.0], 1.5), Ok(355.0));
        assert_eq!(heading([5.0, 5.0], 1.4), Err(Rejected::NoHeading));
    }

    #[test]
    fn a_vehicle_reaches_what_its_speed_allows_and_some_noise() {
        assert_eq!(reach_m(1_000, 100.0), 150.0);
        assert_eq!(reach_m(-2_000, 10.0), 70.0);
        assert_eq!(reach_m(0, 10.0), 50.0);
        for (elapsed_ms, speed) in [(3_600_000, 100.0), (1, f32::INFINITY), (0, f32::INFINITY)] {
            assert_eq!(reach_m(elapsed_ms, speed), LocalPlane::MAX_RANGE_M);
        }
    }

    #[test]
    fn only_a_way_back_beyond_twice_the_age_is_a_clock_that_was_set() {
        for (elapsed_ms, expected) in [(-2_001, true), (-2_000, false), (-1_100, false)] {
            assert_eq!(was_set(elapsed_ms, 1_000), expected, "{elapsed_ms}");
        }
        assert!(!was_set(5_000, 1_000));
        assert!(was_set(i32::MIN, 1_000));
    }
}
