//! How readings are compared with a map.

use crate::ConfigError;
use crate::config::{require, require_within};
use crate::math::ln;

/// How readings are compared with a map.
///
/// ```
/// use foxhunt::fingerprint::Config;
///
/// const CONFIG: Config = foxhunt::config!(Config {
///     missing_beacons_count: true,
///     ..Config::DEFAULT
/// });
/// let wrong = Config { tempering: 0.0, ..CONFIG };
/// assert_eq!(wrong.check().unwrap_err().field(), "tempering");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// Standard deviation in dB, 1.5 to 20, that is added to that of the map as independent errors add up: how a person
    /// who walks differs from a survey. A map of [`super::Encoding::Levels`] has its own and ignores this one.
    pub inflation_sigma_db: f32,
    /// Fraction of the readings, 1e-6 to 0.1, that may have any strength within the range, so that none of them excludes
    /// a place. A map of [`super::Encoding::Levels`] has its own and ignores this one.
    pub outlier_rate: f32,
    /// The power, 0.05 to 1, to which likelihoods are raised: below 1 because readings are not independent.
    pub tempering: f32,
    /// The lowest and the highest strength in dBm that a receiver can report, at least 10 dB apart within -128 and 20;
    /// readings outside are left out.
    pub range_dbm: [f32; 2],
    /// Whether it tells something of the place that a scan has no reading of a beacon: as much as the map's
    /// [`super::Beacon::detection`] says, so a beacon with a detection probability of 0 still says nothing. Otherwise its
    /// packet was lost, or the scan was too short.
    pub missing_beacons_count: bool,
}

impl Config {
    /// For people who walk with a radio of the kind that made the survey.
    pub const DEFAULT: Self = Self {
        inflation_sigma_db: 4.0,
        outlier_rate: 1e-3,
        tempering: 0.5,
        range_dbm: [-120.0, 0.0],
        missing_beacons_count: false,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self:
            inflation_sigma_db 1.5..=20.0,
            outlier_rate 1e-6..=0.1,
            tempering 0.05..=1.0,
        );
        let [lowest, highest] = self.range_dbm;
        require!(
            lowest >= -128.0 && highest <= 20.0 && highest - lowest >= 10.0,
            "range_dbm is not an interval of 10 dB or more within -128 and 20"
        );
        Ok(())
    }

    /// Whether a receiver can report such a strength; false for NaN.
    pub(super) fn accepts(&self, rssi_dbm: f32) -> bool {
        rssi_dbm >= self.range_dbm[0] && rssi_dbm <= self.range_dbm[1]
    }

    /// Fraction of the readings that follow the map.
    pub(super) fn inlier_rate(&self) -> f32 {
        1.0 - self.outlier_rate
    }

    /// Natural logarithm of the density of outliers per dB, times their rate.
    pub(super) fn log_floor(&self) -> f32 {
        ln(self.outlier_rate / (self.range_dbm[1] - self.range_dbm[0]))
    }
}
