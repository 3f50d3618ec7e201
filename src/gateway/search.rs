//! The search for a source: what is kept across a reset.

use super::clock::TimeOfDay;
use super::config::Config;
use super::navigation::{Frame, reach_m, was_set};
use super::outcome::Rejected;
use super::report::Context;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::{Alternative, Answer, Locate, Observation, PushError};
use crate::math::sqrt;
use crate::random::{SeedableRng, Xoshiro128PlusPlus};
use crate::snapshot::Persist;

/// A locator with the plane that it works in and the time that it counts by.
#[derive(Debug)]
pub(super) struct Search<L> {
    pub locator: L,
    pub plane: Option<LocalPlane>,
    /// The last bearing that was used.
    pub observation: Option<Observation>,
    /// Time of the newest bearing: of the day, and as the locator counts it.
    newest: Option<(TimeOfDay, u32)>,
    /// Time of the bearing that was reported last.
    reported: Option<TimeOfDay>,
    generator: Option<Xoshiro128PlusPlus>,
    /// Bearings that were used.
    bearings: u32,
    strays: Option<Strays>,
    /// So many bearings, if they are all, rest on a heading that was none: the next one takes their place.
    pub made_up: u32,
}

/// Consecutive bearings from places that the vehicle can have got to from each other, but not from where it was before, or
/// that are too far from the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Strays {
    /// When the first was taken.
    since: TimeOfDay,
    /// When and where the last was.
    time: TimeOfDay,
    place: Geodetic,
    count: u8,
}

crate::persist!(impl[L: Persist] Search<L> as "Search"() {
    locator,
    plane,
    observation,
    newest,
    reported,
    generator,
    bearings,
} without { strays, made_up });

impl<L: Locate> Search<L> {
    /// Strays in a row that begin another search: more are slower to leave a wrong first position, fewer let two wrong ones
    /// move the origin.
    const STRAYS: u8 = 3;

    /// How long they must have lasted if there is a fix: longer keeps a wrong fix, shorter lets a receiver's lapse cost a
    /// right one.
    const LAPSE_MS: i32 = 20_000;

    pub const EMPTY: Self = Self {
        locator: L::EMPTY,
        plane: None,
        observation: None,
        newest: None,
        reported: None,
        generator: None,
        bearings: 0,
        strays: None,
        made_up: 0,
    };

    /// Forgets the source and the origin.
    pub fn restart(&mut self) {
        self.locator.reset();
        self.plane = None;
        self.observation = None;
        self.newest = None;
        self.reported = None;
        self.generator = None;
        self.bearings = 0;
        self.strays = None;
        self.made_up = 0;
    }

    /// Time of the newest bearing, of the day.
    pub fn time(&self) -> Option<TimeOfDay> {
        Some(self.newest?.0)
    }

    /// What a report is about.
    pub fn context(&self) -> Context<'_> {
        Context {
            time: self.time(),
            bearings: self.bearings,
            plane: self.plane.as_ref(),
        }
    }

    /// The plane for a bearing by a station: another than before where the vehicle has long been elsewhere than it can have
    /// got to.
    #[inline(never)]
    pub fn plane_for(
        &mut self,
        frame: &Frame,
        station: u8,
        config: &Config<L::Config>,
    ) -> Result<LocalPlane, Rejected> {
        let (time, place) = (frame.time, frame.place);
        let round = || LocalPlane::new(place).map_err(|_| Rejected::OutOfRange);
        let Some(plane) = self.plane else {
            return round();
        };
        let strays = self.strays.filter(|last| {
            let reach = reach_m(time.since(last.time), config.max_speed_m_s);
            last.place.is_within(place, reach)
        });
        let reason = match plane.to_local(place) {
            Err(_) => Rejected::OutOfRange,
            Ok(here) if self.is_stray(here, frame, station, strays, config) => {
                Rejected::Unconfirmed
            }
            Ok(_) => {
                self.strays = None;
                return Ok(plane);
            }
        };
        let (since, before) = strays.map_or((time, 0), |last| (last.since, last.count));
        let count = before.saturating_add(1);
        self.strays = Some(Strays {
            since,
            time,
            place,
            count,
        });
        let is_lapse = self.locator.fix().is_some() && time.since(since) < Self::LAPSE_MS;
        if count < Self::STRAYS || is_lapse {
            return Err(reason);
        }
        round()
    }

    /// Whether the vehicle cannot have got here from where the station's last bearing was taken, or is nearer to where
    /// strays led that it can come from.
    fn is_stray(
        &self,
        here: [f32; 2],
        frame: &Frame,
        station: u8,
        strays: Option<Strays>,
        config: &Config<L::Config>,
    ) -> bool {
        let last = self.observation.filter(|last| last.station() == station);
        let (true, Some(last), Some((newest, _))) = (frame.is_vehicle, last, self.newest) else {
            return false;
        };
        let [x, y] = last.position();
        let [east, north] = [here[0] - x, here[1] - y];
        let way = sqrt(east * east + north * north);
        way > reach_m(frame.time.since(newest), config.max_speed_m_s)
            || strays.is_some_and(|last| last.place.is_within(frame.place, way))
    }

    /// A time of day as the locator counts it: milliseconds that run on over midnight, and one on where a clock was set
    /// back.
    #[inline(never)]
    pub fn time_ms(&self, time: TimeOfDay, max_age_ms: u32) -> u32 {
        let Some((newest, newest_ms)) = self.newest else {
            return time.milliseconds();
        };
        let elapsed = time.since(newest);
        let elapsed = if was_set(elapsed, max_age_ms) {
            1
        } else {
            elapsed
        };
        newest_ms.wrapping_add_signed(elapsed)
    }

    /// Gives the locator bearings that exclude each other, of which `best` is the most probable and the last, taken at `time` in a `plane`. Another
    /// plane than before begins a new search.
    pub fn push(
        &mut self,
        (time, plane): (TimeOfDay, LocalPlane),
        best: &Observation,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
    ) -> Result<Answer, Rejected> {
        let time_ms = self.time_ms(time, config.max_age_ms);
        let are_made_up = self.made_up > 0 && self.made_up == self.bearings;
        if are_made_up || self.plane.is_some_and(|old| old != plane) {
            self.restart();
        }
        let generator = self
            .generator
            .get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(config.seed));
        let (locator, config_of) = (&mut self.locator, &config.locator);
        let answer = if L::ALTERNATIVES {
            locator.push_alternatives(alternatives, config_of, generator)
        } else {
            locator.push(best, config_of, generator)
        };
        let answer = answer.map_err(|error| match error {
            PushError::TooOld => Rejected::TooOld,
            PushError::Duplicate => Rejected::Duplicate,
            PushError::Empty => Rejected::LowQuality,
        })?;
        let is_late = self.newest.is_some_and(|(newest, _)| {
            let elapsed = time.since(newest);
            elapsed < 0 && !was_set(elapsed, config.max_age_ms)
        });
        if !is_late {
            self.newest = Some((time, time_ms));
        }
        self.plane = Some(plane);
        self.observation = Some(*best);
        self.bearings = self.bearings.saturating_add(1);
        Ok(answer)
    }

    /// Whether a bearing of this time is to be reported, which it then is. A clock that was set begins anew.
    pub fn is_due(&mut self, time: TimeOfDay, config: &Config<L::Config>) -> bool {
        let is_due = self.reported.is_none_or(|reported| {
            let elapsed = time.since(reported);
            match u32::try_from(elapsed) {
                Ok(elapsed) => elapsed >= config.report_interval_ms,
                Err(_) => was_set(elapsed, config.max_age_ms),
            }
        });
        if is_due {
            self.reported = Some(time);
        }
        is_due
    }
}
