//! What a user tells of how the source moves.

use core::fmt;

use crate::aoa::robust;

/// What a [`Pursuit`](super::Pursuit) can be told; the defaults suit a car that is hunted by a car.
///
/// ```
/// use foxhunt::aoa::{pursuit::Settings, robust};
///
/// // Somebody on foot, who stops as often as not.
/// let walker = Settings::new(robust::Settings::default())
///     .speed(1.4)?
///     .parked_s(120.0)?
///     .driving_s(120.0)?
///     .straight_s(30.0)?;
/// # Ok::<(), foxhunt::aoa::pursuit::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    pub(super) locator: robust::Settings,
    pub(super) habits: Habits,
}

/// How the source moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Habits {
    pub(super) speed: f32,
    pub(super) parked_s: f32,
    pub(super) driving_s: f32,
    pub(super) straight_s: f32,
}

/// Why a setting was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `speed` is not within 0.05 and 100.
    Speed,
    /// `parked_s` is not within 1 and 1e6.
    Parked,
    /// `driving_s` is not within 1 and 1e6.
    Driving,
    /// `straight_s` is not within 1 and 1e5.
    Straight,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed is not within 0.05 and 100",
            Self::Parked => "parked_s is not within 1 and 1e6",
            Self::Driving => "driving_s is not within 1 and 1e6",
            Self::Straight => "straight_s is not within 1 and 1e5",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// The defaults, with the settings of the locator for a source that is parked.
    pub const fn new(locator: robust::Settings) -> Self {
        Self {
            locator,
            habits: Habits {
                speed: 10.0,
                parked_s: 600.0,
                driving_s: 180.0,
                straight_s: 20.0,
            },
        }
    }

    /// Root of the mean square of the source's speed while it drives, in metres a second: 10 unless set.
    ///
    /// # Errors
    /// Outside 0.05 to 100.
    pub const fn speed(mut self, metres_a_second: f32) -> Result<Self, SettingsError> {
        if !(metres_a_second >= 0.05 && metres_a_second <= 100.0) {
            return Err(SettingsError::Speed);
        }
        self.habits.speed = metres_a_second;
        Ok(self)
    }

    /// How long the source stays parked, in the mean, in seconds: 600 unless set. The longer, the more it takes to
    /// believe that it moves.
    ///
    /// # Errors
    /// Outside 1 to 1e6.
    pub const fn parked_s(mut self, seconds: f32) -> Result<Self, SettingsError> {
        if !(seconds >= 1.0 && seconds <= 1e6) {
            return Err(SettingsError::Parked);
        }
        self.habits.parked_s = seconds;
        Ok(self)
    }

    /// How long the source drives, in the mean, before it parks again, in seconds: 180 unless set.
    ///
    /// # Errors
    /// Outside 1 to 1e6.
    pub const fn driving_s(mut self, seconds: f32) -> Result<Self, SettingsError> {
        if !(seconds >= 1.0 && seconds <= 1e6) {
            return Err(SettingsError::Driving);
        }
        self.habits.driving_s = seconds;
        Ok(self)
    }

    /// How long the source drives straight on, in the mean, before it takes any other velocity, in seconds: 20 unless
    /// set. The agiler it is, the shorter.
    ///
    /// # Errors
    /// Outside 1 to 1e5.
    pub const fn straight_s(mut self, seconds: f32) -> Result<Self, SettingsError> {
        if !(seconds >= 1.0 && seconds <= 1e5) {
            return Err(SettingsError::Straight);
        }
        self.habits.straight_s = seconds;
        Ok(self)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new(robust::Settings::default())
    }
}
