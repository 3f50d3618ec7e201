//! The angular spectrum of an antenna array: how much power comes from every direction, not only from where most does.
//!
//! An array that hears a source and its reflection has two peaks, and which of them is the higher one changes from one
//! reading to the next. A single bearing is then an outlier as often as not; the spectrum still knows of the other.
//!
//! # Tempering
//!
//! A spectrum is no likelihood: its peaks are as high as the algorithm and the signal make them, not as the bearing is
//! sure. [`Temper`] is the power to which it is raised to become one. A fitting one makes the sigmas of the peaks what
//! their errors are: drive past a known source, and multiply the temper by the square of the sigma that [`Spectrum::peaks`]
//! states over the error that it makes. Until then, 0.2 suits a KrakenSDR with MUSIC, whose errors are those of reflections
//! and calibration rather than of noise. A temper too low costs some accuracy, one too high makes
//! regions that miss the source: if in doubt, lower.

mod likelihood;
mod peaks;

use core::f32::consts::{LN_10, PI, TAU};

use crate::ConfigError;
use crate::config::require;
use crate::error::messages;
use crate::math::wrap;
pub use likelihood::SpectrumLikelihood;
pub use peaks::Peak;

/// One value for every degree of the circle, counter-clockwise from the array's own axis.
///
/// Takes 722 bytes. The values are taken one by one, as they come over a line.
///
/// ```
/// use foxhunt::aoa::spectrum::{Spectrum, Temper};
///
/// let mut spectrum = Spectrum::new();
/// for degree in 0..360 {
///     let (direct, reflected) = (degree as f32 - 40.3, degree as f32 - 200.0);
///     let decibels = (20.0 - 0.1 * direct * direct).max(17.0 - 0.1 * reflected * reflected).max(0.0);
///     spectrum.push(decibels)?;
/// }
/// let [Some(direct), Some(reflected), None] = spectrum.peaks(Temper { exponent: 0.5 }) else {
///     panic!("there are two");
/// };
/// assert!((direct.angle_rad.to_degrees() - 40.3).abs() < 0.1);
/// assert!(direct.probability > reflected.probability && direct.probability + reflected.probability > 0.999);
/// # Ok::<(), foxhunt::aoa::spectrum::SpectrumError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spectrum {
    /// In hundredths of a decibel: a KrakenSDR states no more.
    levels: [u16; Self::CELLS],
    count: u16,
}

/// The power to which a spectrum is raised to become a likelihood.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Temper {
    /// The exponent, 0.001 to 10: 1 takes the spectrum for the likelihood itself.
    pub exponent: f32,
}

/// What is wrong with a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SpectrumError {
    /// There are more than [`Spectrum::CELLS`] values.
    Values,
    /// A level is not within 0 and [`Spectrum::MAX_DECIBELS`].
    Level,
}

messages!(SpectrumError {
    Self::Values => "more values than degrees",
    Self::Level => "a level is out of range",
});

impl Temper {
    /// For a KrakenSDR with MUSIC.
    pub const DEFAULT: Self = Self { exponent: 0.2 };

    /// Checks the exponent.
    ///
    /// # Errors
    /// When it is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(
            self.exponent >= 0.001 && self.exponent <= 10.0,
            "exponent is not within 0.001 and 10"
        );
        Ok(())
    }

    /// The logarithm of the likelihood that a level of a hundredth of a decibel stands for.
    const fn per_level(self) -> f32 {
        self.exponent * (LN_10 / 1000.0)
    }
}

impl Spectrum {
    /// Degrees of the circle.
    pub const CELLS: usize = 360;
    /// The highest level.
    pub const MAX_DECIBELS: f32 = 600.0;
    /// The same in hundredths.
    pub(crate) const MAX_LEVEL: u16 = (100.0 * Self::MAX_DECIBELS) as u16;

    /// No values yet.
    pub const fn new() -> Self {
        Self {
            levels: [0; Self::CELLS],
            count: 0,
        }
    }

    /// Forgets all values.
    pub fn clear(&mut self) {
        self.levels = [0; Self::CELLS];
        self.count = 0;
    }

    /// The level, in decibels above the lowest or any other level, of the next degree counter-clockwise. It is rounded to
    /// a hundredth.
    ///
    /// # Errors
    /// When it is out of range or one too many; the spectrum is as before.
    pub fn push(&mut self, decibels: f32) -> Result<(), SpectrumError> {
        if !(0.0..=Self::MAX_DECIBELS).contains(&decibels) {
            return Err(SpectrumError::Level);
        }
        self.push_level((100.0 * decibels + 0.5) as u16)
    }

    /// The same in hundredths of a decibel.
    pub(crate) fn push_level(&mut self, level: u16) -> Result<(), SpectrumError> {
        if level > Self::MAX_LEVEL {
            return Err(SpectrumError::Level);
        }
        let place = self.levels.get_mut(usize::from(self.count));
        *place.ok_or(SpectrumError::Values)? = level;
        self.count += 1;
        Ok(())
    }

    /// Whether all values are there; those that are not count as zero.
    pub const fn is_whole(&self) -> bool {
        self.count as usize == Self::CELLS
    }

    /// The level at a whole degree, which may be anything up to twice round the circle.
    fn level(&self, degree: usize) -> f32 {
        let degree = if degree >= Self::CELLS {
            degree - Self::CELLS
        } else {
            degree
        };
        self.levels
            .get(degree)
            .map_or(0.0, |level| f32::from(*level))
    }

    /// The highest level.
    fn highest(&self) -> f32 {
        f32::from(
            self.levels
                .iter()
                .fold(0, |a, b| if *b > a { *b } else { a }),
        )
    }

    /// The log-likelihood of a source in the direction `angle`, in radians counter-clockwise from the array's axis, less
    /// that of the highest degree; linear between two degrees.
    pub fn log_likelihood(&self, angle: f32, temper: Temper) -> f32 {
        temper.per_level() * (self.interpolate(angle) - self.highest())
    }

    fn interpolate(&self, angle: f32) -> f32 {
        const DEGREES: f32 = 180.0 / PI;
        let turn = wrap(angle);
        let degrees = DEGREES * if turn < 0.0 { turn + TAU } else { turn };
        let cell = degrees as usize;
        let part = degrees - cell as f32;
        let (here, next) = (self.level(cell), self.level(cell + 1));
        here + part * (next - here)
    }
}

impl Default for Spectrum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
