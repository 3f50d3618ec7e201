//! What a locator for bearings of which some are wrong can be told.

use super::errors::{Correlation, Errors};
use crate::ConfigError;
use crate::aoa::Mixture;
use crate::config::{require, require_all, require_within};

/// What a [`Robust`](super::Robust) locator can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// What is believed of the errors before any bearing.
    pub errors: Errors,
    /// Range from which on all orders of magnitude are as likely, from the middle of the places of the bearings; metres, 0.01
    /// to 1e6. Nearer, and among these places, all places are.
    pub nearest_m: f32,
    /// Range up to which they are, at least as large, up to 1e6. If both are the same, all places within are as likely.
    pub range_m: f32,
    /// Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
    pub relative_range_sigma: f32,
    /// Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
    pub resample_below: f32,
    /// Metropolis-Hastings steps of every particle after a resampling, 1 to 16. Each evaluates all bearings in the buffer
    /// once.
    pub moves: u8,
}

impl Config {
    /// For any direction finder, in a room or on a vehicle: a source a metre to 20 km away.
    pub const DEFAULT: Self = Self {
        errors: Errors::DEFAULT,
        nearest_m: 1.0,
        range_m: 20_000.0,
        relative_range_sigma: 0.25,
        resample_below: 0.5,
        moves: 2,
    };

    /// For a vehicle in a city: its array is mounted 3 degrees off, satellites place it to 3 m, and what reflections add to
    /// bearings changes every 5 m. Its sigmas allow for reflections, so that better bearings are only slowly believed.
    pub const CITY: Self = Self {
        errors: Errors {
            bias_sigma_rad: 0.05,
            position_sigma_m: 3.0,
            scale_sigma: 0.05,
            correlation: Correlation {
                distance: 0.0,
                distance_m: 5.0,
                ..Correlation::DEFAULT
            },
            ..Errors::DEFAULT
        },
        ..Self::DEFAULT
    };

    /// For fixed arrays round a room that hear a tag many times a second: each is off by some ten degrees, as the walls reflect,
    /// the same while the tag is at rest, and what else is wrong with a reading lasts for some seconds. Any place is a fix, with
    /// the sigma that it has.
    ///
    /// What an array is off by counts as that of a place, for the array is at one: it is not estimated, and costs nothing.
    pub const ROOM: Self = Self {
        errors: Errors {
            rates: Mixture::new(0.0, 0.02),
            prior_bearings: f32::INFINITY,
            stop_sigma_rad: 0.175,
            bias_sigma_rad: 0.0,
            correlation: Correlation {
                at_rest: 0.99,
                time_s: 2.0,
                ..Correlation::DEFAULT
            },
            ..Errors::DEFAULT
        },
        range_m: 20.0,
        relative_range_sigma: 1.0,
        ..Self::DEFAULT
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_all!(self.errors);
        require_within!(self:
            nearest_m 0.01..=1e6,
            range_m 0.01..=1e6,
            relative_range_sigma 0.01..=1.0,
            resample_below 0.0..=1.0,
            moves 1..=16,
        );
        require!(
            self.nearest_m <= self.range_m,
            "nearest_m is larger than range_m"
        );
        Ok(())
    }
}
