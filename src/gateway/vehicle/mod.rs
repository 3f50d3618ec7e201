//! The gateway of a vehicle.

use heapless::Vec;

use super::clock::{Clock, TimeOfDay};
use super::config::Config;
use super::formats::format::{Ray, Reading, Sentence};
use super::formats::{All, Formats};
use super::line::LineReader;
use super::navigation::{Navigation, Receiver};
use super::outcome::{Counters, Event, Rejected};
use super::record::BearingRecord;
use super::report::{ReportForm, ShortReport};
use super::search::Search;
use crate::ConfigError;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::{Alternative, Answer, Locate, Observation};
use crate::snapshot::{self, Error, Persist};

/// The state of a vehicle's gateway: bytes of receivers and direction finders in on numbered ports, fixes out, by the
/// locator `L`. See the [module](super) for the lines that it takes and gives.
///
/// `F` is the set of formats that it reads, `R` the form of its reports, `PORTS` how many lines come in. A state holds no
/// configuration, and an empty one is all zero bits: in firmware, it is a `static` that takes no flash, and the
/// configuration a `const`. [`Gateway`] holds both, for short programs.
///
/// ```
/// use foxhunt::aoa::{Clean, clean};
/// use foxhunt::gateway::{Config, Event, Rejected, Vehicle};
///
/// const CONFIG: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
/// let mut vehicle: Vehicle<Clean<100>> = Vehicle::EMPTY;
/// let mut events = b"%045/7\r\n$PFOXQ*50\r\n".iter().filter_map(|byte| vehicle.push(0, *byte, &CONFIG));
/// assert_eq!(events.next(), Some(Event::Rejected(Rejected::NoPosition)));
/// assert_eq!(events.next(), Some(Event::Queried));
/// drop(events);
/// assert!(vehicle.report().starts_with("$PFOXN,,FEW,0,,*"));
/// ```
#[derive(Debug)]
pub struct Vehicle<L, F = All, R = ShortReport, const PORTS: usize = 1> {
    ports: [Port<F>; PORTS],
    counters: Counters,
    navigation: Navigation,
    search: Search<L>,
    report: R,
}

/// Where the bytes of one receiver or direction finder come in.
#[derive(Debug)]
struct Port<F> {
    line: LineReader<F>,
    counters: Counters,
    /// The clock of its direction finder.
    clock: Clock,
}

// Where the vehicle is and how it heads is left out: by the time of a restore it is old, and the next sentences of the
// receiver tell it.
crate::persist!(
    impl[L: Persist, F, R, const PORTS: usize] Vehicle<L, F, R, PORTS> as "Vehicle"()
    { search, counters } without { ports, navigation, report }
);

impl<L: Locate, F: Formats, R: ReportForm, const PORTS: usize> Vehicle<L, F, R, PORTS> {
    /// Nothing is known. All bits are zero.
    pub const EMPTY: Self = Self {
        ports: [const {
            Port {
                line: LineReader::EMPTY,
                counters: Counters::EMPTY,
                clock: Clock::EMPTY,
            }
        }; PORTS],
        counters: Counters::EMPTY,
        navigation: Navigation::EMPTY,
        search: Search::EMPTY,
        report: R::EMPTY,
    };

    /// Forgets the source and the origin, to look for another; keeps the vehicle's own state and the counts.
    pub fn restart(&mut self) {
        self.search.restart();
        self.report.clear();
    }

    /// Takes the next byte of a port, and says what the line led to if one ends with that byte; `None` in the middle of a
    /// line, and for a port that there is not.
    ///
    /// Never waits. A byte within a line is stored or skipped; the byte that ends a line has it parsed, and
    /// that of a bearing gives the locator one bearing, or the peaks of one spectrum, and writes what it knows.
    pub fn push(&mut self, port: usize, byte: u8, config: &Config<L::Config>) -> Option<Event> {
        let line = &mut self.ports.get_mut(port)?.line;
        let ended = line.push(byte)?;
        self.report.clear();
        let event = ended
            .and_then(|()| line.parse(&config.formats))
            .and_then(|sentence| self.take(port, sentence, config))
            .unwrap_or_else(Event::Rejected);
        self.count(port, &event);
        match event {
            Event::Queried => {
                self.write_answer(config);
                self.report.status(&self.counters);
            }
            Event::Restarted => self.write_answer(config),
            _ => {}
        }
        Some(event)
    }

    /// Takes a bearing of a port that did not come as a line; says what it led to, as a line of it would have.
    pub fn push_record(
        &mut self,
        port: usize,
        record: &BearingRecord,
        config: &Config<L::Config>,
    ) -> Event {
        self.report.clear();
        let event = record
            .reading()
            .and_then(|reading| self.reading(port, &reading, config))
            .unwrap_or_else(Event::Rejected);
        self.count(port, &event);
        event
    }

    fn count(&mut self, port: usize, event: &Event) {
        self.counters.count(event);
        if let Some(port) = self.ports.get_mut(port) {
            port.counters.count(event);
        }
    }

    /// What to send for the last line: sentences with their line ends, or nothing. Holds until the next line
    /// ends.
    pub fn report(&self) -> &str {
        self.report.as_str()
    }

    /// The last line of a port as it came, without its end; of a KrakenSDR's without the spectrum. Holds until the next
    /// byte.
    pub fn line(&self, port: usize) -> &[u8] {
        let port = self.ports.get(port);
        port.map_or(&[], |port| port.line.bytes())
    }

    /// What the formats of a port keep beside its line, such as a [spectrum](super::formats::Kraken).
    pub fn formats(&self, port: usize) -> Option<&F> {
        Some(self.ports.get(port)?.line.formats())
    }

    /// What became of the lines so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// What became of the lines of one port since the start: which of several receivers is ill, and of what.
    pub fn port_counters(&self, port: usize) -> Option<&Counters> {
        Some(&self.ports.get(port)?.counters)
    }

    /// The plane of the particles and fixes; its origin is where the first bearing was taken. Unless that was a wrong
    /// position: three bearings in a row, all taken where the vehicle cannot have got to from where it was before (or too
    /// far from the origin), but from each other, [restart](Self::restart) the search, with an origin at the third; once
    /// there is a fix, only if they go on for 20 s.
    pub fn plane(&self) -> Option<&LocalPlane> {
        self.search.plane.as_ref()
    }

    /// The last bearing that was used, in metres and radians of [`Self::plane`].
    pub fn observation(&self) -> Option<Observation> {
        self.search.observation
    }

    /// The time of the newest bearing, in milliseconds after midnight UTC.
    pub fn time_ms(&self) -> Option<u32> {
        self.search.time().map(TimeOfDay::milliseconds)
    }

    /// What the navigation receiver has stated last.
    pub fn receiver(&self) -> Receiver {
        self.navigation.receiver()
    }

    /// Where the vehicle was last, by its receiver; by its direction finder, where no receiver has said it.
    pub fn place(&self) -> Option<Geodetic> {
        self.navigation.place()
    }

    /// The locator, with its particles and bearings.
    pub fn locator(&self) -> &L {
        &self.search.locator
    }

    /// The same, to take bearings back: see [`Locate::retract`].
    pub const fn locator_mut(&mut self) -> &mut L {
        &mut self.search.locator
    }

    fn take(
        &mut self,
        port: usize,
        sentence: Sentence,
        config: &Config<L::Config>,
    ) -> Result<Event, Rejected> {
        Ok(match sentence {
            Sentence::Reading(reading) => return self.reading(port, &reading, config),
            Sentence::Query => Event::Queried,
            Sentence::Restart => {
                self.restart();
                Event::Restarted
            }
            Sentence::Other => Event::Other,
            of_receiver => {
                self.navigation.sentence(of_receiver, config)?;
                Event::Used
            }
        })
    }

    #[inline(never)]
    fn reading(
        &mut self,
        port: usize,
        reading: &Reading,
        config: &Config<L::Config>,
    ) -> Result<Event, Rejected> {
        let of = self.ports.get_mut(port).ok_or(Rejected::Unparsable)?;
        if let Some(time) = reading.time {
            of.clock.advance(time)?;
        }
        if reading.quality < config.min_quality {
            return Err(Rejected::LowQuality);
        }
        if reading.retracted > 0 {
            self.search.made_up = reading.retracted;
        }
        let frame = self.navigation.frame(reading, config)?;
        let station = reading.station.unwrap_or(port as u8);
        let plane = self.search.plane_for(&frame, station, config)?;
        let position = plane
            .to_local(frame.place)
            .map_err(|_| Rejected::OutOfRange)?;
        let time_ms = self.search.time_ms(frame.time, config.max_age_ms);
        // No two undated bearings are of one time.
        let time_ms = time_ms.wrapping_add(u32::from(frame.lent));
        let heading = frame.bearing(0.0);
        let observe = |ray: &Ray| {
            let sigma_rad = (ray.sigma_rad).unwrap_or_else(|| config.sigma_rad(reading.quality));
            Observation::new(time_ms, position, frame.bearing(ray.degrees), sigma_rad)
                .map(|observation| observation.from_station(station))
                .map(|one| match L::CHANNELS {
                    true => one.on_channel(reading.channel),
                    false => one,
                })
                // Only who weighs alternatives knows biases by direction.
                .map(|one| match L::ALTERNATIVES {
                    true => one.with_heading(heading),
                    false => one,
                })
                .map_err(|_| Rejected::OutOfRange)
        };
        let best = observe(&reading.best)?;
        let mut alternatives: Vec<Alternative, 3> = Vec::new();
        if L::ALTERNATIVES {
            let others = reading.others.iter().flatten();
            for ray in others.chain([&reading.best]) {
                let alternative = Alternative::new(observe(ray)?, ray.probability);
                let _ = alternatives.push(alternative.map_err(|_| Rejected::OutOfRange)?);
            }
        }
        let at = (frame.time, plane);
        let answer = self.search.push(at, &best, &alternatives, config)?;
        if self.search.is_due(frame.time, config) {
            self.write_answer(config);
        }
        Ok(match answer {
            Answer::Fix(fix) => Event::Fix(fix),
            Answer::NotObservable(reason) => Event::NotObservable(reason),
        })
    }

    // Called for queries and bearings: once in flash is enough.
    #[inline(never)]
    fn write_answer(&mut self, config: &Config<L::Config>) {
        let search = &self.search;
        self.report
            .answer(&search.locator, &config.locator, search.context());
    }
}

impl<L: Locate + Persist, F: Formats, R: ReportForm, const PORTS: usize> Vehicle<L, F, R, PORTS> {
    /// Writes all that is known of the source to the front of `buffer`, and returns that part of it: see
    /// [`snapshot::save`] and, for the size, [`snapshot::largest`].
    ///
    /// # Errors
    /// [`Error::BufferTooSmall`].
    pub fn snapshot<'b>(&self, buffer: &'b mut [u8]) -> Result<&'b [u8], Error> {
        snapshot::save(self, buffer)
    }

    /// Goes on with the source of the [`snapshot`](Self::snapshot) at the front of `bytes`, as if it had known all along
    /// what that holds. What the vehicle's own gateway has heard of the receiver since it was started stays.
    ///
    /// Times are of the day, so it is up to the caller that a snapshot is not of another hunt.
    ///
    /// # Errors
    /// As [`snapshot::restore`]; nothing has changed then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        snapshot::restore(self, bytes)
    }
}

/// A vehicle's gateway with its configuration, for short programs.
///
/// ```
/// use foxhunt::aoa::{Clean, clean};
/// use foxhunt::gateway::{Config, Gateway};
///
/// let mut gateway: Gateway<Clean<100>> = Gateway::new(Config::new(clean::Config::DEFAULT))?;
/// for byte in b"$PFOXQ*50\r\n" {
///     if gateway.push(0, *byte).is_some() {
///         print!("{}", gateway.vehicle().report());
///     }
/// }
/// # Ok::<(), foxhunt::ConfigError>(())
/// ```
#[derive(Debug)]
pub struct Gateway<L: Locate, F = All, R = ShortReport, const PORTS: usize = 1> {
    config: Config<L::Config>,
    vehicle: Vehicle<L, F, R, PORTS>,
}

impl<L: Locate, F: Formats, R: ReportForm, const PORTS: usize> Gateway<L, F, R, PORTS> {
    /// A gateway that knows nothing yet.
    ///
    /// # Errors
    /// Names the field of the configuration that is out of range.
    pub fn new(config: Config<L::Config>) -> Result<Self, ConfigError> {
        config.check()?;
        L::check(&config.locator)?;
        Ok(Self {
            config,
            vehicle: Vehicle::EMPTY,
        })
    }

    /// See [`Vehicle::push`].
    pub fn push(&mut self, port: usize, byte: u8) -> Option<Event> {
        self.vehicle.push(port, byte, &self.config)
    }

    /// The state, with reports, counts and the locator.
    pub const fn vehicle(&self) -> &Vehicle<L, F, R, PORTS> {
        &self.vehicle
    }

    /// The state, to restart or restore it.
    pub const fn vehicle_mut(&mut self) -> &mut Vehicle<L, F, R, PORTS> {
        &mut self.vehicle
    }

    /// The configuration.
    pub const fn config(&self) -> &Config<L::Config> {
        &self.config
    }
}

#[cfg(test)]
mod tests;
