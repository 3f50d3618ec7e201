//! How a gateway behaves.

use core::fmt;

use super::DeviationTable;
use crate::aoa::Observation;

/// What the angles of bearing lines count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum BearingReference {
    /// The bow: the heading of the vehicle is added.
    #[default]
    Relative,
    /// True north: a rotating antenna with a compass of its own, or a fixed station.
    TrueNorth,
}

/// Which way the angles of a direction finder grow: builds of the KrakenSDR differ, and so do mountings of a u-blox
/// board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Sense {
    /// As those of a compass.
    #[default]
    Clockwise,
    /// As mathematical angles.
    CounterClockwise,
}

/// Which direction finder is on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Finder {
    /// Whichever: no two begin their lines alike.
    #[default]
    Any,
    /// `%BBB/Q`
    Agrelo,
    /// A KrakenSDR.
    Kraken,
    /// A u-blox board.
    Ublox,
}

/// What the confidence of a KrakenSDR is: its builds differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum KrakenConfidence {
    /// 0 to 100, taken as the quality.
    #[default]
    Percent,
    /// The maximum of the spectrum over its mean, in decibels. The most that its 360 values allow, 25.6, is
    /// taken as quality 100 and 0 as quality 0, so that a minimum quality of 40 asks for 10.2.
    Decibels,
}

/// What the quality of a u-blox board's bearing is, which states none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum UbloxQuality {
    /// 100, always.
    #[default]
    Best,
    /// 100 straight ahead of the board, 0 at a right angle: a flat array sees the worse the further from there.
    Azimuth,
}

/// How a [`super::Vehicle`] treats its lines.
///
/// ```
/// use foxhunt::gateway::{BearingReference, Settings};
///
/// const SETTINGS: Settings = Settings::new().with_seed(7).with_reference(BearingReference::TrueNorth);
/// let strict = SETTINGS.with_minimum_quality(60.0)?;
/// assert!((strict.deviation_rad(100.0).to_degrees() - 2.0).abs() < 1e-4);
/// # Ok::<(), foxhunt::gateway::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    seed: u64,
    reference: BearingReference,
    sense: Sense,
    kraken_confidence: KrakenConfidence,
    kraken_frequency_hz: Option<u32>,
    ublox_tag: Option<u64>,
    ublox_quality: UbloxQuality,
    finder: Finder,
    minimum_quality: f32,
    best_deviation_rad: f32,
    worst_deviation_rad: f32,
    agrelo_table: Option<&'static DeviationTable>,
    kraken_table: Option<&'static DeviationTable>,
    ublox_table: Option<&'static DeviationTable>,
    maximum_age_ms: u32,
    undated_bearings: u8,
    minimum_speed_m_s: f32,
    maximum_turn_rate_deg_s: f32,
    report_interval_ms: u32,
}

/// Which of the [`Settings`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `minimum_quality` is not within 0 and 100.
    MinimumQuality,
    /// A deviation is out of the range of [`Observation::new`], or the best is larger than the worst.
    Deviation,
    /// `minimum_speed_m_s` is negative or not finite.
    MinimumSpeed,
    /// `maximum_turn_rate_deg_s` is not within 0 and 360.
    TurnRate,
    /// `maximum_age_ms` or `report_interval_ms` is longer than an hour.
    Duration,
    /// `kraken_frequency_hz` is 0.
    Frequency,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::MinimumQuality => "minimum quality is not within 0 and 100",
            Self::Deviation => "deviation is out of range, or the best is larger than the worst",
            Self::MinimumSpeed => "minimum speed is negative or not finite",
            Self::TurnRate => "maximum turn rate is not within 0 and 360",
            Self::Duration => "duration is longer than an hour",
            Self::Frequency => "frequency is 0",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}

impl Settings {
    const LONGEST_MS: u32 = 3_600_000;

    /// For a car: relative bearings of quality 40 or better, 2 to 10 degrees of deviation, positions and
    /// headings up to 2 s old or 20 bearings without a time, a course that holds from 1.5 m/s and up to 10 degrees
    /// a second, a report a second.
    pub const fn new() -> Self {
        const RADIANS: f32 = core::f32::consts::PI / 180.0;
        Self {
            seed: 1,
            reference: BearingReference::Relative,
            sense: Sense::Clockwise,
            kraken_confidence: KrakenConfidence::Percent,
            kraken_frequency_hz: None,
            ublox_tag: None,
            ublox_quality: UbloxQuality::Best,
            finder: Finder::Any,
            minimum_quality: 40.0,
            best_deviation_rad: 2.0 * RADIANS,
            worst_deviation_rad: 10.0 * RADIANS,
            agrelo_table: None,
            kraken_table: None,
            ublox_table: None,
            maximum_age_ms: 2_000,
            undated_bearings: 20,
            minimum_speed_m_s: 1.5,
            maximum_turn_rate_deg_s: 10.0,
            report_interval_ms: 1_000,
        }
    }

    /// Seeds the particles; the same bytes with the same seed give the same reports. Initially 1.
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// What the angles of bearing lines count from.
    pub const fn with_reference(mut self, reference: BearingReference) -> Self {
        self.reference = reference;
        self
    }

    /// Which way the angles of a KrakenSDR or a u-blox board grow. Initially clockwise.
    pub const fn with_sense(mut self, sense: Sense) -> Self {
        self.sense = sense;
        self
    }

    /// What the confidence of a KrakenSDR is. Initially in percent.
    pub const fn with_kraken_confidence(mut self, confidence: KrakenConfidence) -> Self {
        self.kraken_confidence = confidence;
        self
    }

    /// The frequency, in hertz, of the source: a KrakenSDR with several channels sends a line for each, and
    /// those of another frequency are rejected as [`super::Rejected::OtherFrequency`]. Initially lines of every
    /// frequency are used.
    ///
    /// # Errors
    /// [`SettingsError::Frequency`] if it is 0.
    pub const fn with_kraken_frequency_hz(mut self, frequency: u32) -> Result<Self, SettingsError> {
        if frequency == 0 {
            return Err(SettingsError::Frequency);
        }
        self.kraken_frequency_hz = Some(frequency);
        Ok(self)
    }

    /// The tag that is looked for: a u-blox board reports all that it hears, and lines of others are rejected as
    /// [`super::Rejected::OtherTag`]. Initially every tag is taken for the source.
    pub const fn with_ublox_tag(mut self, tag: u64) -> Self {
        self.ublox_tag = Some(tag);
        self
    }

    /// What the quality of a u-blox board's bearing is. Initially the best.
    pub const fn with_ublox_quality(mut self, quality: UbloxQuality) -> Self {
        self.ublox_quality = quality;
        self
    }

    /// The direction finder: lines of others are rejected as [`super::Rejected::OtherFinder`]. Initially any.
    pub const fn with_finder(mut self, finder: Finder) -> Self {
        self.finder = finder;
        self
    }

    /// The quality, 0 to 100, below which a bearing is rejected.
    ///
    /// # Errors
    /// [`SettingsError::MinimumQuality`] outside that range.
    pub const fn with_minimum_quality(mut self, quality: f32) -> Result<Self, SettingsError> {
        if !(quality >= 0.0 && quality <= 100.0) {
            return Err(SettingsError::MinimumQuality);
        }
        self.minimum_quality = quality;
        Ok(self)
    }

    /// The standard deviation, in radians, of a bearing of quality 100 and of one of quality 0; between
    /// them it is linear in the quality.
    ///
    /// # Errors
    /// [`SettingsError::Deviation`] if one is not fit for an [`Observation`], or `best` above `worst`.
    pub const fn with_deviations(mut self, best: f32, worst: f32) -> Result<Self, SettingsError> {
        let ordered = best >= Observation::MIN_DEVIATION_RAD && worst >= best;
        if !(ordered && worst <= Observation::MAX_DEVIATION_RAD) {
            return Err(SettingsError::Deviation);
        }
        self.best_deviation_rad = best;
        self.worst_deviation_rad = worst;
        Ok(self)
    }

    /// The standard deviations of the bearings of a finder, in place of those of [`Self::with_deviations`].
    /// [`Finder::Any`] sets it for all. Initially there is none.
    pub const fn with_deviation_table(
        mut self,
        finder: Finder,
        table: &'static DeviationTable,
    ) -> Self {
        if matches!(finder, Finder::Any | Finder::Agrelo) {
            self.agrelo_table = Some(table);
        }
        if matches!(finder, Finder::Any | Finder::Kraken) {
            self.kraken_table = Some(table);
        }
        if matches!(finder, Finder::Any | Finder::Ublox) {
            self.ublox_table = Some(table);
        }
        self
    }

    /// How far apart in time, in milliseconds, a bearing and its position or heading may be.
    ///
    /// # Errors
    /// [`SettingsError::Duration`] above an hour.
    pub const fn with_maximum_age_ms(mut self, age: u32) -> Result<Self, SettingsError> {
        if age > Self::LONGEST_MS {
            return Err(SettingsError::Duration);
        }
        self.maximum_age_ms = age;
        Ok(self)
    }

    /// How many bearings whose lines state no time are taken at one time of the receiver; the next ones are
    /// rejected as [`super::Rejected::StalePosition`] until it states another.
    ///
    /// This tells a silent receiver without a clock of the gateway's own: it should be what the direction
    /// finder says in [`Self::maximum_age_ms`]. Initially 20.
    pub const fn with_undated_bearings(mut self, bearings: u8) -> Self {
        self.undated_bearings = bearings;
        self
    }

    /// The speed, in metres per second, from which the course over ground is the heading.
    ///
    /// # Errors
    /// [`SettingsError::MinimumSpeed`] if negative or not finite.
    pub const fn with_minimum_speed_m_s(mut self, speed: f32) -> Result<Self, SettingsError> {
        if !(speed >= 0.0 && speed <= f32::MAX) {
            return Err(SettingsError::MinimumSpeed);
        }
        self.minimum_speed_m_s = speed;
        Ok(self)
    }

    /// The rate of turn of the course, in degrees a second, above which it is not taken for the heading.
    ///
    /// # Errors
    /// [`SettingsError::TurnRate`] when it is not within 0 and 360.
    pub const fn with_maximum_turn_rate_deg_s(mut self, rate: f32) -> Result<Self, SettingsError> {
        if !(rate > 0.0 && rate <= 360.0) {
            return Err(SettingsError::TurnRate);
        }
        self.maximum_turn_rate_deg_s = rate;
        Ok(self)
    }

    /// The shortest time, in milliseconds, between two reports; 0 reports on every bearing.
    ///
    /// # Errors
    /// [`SettingsError::Duration`] above an hour.
    pub const fn with_report_interval_ms(mut self, interval: u32) -> Result<Self, SettingsError> {
        if interval > Self::LONGEST_MS {
            return Err(SettingsError::Duration);
        }
        self.report_interval_ms = interval;
        Ok(self)
    }

    /// See [`Self::with_seed`].
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// See [`Self::with_reference`].
    pub const fn reference(&self) -> BearingReference {
        self.reference
    }

    /// See [`Self::with_sense`].
    pub const fn sense(&self) -> Sense {
        self.sense
    }

    /// See [`Self::with_kraken_confidence`].
    pub const fn kraken_confidence(&self) -> KrakenConfidence {
        self.kraken_confidence
    }

    /// See [`Self::with_kraken_frequency_hz`].
    pub const fn kraken_frequency_hz(&self) -> Option<u32> {
        self.kraken_frequency_hz
    }

    /// See [`Self::with_ublox_tag`].
    pub const fn ublox_tag(&self) -> Option<u64> {
        self.ublox_tag
    }

    /// See [`Self::with_finder`].
    pub const fn finder(&self) -> Finder {
        self.finder
    }

    /// See [`Self::with_minimum_quality`].
    pub const fn minimum_quality(&self) -> f32 {
        self.minimum_quality
    }

    /// See [`Self::with_ublox_quality`].
    pub const fn ublox_quality(&self) -> UbloxQuality {
        self.ublox_quality
    }

    /// Standard deviation, in radians, of a finder's bearing of this quality (0 to 100): by its table, if it has one,
    /// else [`Self::deviation_rad`].
    pub fn deviation_of_rad(&self, finder: Finder, quality: f32) -> f32 {
        let table = match finder {
            Finder::Any => None,
            Finder::Agrelo => self.agrelo_table,
            Finder::Kraken => self.kraken_table,
            Finder::Ublox => self.ublox_table,
        };
        table.map_or_else(
            || self.deviation_rad(quality),
            |table| table.deviation_rad(quality),
        )
    }

    /// Standard deviation, in radians, of a bearing of this quality (0 to 100), without a table.
    pub const fn deviation_rad(&self, quality: f32) -> f32 {
        let share = (100.0 - quality) * 0.01;
        self.best_deviation_rad + (self.worst_deviation_rad - self.best_deviation_rad) * share
    }

    /// See [`Self::with_maximum_age_ms`].
    pub const fn maximum_age_ms(&self) -> u32 {
        self.maximum_age_ms
    }

    /// See [`Self::with_undated_bearings`].
    pub const fn undated_bearings(&self) -> u8 {
        self.undated_bearings
    }

    /// See [`Self::with_minimum_speed_m_s`].
    pub const fn minimum_speed_m_s(&self) -> f32 {
        self.minimum_speed_m_s
    }

    /// See [`Self::with_maximum_turn_rate_deg_s`].
    pub const fn maximum_turn_rate_deg_s(&self) -> f32 {
        self.maximum_turn_rate_deg_s
    }

    /// See [`Self::with_report_interval_ms`].
    pub const fn report_interval_ms(&self) -> u32 {
        self.report_interval_ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused() {
        let settings = Settings::default();
        assert_eq!(
            settings.with_minimum_quality(101.0).err(),
            Some(SettingsError::MinimumQuality)
        );
        assert_eq!(
            settings.with_minimum_quality(f32::NAN).err(),
            Some(SettingsError::MinimumQuality)
        );
        assert_eq!(
            settings.with_deviations(0.2, 0.1).err(),
            Some(SettingsError::Deviation)
        );
        assert_eq!(
            settings.with_deviations(0.0, 0.1).err(),
            Some(SettingsError::Deviation)
        );
        assert_eq!(
            settings.with_deviations(0.1, f32::NAN).err(),
            Some(SettingsError::Deviation)
        );
        assert_eq!(
            settings.with_minimum_speed_m_s(-1.0).err(),
            Some(SettingsError::MinimumSpeed)
        );
        assert_eq!(
            settings.with_maximum_age_ms(u32::MAX).err(),
            Some(SettingsError::Duration)
        );
        assert_eq!(
            settings.with_report_interval_ms(3_600_001).err(),
            Some(SettingsError::Duration)
        );
        assert_eq!(
            settings.with_kraken_frequency_hz(0).err(),
            Some(SettingsError::Frequency)
        );
    }

    #[test]
    fn a_table_is_that_of_its_finder() {
        let settings = Settings::default();
        let finders = [Finder::Agrelo, Finder::Kraken, Finder::Ublox];
        for finder in finders {
            let with = settings.with_deviation_table(finder, &DeviationTable::AGRELO);
            for other in finders {
                let table = if other == finder {
                    DeviationTable::AGRELO.deviation_rad(50.0)
                } else {
                    settings.deviation_rad(50.0)
                };
                assert_eq!(with.deviation_of_rad(other, 50.0), table);
            }
        }
        let all = settings.with_deviation_table(Finder::Any, &DeviationTable::AGRELO);
        let deviations = finders.map(|finder| all.deviation_of_rad(finder, 60.0));
        assert_eq!(deviations, [DeviationTable::AGRELO.deviation_rad(60.0); 3]);
    }

    #[test]
    fn deviation_is_linear_in_quality() {
        let settings = Settings::default().with_deviations(0.1, 0.3).unwrap();
        for (quality, deviation) in [(100.0, 0.1), (50.0, 0.2), (0.0, 0.3)] {
            assert!((settings.deviation_rad(quality) - deviation).abs() < 1e-6);
        }
    }
}
