//! The gateway of a vehicle.

use super::bearing_line::BearingLine;
use super::clock::{Clock, TimeOfDay};
use super::line::{Kind, LineReader};
use super::nmea::{self, Motion, Sentence};
use super::report::Report;
use super::{BearingReference, Counters, Rejected, Settings};
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{Answer, Fix, Locator, NotObservable};
use crate::aoa::{Bearing, Observation};
use crate::random::{SeedableRng, Xoshiro128PlusPlus};

/// What a line led to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event {
    /// A bearing was used; the source is here, in metres from [`Vehicle::plane`].
    Fix(Fix),
    /// A bearing was used; it cannot be said yet where the source is.
    NotObservable(NotObservable),
    /// The line was not used.
    Rejected(Rejected),
    /// The host has asked, and [`Vehicle::report`] answers.
    Queried,
}

/// Bytes of a receiver and of a direction finder in, fixes out, with `N` particles and a memory of `B`
/// bearings. See the [module](super) for the lines it takes and gives.
///
/// ```
/// use foxhunt::gateway::{Event, Rejected, Settings, Vehicle};
///
/// let mut vehicle = Vehicle::<100, 64>::new(Settings::default());
/// let mut events = b"%045/7\r\n$PFOXQ*50\r\n".iter().filter_map(|byte| vehicle.push(*byte));
/// assert_eq!(events.next(), Some(Event::Rejected(Rejected::NoPosition)));
/// assert_eq!(events.next(), Some(Event::Queried));
/// drop(events);
/// assert!(vehicle.report().starts_with("$PFOXN,,FEW,0,,*"));
/// ```
#[derive(Debug)]
pub struct Vehicle<const N: usize, const B: usize = 64> {
    settings: Settings,
    reader: LineReader,
    counters: Counters,
    receiver: Clock,
    finder: Clock,
    position: Option<(TimeOfDay, Geodetic)>,
    heading: Option<(TimeOfDay, f32)>,
    course: Option<(TimeOfDay, f32)>,
    plane: Option<LocalPlane>,
    locator: Locator<N, B>,
    generator: Option<Xoshiro128PlusPlus>,
    located: Option<TimeOfDay>,
    reported: Option<TimeOfDay>,
    report: Report,
}

impl<const N: usize, const B: usize> Vehicle<N, B> {
    /// Knows nothing yet. Fit for a `static`.
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            reader: LineReader::new(),
            counters: Counters::new(),
            receiver: Clock::new(),
            finder: Clock::new(),
            position: None,
            heading: None,
            course: None,
            plane: None,
            locator: Locator::new(settings.locator()),
            generator: None,
            located: None,
            reported: None,
            report: Report::new(),
        }
    }

    /// Forgets the source and the origin, to look for another; keeps the vehicle's own state and the counts.
    pub fn restart(&mut self) {
        self.locator.reset();
        self.plane = None;
        self.generator = None;
        self.located = None;
        self.reported = None;
        self.report.clear();
    }

    /// Takes the next byte of the line, and says what the line led to if it ends with that byte.
    ///
    /// Never waits. A byte within a line is stored or skipped; the byte that ends a line has it parsed, and
    /// that of a bearing runs one update of the locator and writes at most two sentences.
    pub fn push(&mut self, byte: u8) -> Option<Event> {
        let kind = self.reader.push(byte)?;
        self.report.clear();
        self.counters.lines = self.counters.lines.saturating_add(1);
        let result =
            kind.and_then(|kind| match kind {
                Kind::Nmea => nmea::parse(self.reader.bytes()).and_then(|s| self.sentence(s)),
                Kind::Agrelo => BearingLine::from_agrelo(self.reader.bytes())
                    .and_then(|line| self.bearing(&line)),
                Kind::Kraken => BearingLine::from_kraken(self.reader.bytes())
                    .and_then(|line| self.bearing(&line)),
            });
        result.unwrap_or_else(|reason| {
            self.counters.reject(reason);
            Some(Event::Rejected(reason))
        })
    }

    /// What to send for the last line: sentences with their line ends, or nothing. Holds until the next line
    /// ends.
    pub fn report(&self) -> &str {
        self.report.as_str()
    }

    /// What became of the lines so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// As given.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The plane of the particles and fixes; its origin is where the first bearing was taken.
    pub fn plane(&self) -> Option<&LocalPlane> {
        self.plane.as_ref()
    }

    /// The locator, with its particles and bearings.
    pub fn locator(&self) -> &Locator<N, B> {
        &self.locator
    }

    fn sentence(&mut self, sentence: Sentence) -> Result<Option<Event>, Rejected> {
        match sentence {
            Sentence::Position(time, place, motion) => {
                self.receiver.advance(time)?;
                self.position = Some((time, place));
                if let Some(motion) = motion {
                    self.motion(motion);
                }
            }
            Sentence::NoFix(time) => {
                if let Some(time) = time {
                    self.receiver.advance(time)?;
                }
                return Err(Rejected::NoFix);
            }
            Sentence::Motion(motion) => self.motion(motion),
            Sentence::Heading(degrees) => {
                self.heading = self.receiver.now().map(|now| (now, degrees));
            }
            Sentence::Query => {
                self.write_answer();
                self.report.status(&self.counters);
                return Ok(Some(Event::Queried));
            }
            Sentence::Other => {
                self.counters.ignored = self.counters.ignored.saturating_add(1);
                return Ok(None);
            }
        }
        self.counters.sentences = self.counters.sentences.saturating_add(1);
        Ok(None)
    }

    fn motion(&mut self, motion: Motion) {
        let moves = motion.speed >= self.settings.minimum_speed_m_s();
        let course = motion.course.filter(|_| moves);
        self.course = self.receiver.now().zip(course);
    }

    fn bearing(&mut self, line: &BearingLine) -> Result<Option<Event>, Rejected> {
        if let Some(time) = line.time {
            self.finder.advance(time)?;
        }
        if line.quality < self.settings.minimum_quality() {
            return Err(Rejected::LowQuality);
        }
        let time = line
            .time
            .or(self.receiver.now())
            .ok_or(Rejected::NoPosition)?;
        let (place, own_heading) = match line.place {
            Some((place, heading)) => (place, Some(heading)),
            None => (self.place_at(time)?, None),
        };
        let bearing = match self.settings.reference() {
            BearingReference::TrueNorth => Bearing::from_compass_degrees(line.degrees),
            BearingReference::Relative => {
                let heading = own_heading.or_else(|| self.heading_at(time));
                let heading = heading.ok_or(Rejected::NoHeading)?;
                Bearing::from_relative_degrees(line.degrees, heading)
            }
        };
        let plane = match self.plane {
            Some(plane) => plane,
            None => LocalPlane::new(place).map_err(|_| Rejected::OutOfRange)?,
        };
        let position = plane.to_local(place).map_err(|_| Rejected::OutOfRange)?;
        let deviation = self.settings.deviation_rad(line.quality);
        let observation =
            Observation::new(position, bearing, deviation).map_err(|_| Rejected::OutOfRange)?;

        // From here on nothing is rejected.
        let seed = self.settings.seed();
        let generator = self
            .generator
            .get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(seed));
        let answer = self.locator.push(observation, generator);
        self.plane = Some(plane);
        self.located = Some(time);
        self.counters.bearings = self.counters.bearings.saturating_add(1);
        if self.report_is_due(time) {
            self.reported = Some(time);
            self.write_answer();
        }
        Ok(Some(match answer {
            Answer::Fix(fix) => Event::Fix(fix),
            Answer::NotObservable(reason) => Event::NotObservable(reason),
        }))
    }

    fn place_at(&self, time: TimeOfDay) -> Result<Geodetic, Rejected> {
        let (taken, place) = self.position.ok_or(Rejected::NoPosition)?;
        if self.is_fresh(taken, time) {
            Ok(place)
        } else {
            Err(Rejected::StalePosition)
        }
    }

    /// Degrees clockwise from true north.
    fn heading_at(&self, time: TimeOfDay) -> Option<f32> {
        let fresh = |entry: &(TimeOfDay, f32)| self.is_fresh(entry.0, time);
        let heading = self.heading.filter(fresh).or(self.course.filter(fresh));
        heading.map(|(_, degrees)| degrees)
    }

    fn is_fresh(&self, taken: TimeOfDay, time: TimeOfDay) -> bool {
        time.since(taken).unsigned_abs() <= self.settings.maximum_age_ms()
    }

    /// Also when the time has jumped back, by which a wild time of the last report does no harm.
    fn report_is_due(&self, time: TimeOfDay) -> bool {
        let interval = self.settings.report_interval_ms();
        self.reported.is_none_or(|reported| {
            u32::try_from(time.since(reported)).map_or(true, |elapsed| elapsed >= interval)
        })
    }

    // Called for queries and bearings: once in flash is enough.
    #[inline(never)]
    fn write_answer(&mut self) {
        match self.locator.answer() {
            Answer::Fix(fix) => self.report.fix(self.located, &fix, self.plane.as_ref()),
            Answer::NotObservable(reason) => {
                self.report
                    .not_observable(self.located, reason, self.counters.bearings);
            }
        }
    }
}
