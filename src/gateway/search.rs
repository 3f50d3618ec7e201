//! The search for a source: what is kept across a reset.

use super::clock::TimeOfDay;
use super::config::Config;
use super::navigation::was_set;
use super::outcome::Rejected;
use super::report::Context;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::{Alternative, Answer, Locate, Observation, PushError};
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
    /// Consecutive bearings that are near each other but too far from the origin: where the first was taken, and how many
    /// there are.
    strays: Option<(Geodetic, u8)>,
    /// So many bearings, if they are all, rest on a heading that was none: the next one takes their place.
    pub made_up: u32,
}

crate::persist!(impl[L: Persist] Search<L> as "Search"() {
    locator,
    plane,
    observation,
    newest,
    reported,
    generator,
    bearings,
    strays,
} without { made_up });

impl<L: Locate> Search<L> {
    /// Strays in a row that move the origin: more are slower to leave a wrong first position, fewer let two wrong ones move
    /// it.
    const STRAYS: u8 = 3;

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

    /// The plane for a bearing that was taken at `place`: another than before where that was too far away and there is no
    /// fix.
    #[inline(never)]
    pub fn plane_for(&mut self, place: Geodetic) -> Result<LocalPlane, Rejected> {
        let round = |origin| LocalPlane::new(origin).map_err(|_| Rejected::OutOfRange);
        let Some(plane) = self.plane else {
            return round(place);
        };
        if plane.to_local(place).is_ok() {
            self.strays = None;
            return Ok(plane);
        }
        let is_near = |first| round(first).is_ok_and(|plane| plane.to_local(place).is_ok());
        let (first, count) = match self.strays {
            Some((first, count)) if is_near(first) => (first, count.saturating_add(1)),
            _ => (place, 1),
        };
        self.strays = Some((first, count));
        match self.locator.answer() {
            Answer::NotObservable(_) if count >= Self::STRAYS => round(place),
            _ => Err(Rejected::OutOfRange),
        }
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
