//! Lines of a KrakenSDR, in its app format.
//!
//! Fields are separated by commas and blanks; the line ends with a blank and LF. Read from the sources of its software:
//! krakenrf/krakensdr_doa (`kraken_sdr_signal_processor.py`) and krakenrf/krakensdr_suite (`doa_logger.cpp`,
//! `music_processor.cpp`).
//!
//! | field | unit | what is made of it |
//! |---|---|---|
//! | time | milliseconds since 1970, 13 digits | the end of the interval that the reading was taken over |
//! | bearing | degrees from the bow, either way round | see [`Sense`]; any turn, so -30 is 330 |
//! | confidence | maximum over mean of the spectrum, on either scale | see [`Confidence`] |
//! | power | decibels | nothing |
//! | frequency | hertz | see [`Config::frequencies_hz`] |
//! | array | `UCA`, `ULA`, `Custom` | nothing |
//! | latency | milliseconds | the length of that interval: the reading belongs to its middle |
//! | station | any text, with commas and quotes | nothing |
//! | latitude, longitude | degrees | the place, unless both are zero or one is `None` or `nan` |
//! | GPS heading, compass heading | degrees clockwise from north, any turn | the heading, unless it is `None` or `nan` |
//! | which of them | `GPS` or `Compass` | see [`Heading`] |
//! | four times `R` | | nothing |
//! | 360 values | decibels over the least, counter-clockwise from the bow, a degree apart | the sense, the width, whether it is new; by `Kraken<Spectrum>`, the bearings |
//!
//! Numbers are as Python writes them: `-5e-05`, `433920000.0`. Builds differ:
//!
//! | build | sense of the bearing | confidence | latency | headings | |
//! |---|---|---|---|---|---|
//! | krakensdr_doa until May 2023 | clockwise, whole degrees | decibels | 100 or the interval | one, twice, by label `GPS` | [`Config::DOA_2022`] |
//! | until July 2024; branches `wideband`, `development` | counter-clockwise | decibels | the interval | the same | [`Config::DOA_2023`] |
//! | since then | clockwise | decibels | the interval | the same | [`Config::DOA_2024`] |
//! | krakensdr_suite | clockwise, whole degrees | a fraction | 0 | of both | [`Config::SUITE_2026`] |

mod line;
mod spectrum;

use super::format::{Format, Layout, Ray, Reading, Reference, Sense, Sentence, channel_of};
use crate::ConfigError;
use crate::aoa::spectrum::Spectrum;
use crate::config::{require, require_within};
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{columns, half_turned};
use crate::gateway::sigma::{SigmaTable, preset};
pub use line::{Confidence, Heading};
use line::{Fields, Own};
pub(super) use spectrum::Kept;
use spectrum::{Digest, SpectrumReader};

pub(super) const EXAMPLE: &str = "1756823719250, 297.0, 7.35, -32.5, 433920000, UCA, 437, fox-1, \
    52.2296756, -21.0122287, 12.5, 12.5, GPS, R, R, R, R";

/// The CSV line of the app format. Of its spectrum only is kept what tells of the whole: where its maximum is, how wide
/// it is, and whether it is another than before. A line whose spectrum is cut or malformed counts as one without, whose
/// sense may not be known.
///
/// `Kraken<Spectrum>` keeps the whole [`Spectrum`], in 800 bytes: a bearing is what the peaks are, each with its
/// probability and standard deviation, in place of the one that the line states. A locator that takes no alternatives has
/// the largest alone. A line with more or fewer than 360 values or with one that is no such number, or above
/// [`Spectrum::MAX_DECIBELS`], is [`Rejected::Unparsable`]; one without a peak, flat or as good as flat, is
/// [`Rejected::LowQuality`].
#[derive(Debug)]
pub struct Kraken<S = ()> {
    spectrum: S,
    reader: SpectrumReader,
    /// Lines that tell that bearings are clockwise, less those that tell that they are not.
    votes: i8,
    /// Hashes of the last spectra, and when each came first, in milliseconds after midnight.
    seen: [(u32, u32); 4],
    /// Counts them.
    next: u8,
    own: Own,
}

impl Kraken<Spectrum> {
    /// The spectrum of the last line, if [whole](Spectrum::is_whole).
    pub const fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }
}

/// What the format is told. The default recognises what a line leaves open from the lines themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config {
    /// Direction in which bearings grow. `None` compares them with the maxima of their spectra, which are
    /// counter-clockwise in every build; a reading of which it cannot be told yet is two bearings that exclude each other.
    pub sense: Option<Sense>,
    /// Scale of the confidence, for lines without a whole spectrum. `None` takes up to 1 for a fraction and what is above
    /// for decibels.
    pub confidence: Option<Confidence>,
    /// The interval that a reading is taken over, in place of the latency that the line states: krakensdr_suite states 0.
    pub interval_ms: Option<u32>,
    /// Which heading holds, and when.
    pub heading: Heading,
    /// The frequencies of the sources: a KrakenSDR with several channels sends a line for each, and those of another
    /// frequency are rejected as [`Rejected::OtherFrequency`]. Each is a [channel](crate::aoa::Observation::channel) of its
    /// own, from 1 on. Without any, lines of every frequency are taken for those of one source.
    pub frequencies_hz: &'static [u32],
    /// Standard deviations by the quality, which is how far the maximum of the spectrum is above its mean, in percent of
    /// the maximum: 0 of a flat one, 99.7 of a needle. `None` takes those of [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
    /// The power to which a [spectrum](crate::aoa::spectrum) is raised for the probabilities of its peaks: 0.001 to 10.
    pub temper: f32,
}

impl Config {
    /// Recognises the build; every frequency.
    pub const DEFAULT: Self = Self {
        sense: None,
        confidence: None,
        interval_ms: None,
        heading: Heading::Recognised,
        frequencies_hz: &[],
        sigmas: Some(&SIGMAS),
        temper: 0.5,
    };

    /// krakensdr_doa of May 2022 to May 2023.
    pub const DOA_2022: Self = Self {
        sense: Some(Sense::Clockwise),
        confidence: Some(Confidence::Decibels),
        ..Self::DEFAULT
    };

    /// krakensdr_doa of May 2023 to July 2024, and its branches `wideband` and `development`.
    pub const DOA_2023: Self = Self {
        sense: Some(Sense::CounterClockwise),
        ..Self::DOA_2022
    };

    /// krakensdr_doa since July 2024.
    pub const DOA_2024: Self = Self::DOA_2022;

    /// krakensdr_suite, which reads for about half a second.
    pub const SUITE_2026: Self = Self {
        confidence: Some(Confidence::Fraction),
        ..Self::DOA_2022
    };

    /// Checks all fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(
            self.frequencies_hz.len() < 256,
            "frequencies_hz must be at most 255"
        );
        let mut rest = self.frequencies_hz;
        while let [frequency, others @ ..] = rest {
            require!(*frequency > 0, "frequencies_hz must be above zero");
            rest = others;
        }
        require!(
            !matches!(self.interval_ms, Some(60_001..)),
            "interval_ms must be at most a minute"
        );
        require_within!(self: temper 0.001..=10.0);
        Ok(())
    }
}

/// By simulations of a circle of five antennas, 0.2 to 0.42 wavelengths in radius, of 10 to 30 dB, with one reflection of
/// 0.2 to 0.6 from anywhere: the standard deviations that hold 95 % of the errors of MUSIC, Capon and Bartlett within
/// 1.96 of them. No less than 2 degrees, as nothing on a car is better.
pub const SIGMAS: SigmaTable = preset(&[
    (50.0, 8.5),
    (68.0, 7.5),
    (80.0, 7.0),
    (90.0, 6.0),
    (95.8, 4.5),
    (98.0, 3.0),
    (99.7, 2.0),
]);

/// Whether the line that begins with these bytes has come to the name of its station, which may be anything.
fn is_in_station(line: &[u8], _byte: u8) -> bool {
    let commas = line.iter().filter(|byte| **byte == b',').count();
    commas == 7 && columns(line).is_some_and(|[time]| time.iter().all(u8::is_ascii_digit))
}

impl<S: Kept> Kraken<S> {
    /// The reading of a line whose spectrum has ended.
    #[inline(never)]
    fn reading(&mut self, line: &[u8], config: &Config) -> Result<Reading, Rejected> {
        let fields = Fields::of(line).ok_or(Rejected::Unparsable)?;
        let channel = if config.frequencies_hz.is_empty() {
            0
        } else {
            let own = fields.frequency_hz()?;
            own.and_then(|own| channel_of(own, config.frequencies_hz))
                .ok_or(Rejected::OtherFrequency)?
        };
        let time = fields.time()?;
        let stated = fields.bearing()?;
        let interval_ms = config.interval_ms.map_or_else(|| fields.latency_ms(), Ok)?;
        let digest = self.reader.digest().copied();
        let quality = match &digest {
            Some(digest) => 100.0 - digest.width * (100.0 / 360.0),
            None => fields.quality(config.confidence)?,
        };
        let pose = fields.pose(time, config.heading, &mut self.own)?;
        if digest.is_some_and(|digest| self.repeats(digest.hash, time)) {
            return Err(Rejected::Frozen);
        }
        let clockwise = match config.sense {
            Some(Sense::Clockwise) => 1.0,
            Some(Sense::CounterClockwise) => 0.0,
            None => self.clockwise(stated, digest.as_ref()),
        };
        let mut reading = Reading::new(stated, quality.max(0.0), config.sigmas)?;
        reading.channel = channel;
        reading.time = Some(time);
        reading.latency_ms = interval_ms / 2;
        reading.place = pose.map(|(place, _)| place);
        reading.reference = Reference::Told(pose.and_then(|(_, heading)| heading));
        reading.retracted = self.own.retracted();
        either_way(&mut reading, clockwise);
        Ok(reading)
    }

    /// Whether this spectrum came at another time before.
    fn repeats(&mut self, hash: u32, time: TimeOfDay) -> bool {
        let time_ms = time.milliseconds();
        for (known, first_ms) in &self.seen {
            if *known == hash {
                return *first_ms != time_ms;
            }
        }
        if let Some(oldest) = self.seen.get_mut(usize::from(self.next & 3)) {
            *oldest = (hash, time_ms);
        }
        self.next = self.next.wrapping_add(1);
        false
    }

    /// The probability that a bearing of so many degrees counts clockwise, by its own spectrum and those before.
    fn clockwise(&mut self, stated: f32, digest: Option<&Digest>) -> f32 {
        /// So many lines outweigh all before: fewer follow a few damaged ones, more keep a wrong sense for longer.
        const MOST: i8 = 4;
        let vote = digest.map_or(0, |digest| vote(stated, f32::from(digest.top)));
        self.votes = (self.votes + vote).clamp(-MOST, MOST);
        let votes = if vote == 0 {
            self.votes
        } else if vote * self.votes > 0 {
            // This line is sure of it.
            MOST * vote
        } else {
            // Those before told otherwise.
            self.votes.signum()
        };
        // Most builds in use are clockwise.
        (0.6 + 0.3 * f32::from(votes)).clamp(0.0, 1.0)
    }
}

/// Whether a bearing is the maximum of its spectrum, at so many degrees counter-clockwise, when it is taken for clockwise
/// (1) or when it is not (-1); 0 if either or neither.
fn vote(stated: f32, top: f32) -> i8 {
    /// A bearing and the maximum are of one grid; some builds cut what others round, or interpolate.
    const NEAR: f32 = 4.0;
    const FAR: f32 = 12.0;
    let (otherwise, clockwise) = (from_ahead(stated - top), from_ahead(stated + top));
    let is_told = |one: f32, other: f32| i8::from(one <= NEAR && other >= FAR);
    is_told(clockwise, otherwise) - is_told(otherwise, clockwise)
}

/// Degrees between ahead and a direction.
fn from_ahead(degrees: f32) -> f32 {
    half_turned(degrees).abs()
}

/// Makes the bearing of a reading two, of which one counts clockwise, with this probability.
fn either_way(reading: &mut Reading, clockwise: f32) {
    /// Degrees between two bearings that are one: there either sense is as good.
    const ONE: f32 = 20.0;
    let best = &mut reading.best;
    let mut other = Ray {
        degrees: 360.0 - best.degrees,
        probability: 1.0 - clockwise,
        ..*best
    };
    best.probability = clockwise;
    if clockwise < 0.5 {
        core::mem::swap(best, &mut other);
    }
    let turn = from_ahead(best.degrees - other.degrees);
    if turn > ONE && other.probability > 0.0 {
        reading.others = [Some(other), None];
    } else {
        let more = other.probability * turn.to_radians();
        best.sigma_rad = best.sigma_rad.map(|sigma| sigma + more);
        best.probability = 1.0;
    }
}

impl<S: Kept> Format for Kraken<S> {
    type Config = Config;
    const DEFAULT: Config = Config::DEFAULT;
    /// Lines hold the name of a station, with whatever is in it.
    const LAYOUT: Layout = Layout {
        longest: 8_192,
        fields: 17,
        begins: |byte| byte.is_ascii_digit(),
        continues: |byte| byte.is_ascii_digit(),
        holds: is_in_station,
        ..Layout::TEXT
    };
    const EMPTY: Self = Self {
        spectrum: S::EMPTY,
        reader: SpectrumReader::EMPTY,
        votes: 0,
        seen: [(0, 0); 4],
        next: 0,
        own: Own::EMPTY,
    };

    fn begin(&mut self) {
        self.reader.begin();
        self.spectrum.begin();
    }

    fn rest(&mut self, byte: u8) {
        if let Some(level) = self.reader.take(byte) {
            self.spectrum.take(level);
        }
    }

    fn parse(&mut self, line: &[u8], config: &Config) -> Result<Sentence, Rejected> {
        if let Some(level) = self.reader.finish() {
            self.spectrum.take(level);
        }
        let mut reading = self.reading(line, config)?;
        let is_whole = self.reader.digest().is_some();
        self.spectrum.read(&mut reading, is_whole, config.temper)?;
        Ok(Sentence::Reading(reading))
    }
}

#[cfg(test)]
mod tests;
