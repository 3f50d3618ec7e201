//! The gateway of a vehicle.

mod snapshot;

use heapless::Vec;

use super::bearing_line::{BearingLine, Pose};
use super::clock::{Clock, TimeOfDay};
use super::history::{Compass, History};
use super::line::{Kind, LineReader};
use super::nmea::{self, Motion, Sentence};
use super::report::{Context, LONG_REPORT, Report, SHORT_REPORT};
use super::sentence::DEGREES;
use super::{BearingReference, Counters, Finder, Rejected, Settings, SkipSpectrum, TakeSpectrum};
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{Answer, Fix, NotObservable};
use crate::aoa::spectrum::Peak;
use crate::aoa::{Alternative, Bearing, Locate, Observation};
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
    /// The host looks for another source: as [`Vehicle::restart`], and [`Vehicle::report`] confirms it.
    Restarted,
    /// A correct sentence that is none of the gateway's: [`Vehicle::line`] has it for others.
    Other,
}

/// Bytes of a receiver and of a direction finder in, fixes out, by the locator `L`. See the [module](super) for the
/// lines it takes and gives.
///
/// ```
/// use foxhunt::aoa::locator::{self, Locator};
/// use foxhunt::gateway::{Event, Rejected, Settings, Vehicle};
///
/// let locator = Locator::<100>::new(locator::Settings::new());
/// let mut vehicle: Vehicle<_> = Vehicle::new(Settings::new(), locator);
/// let mut events = b"%045/7\r\n$PFOXQ*50\r\n".iter().filter_map(|byte| vehicle.push(*byte));
/// assert_eq!(events.next(), Some(Event::Rejected(Rejected::NoPosition)));
/// assert_eq!(events.next(), Some(Event::Queried));
/// drop(events);
/// assert!(vehicle.report().starts_with("$PFOXN,,FEW,0,,*"));
/// ```
///
/// `REPORT` bytes are there for what one line is answered by. The default is enough for one source; a locator with more to
/// say needs [`LONG_REPORT`](super::LONG_REPORT). `S` is what becomes of a KrakenSDR's spectra: [`Vehicle::with_spectrum`].
#[derive(Debug)]
pub struct Vehicle<L, const REPORT: usize = SHORT_REPORT, S = SkipSpectrum> {
    settings: Settings,
    reader: LineReader<S>,
    counters: Counters,
    receiver: Clock,
    finder: Clock,
    places: History<Geodetic>,
    headings: History<Compass>,
    courses: History<Compass>,
    /// Where the direction finder said itself that it was.
    own_place: Option<OwnPlace>,
    plane: Option<LocalPlane>,
    /// Consecutive bearings that are near each other but too far from the origin: where the first was taken,
    /// and how many there are.
    strays: Option<(Geodetic, u8)>,
    locator: L,
    generator: Option<Xoshiro128PlusPlus>,
    /// Bearings that the locator was given since it began anew.
    given: u32,
    /// The last bearing that was used.
    latest: Option<(TimeOfDay, Observation)>,
    /// The time of the bearing that was reported last.
    reported: Option<TimeOfDay>,
    report: Report<REPORT>,
}

/// A place that the direction finder stated, and whether the vehicle had moved when it did.
#[derive(Debug, Clone, Copy)]
struct OwnPlace {
    time: TimeOfDay,
    place: Geodetic,
    moves: bool,
}

impl<L, const REPORT: usize> Vehicle<L, REPORT> {
    /// Knows nothing yet, and nor should the locator. Fit for a `static`.
    pub const fn new(settings: Settings, locator: L) -> Self {
        Self::with_spectrum(settings, locator, SkipSpectrum)
    }
}

impl<L, const REPORT: usize, S> Vehicle<L, REPORT, S> {
    /// The same, for a KrakenSDR whose whole spectrum is to be used: bearings are then the peaks of it.
    ///
    /// ```
    /// use foxhunt::aoa::robust::{RobustLocator, Settings as Robust};
    /// use foxhunt::aoa::spectrum::Temper;
    /// use foxhunt::gateway::{LONG_REPORT, Settings, SpectrumReader, Vehicle};
    ///
    /// let locator = RobustLocator::<256>::new(Robust::default());
    /// let spectrum = SpectrumReader::new(Temper::new(0.2)?);
    /// let vehicle: Vehicle<_, LONG_REPORT, _> = Vehicle::with_spectrum(Settings::new(), locator, spectrum);
    /// # Ok::<(), foxhunt::aoa::spectrum::SpectrumError>(())
    /// ```
    pub const fn with_spectrum(settings: Settings, locator: L, spectrum: S) -> Self {
        Self {
            settings,
            reader: LineReader::new(spectrum),
            counters: Counters::new(),
            receiver: Clock::new(),
            finder: Clock::new(),
            places: History::new(),
            headings: History::new(),
            courses: History::new(),
            own_place: None,
            plane: None,
            strays: None,
            locator,
            generator: None,
            given: 0,
            latest: None,
            reported: None,
            report: Report::new(),
        }
    }
}

impl<L: Locate, const REPORT: usize, S: TakeSpectrum> Vehicle<L, REPORT, S> {
    /// Strays that move the origin: one wild position is not to blind the gateway.
    const STRAYS: u8 = 3;

    /// Forgets the source and the origin, to look for another; keeps the vehicle's own state and the counts.
    pub fn restart(&mut self) {
        self.locator.reset();
        self.plane = None;
        self.strays = None;
        self.generator = None;
        self.given = 0;
        self.latest = None;
        self.reported = None;
        self.report.clear();
    }

    /// Takes the next byte of the line, and says what the line led to if it ends with that byte.
    ///
    /// Never waits. A byte within a line is stored or skipped; the byte that ends a line has it parsed, and
    /// that of a bearing gives the locator one bearing, or the peaks of one spectrum, and writes what it knows.
    pub fn push(&mut self, byte: u8) -> Option<Event> {
        const {
            let needed = if L::DETAILS {
                LONG_REPORT
            } else {
                SHORT_REPORT
            };
            assert!(REPORT >= needed, "reports of this locator are longer");
        }
        let kind = self.reader.push(byte)?;
        self.report.clear();
        self.counters.lines = self.counters.lines.saturating_add(1);
        let result = kind.and_then(|kind| match kind {
            Kind::Nmea => nmea::parse(self.reader.bytes()).and_then(|s| self.sentence(s)),
            Kind::Agrelo | Kind::Kraken | Kind::Ublox => {
                self.bearing_line(kind).and_then(|line| self.bearing(&line))
            }
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

    /// The last line as it came, without its end; of a KrakenSDR's without the spectrum. Holds until the next byte.
    pub fn line(&self) -> &[u8] {
        self.reader.bytes()
    }

    /// What becomes of spectra.
    pub fn spectrum(&self) -> &S {
        self.reader.spectrum()
    }

    /// What became of the lines so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// As given.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The plane of the particles and fixes; its origin is where the first bearing was taken. Unless that was a
    /// wild position: while there is no fix, three bearings in a row that are too far from it but not from each
    /// other [restart](Self::restart) the search, with an origin at the third.
    pub fn plane(&self) -> Option<&LocalPlane> {
        self.plane.as_ref()
    }

    /// The last bearing that was used, in metres and radians of [`Self::plane`].
    pub fn observation(&self) -> Option<Observation> {
        self.latest.map(|(_, observation)| observation)
    }

    /// When that was taken, in milliseconds after midnight UTC.
    pub fn time_ms(&self) -> Option<u32> {
        let (hours, minutes, milliseconds) = self.latest?.0.parts();
        Some((hours * 60 + minutes) * 60_000 + milliseconds)
    }

    /// Where the vehicle was last, by its receiver; by its direction finder, where no receiver has said it.
    pub fn place(&self) -> Option<Geodetic> {
        let own = || self.own_place.map(|own| own.place);
        self.places.newest().or_else(own)
    }

    /// The locator, with its particles and bearings.
    pub fn locator(&self) -> &L {
        &self.locator
    }

    #[inline(never)]
    fn sentence(&mut self, sentence: Sentence) -> Result<Option<Event>, Rejected> {
        match sentence {
            Sentence::Position(time, place, motion) => {
                self.receiver.advance(time)?;
                self.places.push(time, place);
                if let Some(motion) = motion {
                    self.motion(time, motion);
                }
            }
            Sentence::NoFix(time) => {
                if let Some(time) = time {
                    self.receiver.advance(time)?;
                }
                return Err(Rejected::NoFix);
            }
            Sentence::Motion(motion) => {
                let now = self.receiver.now().ok_or(Rejected::NoFix)?;
                self.motion(now, motion);
            }
            Sentence::Heading(degrees) => {
                let now = self.receiver.now().ok_or(Rejected::NoFix)?;
                self.headings.push(now, Compass(degrees));
            }
            Sentence::Query => {
                self.write_answer();
                self.report.counts(&self.counters);
                return Ok(Some(Event::Queried));
            }
            Sentence::Restart => {
                self.restart();
                self.write_answer();
                return Ok(Some(Event::Restarted));
            }
            Sentence::Other => {
                self.counters.ignored = self.counters.ignored.saturating_add(1);
                return Ok(Some(Event::Other));
            }
        }
        self.counters.sentences = self.counters.sentences.saturating_add(1);
        Ok(None)
    }

    #[inline(never)]
    fn bearing_line(&self, kind: Kind) -> Result<BearingLine, Rejected> {
        let finder = self.settings.finder();
        let is = |wanted| finder == Finder::Any || finder == wanted;
        let bytes = self.reader.bytes();
        match kind {
            Kind::Agrelo if is(Finder::Agrelo) => BearingLine::from_agrelo(bytes),
            Kind::Kraken if is(Finder::Kraken) => {
                match BearingLine::from_kraken(bytes, &self.settings) {
                    Ok(_) if S::READS && !self.reader.spectrum().is_valid() => {
                        Err(Rejected::Unparsable)
                    }
                    line => line,
                }
            }
            Kind::Ublox if is(Finder::Ublox) => BearingLine::from_ublox(bytes, &self.settings),
            _ => Err(Rejected::OtherFinder),
        }
    }

    fn motion(&mut self, time: TimeOfDay, motion: Motion) {
        let moves = motion.speed >= self.settings.minimum_speed_m_s();
        match motion.course.filter(|_| moves) {
            Some(degrees) => self.courses.push(time, Compass(degrees)),
            // The course of a vehicle that stands is noise, and what it was before is no longer so.
            None => self.courses.clear(),
        }
    }

    #[inline(never)]
    fn bearing(&mut self, line: &BearingLine) -> Result<Option<Event>, Rejected> {
        if let Some(time) = line.time {
            self.finder.advance(time)?;
        }
        if line.quality < self.settings.minimum_quality() {
            return Err(Rejected::LowQuality);
        }
        let peaks = if S::READS && line.finder == Finder::Kraken {
            self.reader.spectrum().peaks()
        } else {
            None
        };
        if S::READS && matches!(peaks, Some([None, ..])) {
            return Err(Rejected::LowQuality);
        }
        let time = match line.time {
            Some(time) => time.before(line.latency_ms),
            None => self.receiver.lend(self.settings.undated_bearings())?,
        };
        let (place, own_heading) = match line.pose {
            Some(pose) => (pose.place, self.own_heading(time, &pose)),
            None => (self.place_at(time)?, None),
        };
        let heading = match self.settings.reference() {
            BearingReference::TrueNorth => None,
            BearingReference::Relative => {
                Some(own_heading.map_or_else(|| self.heading_at(time), Ok)?)
            }
        };
        let bearing = |degrees: f32| match heading {
            None => Bearing::from_compass_degrees(degrees),
            Some(heading) => Bearing::from_relative_degrees(degrees, heading),
        };
        let plane = self.plane_for(place)?;
        let position = plane.to_local(place).map_err(|_| Rejected::OutOfRange)?;
        let deviation = self.settings.deviation_of_rad(line.finder, line.quality);
        let mut observation = Observation::new(position, bearing(line.degrees), deviation)
            .map_err(|_| Rejected::OutOfRange)?;
        let mut alternatives = Vec::<Alternative, 3>::new();
        if S::READS
            && let Some([Some(best), second, third]) = peaks
        {
            let of = |peak: Peak| {
                let bearing = bearing(-peak.angle * DEGREES);
                let seen = Observation::new(position, bearing, peak.deviation);
                seen.and_then(|seen| Alternative::new(seen, peak.share))
                    .ok()
            };
            let best = of(best).ok_or(Rejected::OutOfRange)?;
            observation = *best.observation();
            for alternative in [second.and_then(of), third.and_then(of), Some(best)] {
                let _ = alternative.map(|one| alternatives.push(one));
            }
        }

        // From here on nothing is rejected.
        if self.plane.is_some_and(|old| old != plane) {
            self.restart();
        }
        let (seconds, newest) = self.elapsed(time);
        let seed = self.settings.seed();
        let generator = self
            .generator
            .get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(seed));
        let answer = if S::READS && !alternatives.is_empty() {
            (self.locator).push_alternatives(&alternatives, seconds, generator)
        } else {
            self.locator.push_after(observation, seconds, generator)
        };
        self.plane = Some(plane);
        self.latest = Some((newest, observation));
        self.given = self.given.saturating_add(1);
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

    /// The plane for a bearing that was taken at `place`: another than before where that was too far away and
    /// nothing has come of it.
    #[inline(never)]
    fn plane_for(&mut self, place: Geodetic) -> Result<LocalPlane, Rejected> {
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

    #[inline(never)]
    fn place_at(&self, time: TimeOfDay) -> Result<Geodetic, Rejected> {
        if self.places.is_empty() {
            return Err(Rejected::NoPosition);
        }
        let place = self.places.at(time, self.settings.maximum_age_ms());
        place.ok_or(Rejected::StalePosition)
    }

    /// Seconds from the newest bearing to one that was taken at `time`, and which of both is the newest then: one that comes
    /// late is as new as those before it.
    #[inline(never)]
    fn elapsed(&self, time: TimeOfDay) -> (f32, TimeOfDay) {
        let Some((newest, _)) = self.latest else {
            return (0.0, time);
        };
        let elapsed = time.since(newest);
        if elapsed < 0 && !self.was_set(elapsed) {
            return (0.0, newest);
        }
        (1e-3 * elapsed.max(0) as f32, time)
    }

    /// Whether so many milliseconds are a way back that a clock was set by: bearings of two clocks may alternate by twice
    /// the age that is fresh.
    fn was_set(&self, elapsed: i32) -> bool {
        elapsed < 0 && elapsed.unsigned_abs() > 2 * self.settings.maximum_age_ms()
    }

    /// What the direction finder takes for the heading, in degrees clockwise from true north: not the course of a vehicle
    /// that has hardly moved, which is judged once a second at most, for its place may be as old.
    #[inline(never)]
    fn own_heading(&mut self, time: TimeOfDay, pose: &Pose) -> Option<f32> {
        /// In milliseconds.
        const SOON: i32 = 1_000;
        let now = |moves| OwnPlace {
            time,
            place: pose.place,
            moves,
        };
        let last = self.own_place.unwrap_or(now(true));
        let elapsed = time.since(last.time);
        let own_place = if elapsed >= SOON {
            let plane = LocalPlane::new(last.place);
            let moved = plane.and_then(|plane| plane.to_local(pose.place));
            let way = self.settings.minimum_speed_m_s() * (1e-3 * elapsed as f32);
            now(moved.map_or(true, |[east, north]| {
                east * east + north * north >= way * way
            }))
        } else if self.was_set(elapsed) {
            now(false)
        } else {
            last
        };
        self.own_place = Some(own_place);
        (!pose.heading_is_course || own_place.moves).then_some(pose.heading)
    }

    /// Degrees clockwise from true north.
    #[inline(never)]
    fn heading_at(&self, time: TimeOfDay) -> Result<f32, Rejected> {
        let age = self.settings.maximum_age_ms();
        if let Some(Compass(degrees)) = self.headings.at(time, age) {
            return Ok(degrees);
        }
        let Compass(degrees) = self.courses.at(time, age).ok_or(Rejected::NoHeading)?;
        // In a bend the bow points elsewhere, and where to has changed since.
        if self.courses.turn_rate() > self.settings.maximum_turn_rate_deg_s() {
            return Err(Rejected::Turning);
        }
        Ok(degrees)
    }

    /// By the time of the bearings; a clock that was set begins anew.
    fn report_is_due(&self, time: TimeOfDay) -> bool {
        self.reported.is_none_or(|reported| {
            let elapsed = time.since(reported);
            match u32::try_from(elapsed) {
                Ok(elapsed) => elapsed >= self.settings.report_interval_ms(),
                Err(_) => self.was_set(elapsed),
            }
        })
    }

    // Called for queries and bearings: once in flash is enough.
    #[inline(never)]
    fn write_answer(&mut self) {
        let context = Context {
            time: self.latest.map(|(time, _)| time),
            bearings: self.given,
            plane: self.plane.as_ref(),
        };
        self.report.answer(&self.locator, context);
    }
}

#[cfg(test)]
mod tests;
