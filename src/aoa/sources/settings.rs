//! When sources are born, and when they die.

use core::fmt;

use crate::math::ln;

/// What [`Sources`](super::Sources) can be told; what is believed of the bearings is told to their tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Logarithm of the inverse of the probability.
    pub(super) log_odds: f32,
    pub(super) bearings: f32,
    pub(super) seconds: f32,
    pub(super) least_share: f32,
}

/// Why a setting was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `probability` of a false birth is not within 1e-9 and 0.5.
    FalseBirth,
    /// `bearings` of the memory are not within 8 and 1e6.
    MemoryBearings,
    /// `seconds` of the memory are less than 1, or NaN.
    MemorySeconds,
    /// `least_share` is not within 0 and 0.5.
    LeastShare,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FalseBirth => "the probability of a false birth is not within 1e-9 and 0.5",
            Self::MemoryBearings => "the bearings of the memory are not within 8 and 1e6",
            Self::MemorySeconds => "the seconds of the memory are less than 1",
            Self::LeastShare => "least_share is not within 0 and 0.5",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// The defaults.
    pub const fn new() -> Self {
        Self {
            log_odds: ln(1e3),
            bearings: 64.0,
            seconds: 600.0,
            least_share: 0.04,
        }
    }

    /// How probable it may be that wild bearings, however many, ever look like one more source: 0.001 unless set.
    ///
    /// # Errors
    /// Outside 1e-9 to 0.5.
    pub const fn false_birth(mut self, probability: f32) -> Result<Self, SettingsError> {
        if !(probability >= 1e-9 && probability <= 0.5) {
            return Err(SettingsError::FalseBirth);
        }
        self.log_odds = -ln(probability);
        Ok(self)
    }

    /// What is recent: a bearing counts for less by a factor of e after so many others, and after so many seconds: 64
    /// and 600 unless set.
    ///
    /// # Errors
    /// When `bearings` are outside 8 to 1e6, or `seconds` less than 1.
    pub const fn memory(mut self, bearings: f32, seconds: f32) -> Result<Self, SettingsError> {
        if !(bearings >= 8.0 && bearings <= 1e6) {
            return Err(SettingsError::MemoryBearings);
        }
        if !(seconds >= 1.0 && seconds <= f32::INFINITY) {
            return Err(SettingsError::MemorySeconds);
        }
        self.bearings = bearings;
        self.seconds = seconds;
        Ok(self)
    }

    /// A source that has less than this share of the recent bearings is given up: 0.04 unless set. Zero keeps all.
    ///
    /// # Errors
    /// Outside 0 to 0.5.
    pub const fn least_share(mut self, share: f32) -> Result<Self, SettingsError> {
        if !(share >= 0.0 && share <= 0.5) {
            return Err(SettingsError::LeastShare);
        }
        self.least_share = share;
        Ok(self)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}
