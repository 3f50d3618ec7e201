//! How the errors of bearings are distributed, and how that is learned from the bearings themselves.

use core::f32::consts::{PI, TAU};
use core::fmt;

use super::term::{Reading, State};
use crate::aoa::Observation;
use crate::math::{exp, sqrt};

/// What bearings are: straight at the source, turned by half a circle, or unrelated to it. They sum to one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Shares {
    /// Share of the bearings that point at the source, but for their errors.
    pub direct: f32,
    /// Share of those that point away from it, as an array without a sense of direction has them.
    pub mirror: f32,
    /// Share of those that say nothing of it: reflections, other transmitters.
    pub wild: f32,
}

impl Shares {
    pub(super) const NONE: Self = Self {
        direct: 0.0,
        mirror: 0.0,
        wild: 0.0,
    };

    /// Counts a bearing by what it probably is.
    pub(super) fn add(&mut self, reading: &Reading, weight: f32) {
        let fitted = weight * reading.odds / (1.0 + reading.odds);
        self.wild += weight - fitted;
        if reading.mirrored {
            self.mirror += fitted;
        } else {
            self.direct += fitted;
        }
    }
}

/// How the errors of the bearings that are not wild are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Tails {
    /// Normally, with the deviation of each observation.
    #[default]
    Normal,
    /// By Student's t distribution, scaled by the deviation of each observation: as narrow in the middle, with more
    /// errors of many deviations, up to a right angle. The wild share takes care of most of those, so the normal one is
    /// seldom worse.
    Student {
        /// Degrees of freedom, 3 to 30: the fewer, the heavier the tails.
        freedom: u8,
    },
}

/// What is believed of the errors before any bearing. Each part is set on its own, and switched off by a zero.
///
/// ```
/// use foxhunt::aoa::robust::Errors;
///
/// // An antenna on a mast that turns with it: no mirrored bearings, but one offset of some 3 degrees in all of them.
/// let errors = Errors::new().shares(0.0, 0.1)?.bias_deviation(0.05)?;
/// # Ok::<(), foxhunt::aoa::robust::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Errors {
    pub(super) tails: Tails,
    pub(super) shares: Shares,
    pub(super) prior_bearings: f32,
    pub(super) bias_deviation: f32,
    pub(super) position_deviation: f32,
    pub(super) correlation: Correlation,
}

/// How much the errors of two bearings have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Correlation {
    pub(super) at_rest: f32,
    pub(super) distance_m: f32,
    pub(super) time_s: f32,
}

impl Correlation {
    /// How far apart two bearings are, as the exponent of their correlation.
    pub(super) fn lengths(&self, distance_m: f32, seconds: f32) -> f32 {
        distance_m / self.distance_m + seconds / self.time_s
    }

    /// How many independent readings the next one of a row is worth.
    pub(super) fn worth(&self, lengths: f32) -> f32 {
        let r = self.at_rest * exp(-lengths);
        (1.0 - r) / (1.0 + r)
    }
}

/// Why a setting was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// The degrees of freedom of [`Tails::Student`] are not within 3 and 30.
    Freedom,
    /// `mirror` is not within 0 and 0.9.
    Mirror,
    /// `wild` is not within 0.001 and 0.9, or leaves less than 0.05 of the bearings direct.
    Wild,
    /// `prior_bearings` is less than 1, or NaN.
    PriorBearings,
    /// `bias_deviation` is not within 0 and 0.5.
    BiasDeviation,
    /// `position_deviation` is not within 0 and 1000.
    PositionDeviation,
    /// `at_rest` is not within 0 and 0.99.
    CorrelationAtRest,
    /// `distance_m` is not within 0.001 and 1e6.
    CorrelationDistance,
    /// `time_s` is less than 0.001, or NaN.
    CorrelationTime,
    /// `range_m` is not within 1 and 1e6.
    Range,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Freedom => "freedom is not within 3 and 30",
            Self::Mirror => "mirror is not within 0 and 0.9",
            Self::Wild => "wild is not within 0.001 and 0.9, or leaves too few direct",
            Self::PriorBearings => "prior_bearings is less than 1",
            Self::BiasDeviation => "bias_deviation is not within 0 and 0.5",
            Self::PositionDeviation => "position_deviation is not within 0 and 1000",
            Self::CorrelationAtRest => "at_rest is not within 0 and 0.99",
            Self::CorrelationDistance => "distance_m is not within 0.001 and 1e6",
            Self::CorrelationTime => "time_s is less than 0.001",
            Self::Range => "range_m is not within 1 and 1e6",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Errors {
    /// Normal errors, 8 % mirrored and 12 % wild bearings, learned as soon as there are more than 10; no bias; nine
    /// tenths of the error in common at one place, less by a factor of e every 5 m.
    pub const fn new() -> Self {
        Self {
            tails: Tails::Normal,
            shares: Shares {
                direct: 0.8,
                mirror: 0.08,
                wild: 0.12,
            },
            prior_bearings: 10.0,
            bias_deviation: 0.0,
            position_deviation: 0.0,
            correlation: Correlation {
                at_rest: 0.9,
                distance_m: 5.0,
                time_s: f32::INFINITY,
            },
        }
    }

    /// The distribution of the errors of the bearings that are not wild.
    ///
    /// # Errors
    /// When Student's has fewer than 3 or more than 30 degrees of freedom.
    pub const fn tails(mut self, tails: Tails) -> Result<Self, SettingsError> {
        if let Tails::Student { freedom } = tails
            && (freedom < 3 || freedom > 30)
        {
            return Err(SettingsError::Freedom);
        }
        self.tails = tails;
        Ok(self)
    }

    /// The shares of mirrored and wild bearings: 0.08 and 0.12 unless set. Where they are learned, the mean of what is
    /// expected.
    ///
    /// # Errors
    /// When `mirror` is outside 0 to 0.9 or `wild` outside 0.001 to 0.9, or less than 0.05 is left.
    pub const fn shares(mut self, mirror: f32, wild: f32) -> Result<Self, SettingsError> {
        if !(mirror >= 0.0 && mirror <= 0.9) {
            return Err(SettingsError::Mirror);
        }
        let direct = 1.0 - mirror - wild;
        if !(wild >= 0.001 && wild <= 0.9 && direct >= 0.05) {
            return Err(SettingsError::Wild);
        }
        self.shares = Shares {
            direct,
            mirror,
            wild,
        };
        Ok(self)
    }

    /// How many bearings of one's own the shares weigh as much as: 10 unless set. Infinitely many keep them as they
    /// are.
    ///
    /// # Errors
    /// Below 1.
    pub const fn prior_bearings(mut self, bearings: f32) -> Result<Self, SettingsError> {
        if !(bearings >= 1.0 && bearings <= f32::INFINITY) {
            return Err(SettingsError::PriorBearings);
        }
        self.prior_bearings = bearings;
        Ok(self)
    }

    /// Standard deviation, in radians, of what all bearings are off by alike, as by an array that was not mounted
    /// straight: 0 unless set, which is none.
    ///
    /// # Errors
    /// Outside 0 to 0.5.
    pub const fn bias_deviation(mut self, radians: f32) -> Result<Self, SettingsError> {
        if !(radians >= 0.0 && radians <= 0.5) {
            return Err(SettingsError::BiasDeviation);
        }
        self.bias_deviation = radians;
        Ok(self)
    }

    /// Standard deviation, in metres, of each coordinate of the places where bearings are taken: 0 unless set, which is
    /// exact.
    ///
    /// Seen from a source at a range r, a place that is off by p across the line of sight turns the bearing by p / r: the
    /// variances add. The range is that of the source as it was when the particles last moved; before the first fix, that
    /// of the best hypothesis. Errors of places count as independent where those of the bearings do.
    ///
    /// # Errors
    /// Outside 0 to 1000.
    pub const fn position_deviation(mut self, metres: f32) -> Result<Self, SettingsError> {
        if !(metres >= 0.0 && metres <= 1000.0) {
            return Err(SettingsError::PositionDeviation);
        }
        self.position_deviation = metres;
        Ok(self)
    }

    /// Correlation of the errors of two bearings: `at_rest` if taken one after the other at one place, less by a
    /// factor of e every `distance_m` metres and every `time_s` seconds. 0.9, 5 m and infinitely long unless set;
    /// zero at rest is none. Readings from within a quarter of that distance that agree become one.
    ///
    /// # Errors
    /// When `at_rest` is outside 0 to 0.99, `distance_m` outside 0.001 to 1e6, or `time_s` below 0.001.
    pub const fn correlation(
        mut self,
        at_rest: f32,
        distance_m: f32,
        time_s: f32,
    ) -> Result<Self, SettingsError> {
        if !(at_rest >= 0.0 && at_rest <= 0.99) {
            return Err(SettingsError::CorrelationAtRest);
        }
        if !(distance_m >= 0.001 && distance_m <= 1e6) {
            return Err(SettingsError::CorrelationDistance);
        }
        if !(time_s >= 0.001 && time_s <= f32::INFINITY) {
            return Err(SettingsError::CorrelationTime);
        }
        self.correlation = Correlation {
            at_rest,
            distance_m,
            time_s,
        };
        Ok(self)
    }

    /// Of the error of a bearing, in square radians, with that of its place, if the bearing is worth so many independent
    /// ones, on a source thought to be at a state.
    pub(super) fn variance(
        &self,
        observation: &Observation,
        worth: f32,
        source: Option<&State>,
    ) -> f32 {
        let own = observation.deviation() * observation.deviation();
        let square = self.position_deviation * self.position_deviation;
        match source {
            Some(&[x, y, _]) if square > 0.0 => {
                let [px, py] = observation.position();
                let range = worth * ((x - px) * (x - px) + (y - py) * (y - py));
                // No more than a radian, about the source itself.
                own + square / if range > square { range } else { square }
            }
            _ => own,
        }
    }

    /// One step of expectation maximisation: the shares become the mean of the Dirichlet distribution of `prior` and
    /// the counts.
    pub(super) fn learn(&mut self, prior: &Self, counts: &Shares) {
        let weight = prior.prior_bearings;
        if weight > 1e6 {
            return;
        }
        let total = weight + counts.direct + counts.mirror + counts.wild;
        let share = |mean: f32, count: f32| (weight * mean + count) / total;
        self.shares = Shares {
            direct: share(prior.shares.direct, counts.direct),
            mirror: share(prior.shares.mirror, counts.mirror),
            wild: share(prior.shares.wild, counts.wild),
        };
    }
}

impl Default for Errors {
    fn default() -> Self {
        Self::new()
    }
}

impl Tails {
    /// Density of no error, for a deviation of one, beside that of a uniform angle.
    pub(super) fn height(self) -> f32 {
        let Self::Student { freedom } = self else {
            return sqrt(TAU);
        };
        // gamma((n + 1) / 2) / gamma(n / 2), from one or two degrees up.
        let odd = freedom & 1 == 1;
        let mut ratio = if odd { 1.0 / sqrt(PI) } else { 0.5 * sqrt(PI) };
        let mut n = if odd { 1.0 } else { 2.0 };
        let freedom = f32::from(freedom);
        while n < freedom {
            ratio *= (n + 1.0) / n;
            n += 2.0;
        }
        2.0 * sqrt(PI / freedom) * ratio
    }
}
