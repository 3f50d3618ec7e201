//! The angular spectrum of an antenna array: how much power comes from every direction, not only from where most does.
//!
//! An array that hears a source and its reflection has two peaks, and which of them is the higher one changes from one
//! reading to the next. A single bearing is then an outlier as often as not; the spectrum still knows of the other.
//!
//! # Tempering
//!
//! A spectrum is no likelihood: its peaks are as high as the algorithm and the signal make them, not as the bearing is
//! sure. The temper is the power to which it is raised to become one. A fitting one makes the sigmas of the peaks what
//! their errors are: drive past a known source, and multiply the temper by the square of the sigma that [`Spectrum::peaks`]
//! states over the error that it makes. Until then, 0.2 suits a KrakenSDR with MUSIC, whose errors are those of reflections
//! and calibration rather than of noise. A temper too low costs some accuracy, one too high makes
//! regions that miss the source: if in doubt, lower.

mod peaks;

use core::f32::consts::{LN_10, PI, TAU};

use super::{Bearing, ObservationError};
use crate::math::{atan2, wrap};
pub use peaks::Peak;

/// One value for every degree of the circle, counter-clockwise from the array's own axis.
///
/// Takes 722 bytes. The values are taken one by one, as they come over a line.
///
/// ```
/// use foxhunt::aoa::spectrum::Spectrum;
///
/// let mut spectrum = Spectrum::new();
/// for degree in 0..360 {
///     let (direct, reflected) = (degree as f32 - 40.3, degree as f32 - 200.0);
///     let decibels = (20.0 - 0.1 * direct * direct).max(17.0 - 0.1 * reflected * reflected).max(0.0);
///     spectrum.push(decibels)?;
/// }
/// let [Some(direct), Some(reflected), None] = spectrum.peaks(0.5) else {
///     panic!("there are two");
/// };
/// assert!((direct.angle_rad.to_degrees() - 40.3).abs() < 0.1);
/// assert!(direct.probability > reflected.probability && direct.probability + reflected.probability > 0.999);
/// # Ok::<(), foxhunt::aoa::ObservationError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spectrum {
    /// In hundredths of a decibel: a KrakenSDR states no more.
    levels: [u16; Self::CELLS],
    count: u16,
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
    pub fn push(&mut self, decibels: f32) -> Result<(), ObservationError> {
        if !(0.0..=Self::MAX_DECIBELS).contains(&decibels) {
            return Err(ObservationError::Level);
        }
        self.push_level((100.0 * decibels + 0.5) as u16)
    }

    /// The same in hundredths of a decibel.
    pub(crate) fn push_level(&mut self, level: u16) -> Result<(), ObservationError> {
        if level > Self::MAX_LEVEL {
            return Err(ObservationError::Level);
        }
        let place = self.levels.get_mut(usize::from(self.count));
        *place.ok_or(ObservationError::Degrees)? = level;
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
        f32::from(self.levels.iter().fold(0, |a, b| a.max(*b)))
    }

    /// The log-likelihood of a source in the direction `angle`, in radians counter-clockwise from the array's axis, less
    /// that of the highest degree; linear between two degrees.
    pub fn log_likelihood(&self, angle: f32, temper: f32) -> f32 {
        per_level(temper) * (self.interpolate(angle) - self.highest())
    }

    /// The spectrum as a [`Likelihood`](crate::model::Likelihood) of particles, if it was taken at a `position`, in metres,
    /// by an array whose axis points in the direction `axis`: of any state whose first two dimensions are metres east and
    /// north, up to a constant.
    ///
    /// It knows of all directions from which the source may be heard, where a
    /// [`BearingLikelihood`](crate::aoa::BearingLikelihood) knows of one. Every particle costs an arc tangent and two
    /// look-ups.
    ///
    /// ```
    /// use foxhunt::aoa::{Bearing, spectrum::Spectrum};
    ///
    /// let mut spectrum = Spectrum::new();
    /// for degree in 0..360 {
    ///     spectrum.push(if degree == 90 { 20.0 } else { 0.0 })?;
    /// }
    /// // The array's axis points east, so its left is the north.
    /// let at = spectrum.likelihood([0.0, 0.0], Bearing::from_radians(0.0), 0.2);
    /// assert!(at(&[0.0, 500.0]) > at(&[500.0, 0.0]) + 0.9);
    /// # Ok::<(), foxhunt::aoa::ObservationError>(())
    /// ```
    pub fn likelihood<const D: usize>(
        &self,
        position: [f32; 2],
        axis: Bearing,
        temper: f32,
    ) -> impl Fn(&[f32; D]) -> f32 + Copy {
        const { assert!(D >= 2, "a position takes two dimensions") };
        let (scale, highest) = (per_level(temper), self.highest());
        move |state| {
            let direction = atan2(state[1] - position[1], state[0] - position[0]);
            scale * (self.interpolate(direction - axis.radians()) - highest)
        }
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

/// The logarithm of the likelihood that a level of a hundredth of a decibel stands for.
fn per_level(temper: f32) -> f32 {
    temper * (LN_10 / 1000.0)
}

impl Default for Spectrum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
