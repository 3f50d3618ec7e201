//! How the errors of bearings are distributed, and how that is learned from the bearings themselves.

use crate::ConfigError;
use crate::aoa::core::square_of_distance;
use crate::aoa::{Mixture, Observation, SigmaScale};
use crate::config::{require, require_all, require_within};
use crate::math::{exp, sqrt};
use crate::snapshot::value;

/// What weighs more bearings than this is not learned.
const CERTAIN: f32 = 1e6;

/// What is believed of the errors before any bearing. A zero switches a part off.
///
/// The error of a bearing that is not an outlier is normal, with the standard deviation of its observation times a scale,
/// which is learned unless `scale_bearings` is infinite, as it is by default.
///
/// ```
/// use foxhunt::aoa::{Mixture, robust::Errors};
///
/// // An antenna on a mast that turns with it: no mirrored bearings, but one bias of some 3 degrees in all of them.
/// const ERRORS: Errors = foxhunt::config!(Errors {
///     rates: Mixture::new(0.0, 0.1),
///     bias_sigma_rad: 0.05,
///     ..Errors::DEFAULT
/// });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Errors {
    /// The rates of direct, mirrored (0 to 0.9) and outlier bearings (0.001 to 0.9); at least 0.05 are direct. Where they
    /// are learned, the mean of what is expected.
    pub rates: Mixture,
    /// How many observed bearings the rates weigh as much as, at least 1. Infinity keeps them as they are.
    pub prior_bearings: f32,
    /// How many times as large as stated the standard deviations of direct and mirrored bearings are, 0.1 to 10. Where that
    /// is learned, the root of the mean square of what is expected.
    pub sigma_scale: f32,
    /// How many observed bearings this scale weighs as much as, at least 1. Infinity keeps it as it is. The fewer, the
    /// sooner regions shrink where bearings are better than stated, and the sooner errors that do not average out, like
    /// those of a place, are taken for good bearings.
    pub scale_bearings: f32,
    /// Standard deviation of the common bias of all bearings, as of an array that was not mounted straight; radians, 0 to
    /// 0.5. Zero is no bias.
    pub bias_sigma_rad: f32,
    /// Standard deviation of each coordinate of the places where bearings are taken; metres, 0 to 1000. Zero is exact.
    ///
    /// Seen from a source at a range r, a place that is off by p across the line of sight turns the bearing by p / r: the
    /// variances add. The range is that of the source as it was when the particles last moved; before the first fix, that
    /// of the best hypothesis. Errors of places count as independent where those of the bearings do.
    pub position_sigma_m: f32,
    /// How much the errors of two bearings have in common.
    pub correlation: Correlation,
}

/// What bearings have taught of their errors: nothing where all is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Learned {
    /// The rates of direct, mirrored and outlier bearings.
    pub rates: Mixture,
    /// How many times as large as stated their standard deviations are.
    pub sigma_scale: SigmaScale,
}

value!(Learned { rates, sigma_scale });

impl Learned {
    /// Before any bearing.
    pub const NOTHING: Self = Self {
        rates: Mixture::ZERO,
        sigma_scale: SigmaScale {
            mean: 0.0,
            sigma: 0.0,
        },
    };
}

/// What bearings are, in the mean over what they may be.
pub(super) struct Counts {
    /// How many are of each kind.
    pub(super) kinds: Mixture,
    /// How many independent bearings those that are not outliers are worth.
    pub(super) bearings: f32,
    /// Sum of the squared errors of those that are not outliers, in stated sigmas.
    pub(super) squares: f32,
}

impl Counts {
    pub(super) const NONE: Self = Self {
        kinds: Mixture::ZERO,
        bearings: 0.0,
        squares: 0.0,
    };
}

/// How much the errors of two bearings have in common.
///
/// Readings from within a quarter of `distance_m` that say the same become one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Correlation {
    /// Correlation of two bearings that are taken one after the other at one place, 0 to 0.99. Zero is none.
    pub at_rest: f32,
    /// It falls by a factor of e over this many metres, 0.001 to 1e6.
    pub distance_m: f32,
    /// It falls by a factor of e over this many seconds, at least 0.001.
    pub time_s: f32,
}

impl Correlation {
    /// Independent errors.
    pub const NONE: Self = Self {
        at_rest: 0.0,
        distance_m: 1.0,
        time_s: 1.0,
    };

    /// Nine tenths at one place, less by a factor of e every 5 m, whatever the time.
    pub const DEFAULT: Self = Self {
        at_rest: 0.9,
        distance_m: 5.0,
        time_s: f32::INFINITY,
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self: at_rest 0.0..=0.99, distance_m 0.001..=1e6);
        require!(self.time_s >= 0.001, "time_s is less than 0.001");
        Ok(())
    }

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

impl Errors {
    /// 8 % mirrored bearings and 12 % outliers, learned as soon as there are more than 10; sigmas as stated; no bias; nine
    /// tenths of the error in common at one place, less by a factor of e every 5 m.
    pub const DEFAULT: Self = Self {
        rates: Mixture {
            direct: 0.8,
            mirrored: 0.08,
            outlier: 0.12,
        },
        prior_bearings: 10.0,
        sigma_scale: 1.0,
        scale_bearings: f32::INFINITY,
        bias_sigma_rad: 0.0,
        position_sigma_m: 0.0,
        correlation: Correlation::DEFAULT,
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        let rates = self.rates;
        require_within!(rates: mirrored 0.0..=0.9, outlier 0.001..=0.9);
        require!(rates.direct >= 0.05, "direct is less than 0.05");
        require!(
            (rates.total() - 1.0).abs() <= 1e-3,
            "rates do not add up to one"
        );
        require!(self.prior_bearings >= 1.0, "prior_bearings is less than 1");
        require_within!(self: sigma_scale 0.1..=10.0);
        require!(self.scale_bearings >= 1.0, "scale_bearings is less than 1");
        require_within!(self: bias_sigma_rad 0.0..=0.5, position_sigma_m 0.0..=1000.0);
        require_all!(self.correlation);
        Ok(())
    }

    /// Of the error of a bearing, in square radians, with that of its place, if the bearing is worth so many independent
    /// ones, on a source thought to be at a place.
    pub(super) fn variance(
        &self,
        observation: &Observation,
        worth: f32,
        source: Option<[f32; 2]>,
    ) -> f32 {
        let own = self.own_variance(observation);
        let square = self.position_sigma_m * self.position_sigma_m;
        match source {
            Some(source) if square > 0.0 => {
                let range = worth * square_of_distance(source, observation.position());
                // No more than a radian, about the source itself.
                own + square / if range > square { range } else { square }
            }
            _ => own,
        }
    }

    /// Of the error of a bearing without that of its place.
    pub(super) fn own_variance(&self, observation: &Observation) -> f32 {
        let sigma = self.sigma_scale * observation.sigma_rad();
        sigma * sigma
    }

    /// Whether the scale of the sigmas is learned.
    pub(super) fn learns_scale(&self) -> bool {
        self.scale_bearings <= CERTAIN
    }

    /// These errors as far as learned.
    pub(in crate::aoa) fn with(&self, learned: &Learned) -> Self {
        let mut errors = *self;
        if learned.rates.outlier > 0.0 {
            errors.rates = learned.rates;
        }
        if learned.sigma_scale.mean > 0.0 {
            errors.sigma_scale = learned.sigma_scale.mean;
        }
        errors
    }

    /// The scale of the sigmas, and how well it is known.
    pub(in crate::aoa) fn scale_of(&self, learned: &Learned) -> SigmaScale {
        if learned.sigma_scale.mean > 0.0 {
            learned.sigma_scale
        } else {
            self.scale(self.sigma_scale, self.scale_bearings)
        }
    }

    /// A scale that is known by so many bearings.
    fn scale(&self, mean: f32, bearings: f32) -> SigmaScale {
        SigmaScale {
            mean,
            // Of the root of a variance that has an inverse gamma distribution.
            sigma: mean / sqrt(2.0 * bearings),
        }
    }

    /// One step of expectation maximisation: the mean of the Dirichlet distribution of these rates and the counts; and the
    /// root of the mean of the inverse gamma distribution of the square of the scale. What is not to be learned is zero.
    ///
    /// Where the squares count the uncertainty of the source as well, that mean makes the covariance of a linear problem
    /// that of its t distribution: no more is to be added for not knowing the scale.
    pub(super) fn learned(&self, counts: &Counts) -> Learned {
        let mut learned = Learned::NOTHING;
        let Counts {
            kinds,
            bearings,
            squares,
        } = counts;
        let weight = self.prior_bearings;
        if weight <= CERTAIN {
            let total = weight + kinds.total();
            let rate = |mean: f32, count: f32| (weight * mean + count) / total;
            learned.rates = Mixture {
                direct: rate(self.rates.direct, kinds.direct),
                mirrored: rate(self.rates.mirrored, kinds.mirrored),
                outlier: rate(self.rates.outlier, kinds.outlier),
            };
        }
        if self.learns_scale() {
            let weight = self.scale_bearings;
            let total = weight + bearings;
            let square = weight * self.sigma_scale * self.sigma_scale + squares;
            learned.sigma_scale = self.scale(sqrt(square / total), total);
        }
        learned
    }
}
