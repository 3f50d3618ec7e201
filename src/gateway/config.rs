//! What a vehicle's gateway is told.

use super::formats;
use super::formats::format::Station;
use crate::ConfigError;
use crate::aoa::Observation;
use crate::config::{require, require_all, require_within};

/// Direction from which the angles of bearing lines count that leave it open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum BearingReference {
    /// The bow: the heading of the vehicle is added.
    Relative,
    /// True north: a rotating antenna with a compass of its own, or a fixed station.
    TrueNorth,
}

/// How a [`Vehicle`](super::Vehicle) treats its lines, with the configuration `C` of its locator.
///
/// ```
/// use foxhunt::aoa::clean;
/// use foxhunt::gateway::{BearingReference, Config};
///
/// const CONFIG: Config<clean::Config> = foxhunt::config!(Config {
///     seed: 7,
///     reference: BearingReference::TrueNorth,
///     min_quality: 60.0,
///     ..Config::new(clean::Config::DEFAULT)
/// });
/// assert!((CONFIG.sigma_rad(100.0).to_degrees() - 2.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config<C> {
    /// What the locator is told.
    pub locator: C,
    /// What the formats of lines are told.
    pub formats: formats::Config,
    /// Direction from which the angles of bearing lines count that leave it open: reports of APRS count from true north, and
    /// azimuths of a u-blox [anchor](formats::ublox::Config::anchors) from where it faces, whatever this is.
    pub reference: BearingReference,
    /// Where the direction finders stand and how they head, whatever the lines say; `None` for a vehicle. Bearings that count
    /// from true north are not turned by it.
    pub station: Option<Station>,
    /// Seed of the particles: the same bytes with the same seed give the same reports.
    pub seed: u64,
    /// Quality, 0 to 100, below which a bearing is rejected.
    pub min_quality: f32,
    /// Standard deviation of a bearing of quality 100; that of a lower one is linear in the quality. A format may be told
    /// a [table](super::SigmaTable) of its own.
    pub best_sigma_rad: f32,
    /// Standard deviation of a bearing of quality 0.
    pub worst_sigma_rad: f32,
    /// Longest time between a bearing and its position or heading.
    pub max_age_ms: u32,
    /// How many bearings whose lines state no time are taken at one time of the receiver; the next ones are rejected as
    /// [`StalePosition`](super::Rejected::StalePosition) until it states another.
    ///
    /// This tells a silent receiver without a clock of the gateway's own: it should be what the direction finder says in
    /// [`Self::max_age_ms`].
    pub undated_bearings: u8,
    /// Speed from which the course over ground is the heading.
    pub min_speed_m_s: f32,
    /// Rate of turn of the course, in degrees a second, above which it is not taken for the heading.
    pub max_turn_rate_deg_s: f32,
    /// Speed that the vehicle never exceeds: a position that is further away, or the first one after a start or an outage,
    /// waits for a later one that agrees, and so do bearings that were taken there. Infinity believes every position.
    pub max_speed_m_s: f32,
    /// Variation of magnetic north from true north, in degrees clockwise (east), in place of what sentences state of it;
    /// magnetic headings need one or the other.
    pub variation_deg: Option<f32>,
    /// Shortest time between two reports; 0 reports on every bearing.
    pub report_interval_ms: u32,
}

impl<C> Config<C> {
    const LONGEST_MS: u32 = 3_600_000;

    /// For a car: relative bearings of quality 40 or better, with a standard deviation of 2 to 10 degrees, positions and
    /// headings up to 2 s old or 20 bearings without a time, a course that holds from 1.5 m/s and up to 10 degrees
    /// a second, no more than 100 m/s, a report a second.
    pub const fn new(locator: C) -> Self {
        const DEGREE: f32 = core::f32::consts::PI / 180.0;
        Self {
            locator,
            formats: formats::Config::DEFAULT,
            reference: BearingReference::Relative,
            station: None,
            seed: 1,
            min_quality: 40.0,
            best_sigma_rad: 2.0 * DEGREE,
            worst_sigma_rad: 10.0 * DEGREE,
            max_age_ms: 2_000,
            undated_bearings: 20,
            min_speed_m_s: 1.5,
            max_turn_rate_deg_s: 10.0,
            max_speed_m_s: 100.0,
            variation_deg: None,
            report_interval_ms: 1_000,
        }
    }

    /// Checks all fields but `locator`, whose configuration has a check of its own.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_all!(self.formats);
        if let Some(station) = &self.station {
            require_all!(station);
        }
        require_within!(self: min_quality 0.0..=100.0);
        require!(
            self.best_sigma_rad >= Observation::MIN_SIGMA_RAD,
            "best_sigma_rad must be at least 0.001, as of an observation"
        );
        require!(
            self.worst_sigma_rad >= self.best_sigma_rad
                && self.worst_sigma_rad <= Observation::MAX_SIGMA_RAD,
            "worst_sigma_rad must be from best_sigma_rad to 3.2, as of an observation"
        );
        require!(
            self.max_age_ms <= Self::LONGEST_MS,
            "max_age_ms must be at most an hour"
        );
        require!(
            self.min_speed_m_s >= 0.0 && self.min_speed_m_s <= f32::MAX,
            "min_speed_m_s must be zero or positive, and finite"
        );
        require!(
            self.max_turn_rate_deg_s > 0.0 && self.max_turn_rate_deg_s <= 360.0,
            "max_turn_rate_deg_s must be above 0 and at most 360"
        );
        require!(self.max_speed_m_s > 0.0, "max_speed_m_s must be above zero");
        require!(
            match self.variation_deg {
                Some(degrees) => degrees >= -180.0 && degrees <= 180.0,
                None => true,
            },
            "variation_deg must be from -180 to 180"
        );
        require!(
            self.report_interval_ms <= Self::LONGEST_MS,
            "report_interval_ms must be at most an hour"
        );
        Ok(())
    }

    /// Standard deviation, in radians, of a bearing of this quality (0 to 100) whose format has no table.
    pub const fn sigma_rad(&self, quality: f32) -> f32 {
        let fraction = (100.0 - quality) * 0.01;
        self.best_sigma_rad + (self.worst_sigma_rad - self.best_sigma_rad) * fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::SigmaTable;

    const DEFAULT: Config<()> = Config::new(());

    #[test]
    fn refuses_fields_out_of_range() {
        type Change = fn(&mut Config<()>);
        let changes: [(&str, Change); 13] = [
            ("min_quality", |c| c.min_quality = 101.0),
            ("min_quality", |c| c.min_quality = f32::NAN),
            ("best_sigma_rad", |c| c.best_sigma_rad = 0.0),
            ("worst_sigma_rad", |c| c.worst_sigma_rad = 0.01),
            ("worst_sigma_rad", |c| c.worst_sigma_rad = f32::NAN),
            ("min_speed_m_s", |c| c.min_speed_m_s = -1.0),
            ("max_turn_rate_deg_s", |c| c.max_turn_rate_deg_s = 0.0),
            ("max_speed_m_s", |c| c.max_speed_m_s = f32::NAN),
            ("variation_deg", |c| c.variation_deg = Some(181.0)),
            ("max_age_ms", |c| c.max_age_ms = u32::MAX),
            ("report_interval_ms", |c| c.report_interval_ms = 3_600_001),
            ("frequencies_hz", |c| {
                c.formats.kraken.frequencies_hz = &[1; 256]
            }),
            ("worst_sigma_rad", |c| c.worst_sigma_rad = 4.0),
        ];
        assert_eq!(DEFAULT.check(), Ok(()));
        for (field, change) in changes {
            let mut config = DEFAULT;
            change(&mut config);
            assert_eq!(config.check().unwrap_err().field(), field);
        }
    }

    #[test]
    fn takes_fields_at_the_ends_of_their_ranges() {
        let least = Config {
            min_quality: 0.0,
            best_sigma_rad: 0.001,
            worst_sigma_rad: 0.001,
            max_age_ms: 0,
            min_speed_m_s: 0.0,
            max_turn_rate_deg_s: f32::MIN_POSITIVE,
            max_speed_m_s: f32::MIN_POSITIVE,
            variation_deg: Some(-180.0),
            report_interval_ms: 0,
            ..DEFAULT
        };
        let most = Config {
            min_quality: 100.0,
            best_sigma_rad: 3.2,
            worst_sigma_rad: 3.2,
            max_age_ms: 3_600_000,
            min_speed_m_s: f32::MAX,
            max_turn_rate_deg_s: 360.0,
            max_speed_m_s: f32::INFINITY,
            variation_deg: Some(180.0),
            report_interval_ms: 3_600_000,
            ..DEFAULT
        };
        assert_eq!((least.check(), most.check()), (Ok(()), Ok(())));
        type Change = fn(&mut Config<()>);
        let changes: [(&str, Change); 6] = [
            ("max_age_ms", |c| c.max_age_ms = 3_600_001),
            ("min_speed_m_s", |c| c.min_speed_m_s = f32::INFINITY),
            ("max_turn_rate_deg_s", |c| c.max_turn_rate_deg_s = 360.1),
            ("max_speed_m_s", |c| c.max_speed_m_s = 0.0),
            ("variation_deg", |c| c.variation_deg = Some(-180.1)),
            ("min_quality", |c| c.min_quality = -0.1),
        ];
        for (field, change) in changes {
            let mut config = DEFAULT;
            change(&mut config);
            assert_eq!(config.check().unwrap_err().field(), field);
        }
    }

    #[test]
    fn sigma_is_linear_in_quality() {
        let config = Config {
            best_sigma_rad: 0.1,
            worst_sigma_rad: 0.3,
            ..DEFAULT
        };
        for (quality, sigma) in [(100.0, 0.1), (50.0, 0.2), (0.0, 0.3)] {
            assert!((config.sigma_rad(quality) - sigma).abs() < 1e-6);
        }
        for tenth in 0..=1000 {
            let quality = tenth as f32 * 0.1;
            let linear = SigmaTable::LINEAR.sigma_rad(quality);
            assert!((linear - DEFAULT.sigma_rad(quality)).abs() < 1e-6);
        }
    }
}
