//! What a reading is taken for.

use core::fmt;

use crate::math::ln;

/// One beacon as a scan heard it: a packet, or the mean of several.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The number of the beacon, see [`super::RadioMap::beacon_index`].
    pub beacon: u8,
    /// Strength in dBm, less the offset of the receiver.
    pub rssi_dbm: f32,
}

/// What it means that a scan has no reading of a beacon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Missing {
    /// Nothing: its packet was lost, or the scan was too short.
    #[default]
    Ignored,
    /// As much as the map's [`super::Beacon::detection`] says: a beacon with a detection probability of 0 still
    /// says nothing.
    Modelled,
}

/// How scans are matched with a map.
///
/// ```
/// use foxhunt::fingerprint::{Missing, Settings};
///
/// const SETTINGS: Settings = Settings::new().with_missing(Missing::Modelled);
/// assert!(SETTINGS.with_tempering(0.25).is_ok());
/// assert!(SETTINGS.with_tempering(0.0).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    inflation_db: f32,
    outliers: f32,
    tempering: f32,
    range_dbm: [f32; 2],
    missing: Missing,
}

/// Which of the [`Settings`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `inflation_db` is not within 1.5 and 20.
    Inflation,
    /// `outliers` is not within 1e-6 and 0.1.
    Outliers,
    /// `tempering` is not within 0.05 and 1.
    Tempering,
    /// `range_dbm` is not an interval of at least 10 dB within -128 and 20 dBm.
    Range,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Inflation => "inflation is not within 1.5 and 20 dB",
            Self::Outliers => "outliers is not within 1e-6 and 0.1",
            Self::Tempering => "tempering is not within 0.05 and 1",
            Self::Range => "range is not an interval of 10 dB within -128 and 20 dBm",
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
    /// 4 dB of inflation, one outlier in a thousand, a tempering of 0.5, readings from -120 to 0 dBm, missing beacons
    /// ignored.
    pub const fn new() -> Self {
        Self {
            inflation_db: 4.0,
            outliers: 1e-3,
            tempering: 0.5,
            range_dbm: [-120.0, 0.0],
            missing: Missing::Ignored,
        }
    }

    /// A deviation, in dB, that is added to that of the map, as independent errors add up: how a person who walks
    /// differs from a survey. Of no use in a map of [`super::Encoding::Levels`], which has its own.
    ///
    /// # Errors
    /// [`SettingsError::Inflation`] when it is not within 1.5 and 20.
    pub const fn with_inflation_db(mut self, inflation: f32) -> Result<Self, SettingsError> {
        if !(inflation >= 1.5 && inflation <= 20.0) {
            return Err(SettingsError::Inflation);
        }
        self.inflation_db = inflation;
        Ok(self)
    }

    /// The share of readings that may have any strength in the range, so that none of them excludes a place. Of no use
    /// in a map of [`super::Encoding::Levels`], which has its own.
    ///
    /// # Errors
    /// [`SettingsError::Outliers`] when it is not within 1e-6 and 0.1.
    pub const fn with_outliers(mut self, outliers: f32) -> Result<Self, SettingsError> {
        if !(outliers >= 1e-6 && outliers <= 0.1) {
            return Err(SettingsError::Outliers);
        }
        self.outliers = outliers;
        Ok(self)
    }

    /// The power to which likelihoods are raised: below 1 because readings are no independent samples.
    ///
    /// # Errors
    /// [`SettingsError::Tempering`] when it is not within 0.05 and 1.
    pub const fn with_tempering(mut self, tempering: f32) -> Result<Self, SettingsError> {
        if !(tempering >= 0.05 && tempering <= 1.0) {
            return Err(SettingsError::Tempering);
        }
        self.tempering = tempering;
        Ok(self)
    }

    /// The lowest and the highest strength, in dBm, that a receiver can report; readings beyond are left out.
    ///
    /// # Errors
    /// [`SettingsError::Range`] unless it is an interval of at least 10 dB within -128 and 20 dBm.
    pub const fn with_range_dbm(mut self, range: [f32; 2]) -> Result<Self, SettingsError> {
        let [lowest, highest] = range;
        if !(lowest >= -128.0 && highest <= 20.0 && highest - lowest >= 10.0) {
            return Err(SettingsError::Range);
        }
        self.range_dbm = range;
        Ok(self)
    }

    /// What it means that a scan has no reading of a beacon.
    pub const fn with_missing(mut self, missing: Missing) -> Self {
        self.missing = missing;
        self
    }

    /// What missing beacons mean.
    pub const fn missing(&self) -> Missing {
        self.missing
    }

    /// The power to which likelihoods are raised.
    pub const fn tempering(&self) -> f32 {
        self.tempering
    }

    /// Whether a receiver can report such a strength; not if it is NaN.
    pub fn accepts(&self, rssi_dbm: f32) -> bool {
        rssi_dbm >= self.range_dbm[0] && rssi_dbm <= self.range_dbm[1]
    }

    /// Variance, in dB^2, that is added to that of the map.
    pub(super) fn inflation_variance(&self) -> f32 {
        self.inflation_db * self.inflation_db
    }

    /// Share of readings that follow the map.
    pub(super) fn inliers(&self) -> f32 {
        1.0 - self.outliers
    }

    /// Density, per dB, of a reading that may have any strength, times the share of those.
    pub(super) fn floor(&self) -> f32 {
        self.outliers / (self.range_dbm[1] - self.range_dbm[0])
    }

    pub(super) fn log_floor(&self) -> f32 {
        ln(self.floor())
    }
}
