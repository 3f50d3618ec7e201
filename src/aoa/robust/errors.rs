//! How the errors of bearings are distributed, and how that is learned from the bearings themselves.

use super::biases::Biases;
use crate::ConfigError;
use crate::aoa::core::{Entry, square_of_distance};
use crate::aoa::{Mixture, Observation, SigmaScale};
use crate::config::{require, require_all, require_within};
use crate::math::{exp, larger, sqrt};
use crate::snapshot::value;

/// Fraction of the length over which correlation falls within which two places are one.
const SAME_PLACE: f32 = 0.25;

/// What weighs more bearings than this is not learned.
const CERTAIN: f32 = 1e6;

/// What is believed of the errors before any bearing. A zero switches a part off.
///
/// The error of a bearing that is not an outlier is the sum of a bias, of what it has in common with other bearings of its
/// place, and of an error of its own. All but the bias are normal, and as many times as large as stated as a scale says,
/// which is learned.
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Errors {
    /// The rates of direct, mirrored (0 to 0.9) and outlier bearings (0.001 to 0.9); at least 0.05 are direct. Where they
    /// are learned, the mean of what is expected.
    pub rates: Mixture,
    /// How many observed bearings the rates weigh as much as, at least 1. Infinity keeps them as they are.
    pub prior_bearings: f32,
    /// How many times as large as stated the standard deviations of direct and mirrored bearings are, 0.1 to 10. Where that
    /// is learned, the median of what is expected.
    pub sigma_scale: f32,
    /// What is believed of the natural logarithm of that scale before any bearing: near its median, this is the standard
    /// deviation; farther away the density falls by a factor of e for each of it. 0 to 1.5; zero keeps the scale as it is.
    pub scale_sigma: f32,
    /// Standard deviation of the error that all bearings of a station at one place have in common, as that of a compass or of
    /// reflections there, beside what `correlation` says; radians, 0 to 1. More readings of the place do not average it out.
    pub stop_sigma_rad: f32,
    /// Standard deviation of the bias of bearings, as of an array that was not mounted straight; radians, 0 to 0.5. Zero is
    /// no bias.
    pub bias_sigma_rad: f32,
    /// Which bearings have a bias in common.
    pub biases: Biases,
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

/// How much the errors of two bearings of one station have in common.
///
/// Readings from within a quarter of the distance over which that falls become one, if they say the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correlation {
    /// Correlation of two bearings that are taken one after the other at one place, 0 to 0.999. Zero is none.
    pub at_rest: f32,
    /// It falls by a factor of e over this fraction of the range to the source, 0 to 1; as long as that is not known, of
    /// the extent of the places where bearings were taken.
    pub distance: f32,
    /// It falls by a factor of e over so many metres, if that is farther, 0 to 1e6.
    pub distance_m: f32,
    /// It falls by a factor of e over this many seconds, at least 0.001.
    pub time_s: f32,
}

impl Correlation {
    /// Independent errors.
    pub const NONE: Self = Self {
        at_rest: 0.0,
        distance: 0.0,
        distance_m: 0.0,
        time_s: f32::INFINITY,
    };

    /// Nine tenths at one place, less by a factor of e every hundredth of the range, whatever the time.
    pub const DEFAULT: Self = Self {
        at_rest: 0.9,
        distance: 0.01,
        ..Self::NONE
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self: at_rest 0.0..=0.999, distance 0.0..=1.0, distance_m 0.0..=1e6);
        require!(self.time_s >= 0.001, "time_s is less than 0.001");
        Ok(())
    }

    /// The distance over which it falls by a factor of e, in metres, for sources at a range.
    pub(super) fn length_m(&self, range_m: f32) -> f32 {
        /// Of places that are one.
        const LEAST_M: f32 = 1e-3;
        let length = self.distance * range_m;
        let least = larger(self.distance_m, LEAST_M);
        larger(length, least)
    }

    /// Whether two places are one, from the square of their distance and the distance over which it falls.
    pub(super) fn is_one_place(square: f32, length_m: f32) -> bool {
        square < Self::square_of_place(length_m)
    }

    fn square_of_place(length_m: f32) -> f32 {
        SAME_PLACE * SAME_PLACE * length_m * length_m
    }

    /// Of readings that are evenly spread over a time, in the mean over all pairs: one if there is no time between them.
    fn over(&self, seconds: f32) -> f32 {
        let x = seconds / self.time_s;
        if x < 0.01 {
            return 1.0;
        }
        2.0 * (x - 1.0 + exp(-x)) / (x * x)
    }

    /// How many independent readings the next one of a row is worth, of an autoregression of first order.
    pub(super) fn worth(&self, lengths: f32) -> f32 {
        let r = self.at_rest * exp(-lengths);
        (1.0 - r) / (1.0 + r)
    }
}

impl Errors {
    /// 8 % mirrored bearings and 12 % outliers, learned as soon as there are more than 10; sigmas that are as stated, or else
    /// wrong by any factor; an array that is turned by some four degrees; nine tenths of the error in common at one place.
    pub const DEFAULT: Self = Self {
        rates: Mixture {
            direct: 0.8,
            mirrored: 0.08,
            outlier: 0.12,
        },
        prior_bearings: 10.0,
        sigma_scale: 1.0,
        scale_sigma: 0.15,
        stop_sigma_rad: 0.0,
        bias_sigma_rad: 0.07,
        biases: Biases::Common,
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
        require_within!(self:
            sigma_scale 0.1..=10.0,
            scale_sigma 0.0..=1.5,
            stop_sigma_rad 0.0..=1.0,
            bias_sigma_rad 0.0..=0.5,
            position_sigma_m 0.0..=1000.0,
        );
        require_all!(self.correlation);
        Ok(())
    }

    /// Of the error of a bearing, in square radians, with that of its place, on a source thought to be at a place.
    #[inline(never)]
    pub(super) fn variance(&self, observation: &Observation, source: Option<[f32; 2]>) -> f32 {
        let sigma = self.sigma_scale * observation.sigma_rad();
        let stop = self.sigma_scale * self.stop_sigma_rad;
        sigma * sigma + stop * stop + self.variance_of_place(observation, source)
    }

    /// What the error of its place adds to the variance of a bearing.
    pub(super) fn variance_of_place(
        &self,
        observation: &Observation,
        source: Option<[f32; 2]>,
    ) -> f32 {
        let square = self.position_sigma_m * self.position_sigma_m;
        let Some(source) = source.filter(|_| square > 0.0) else {
            return 0.0;
        };
        let range = square_of_distance(source, observation.position());
        // No more than a radian, about the source itself.
        square / larger(range, square)
    }

    /// Which bearings have a bias in common, and its standard deviation in radians.
    pub(super) fn biases(&self) -> (Biases, f32) {
        (self.biases, self.bias_sigma_rad)
    }

    /// Whether bearings have errors in common beside biases.
    pub(super) fn are_correlated(&self) -> bool {
        self.correlation.at_rest > 0.0 || self.stop_sigma_rad > 0.0
    }

    /// The square of the distance in metres within which bearings on a source are taken at one place.
    pub(in crate::aoa) fn square_of_place(&self, place: [f32; 2], source: [f32; 2]) -> f32 {
        let range = sqrt(square_of_distance(source, place));
        Correlation::square_of_place(self.correlation.length_m(range))
    }

    /// Whether variances depend on how far away the source is.
    pub(super) fn depend_on_range(&self) -> bool {
        let by_direction = matches!(self.biases, Biases::ByDirection);
        self.position_sigma_m > 0.0 || self.are_correlated() || by_direction
    }

    /// Variance of the error of an entry on its own, in stated sigmas: of the part that the readings have in common,
    /// which is as large for many as for one, and of the others.
    #[inline(never)]
    pub(in crate::aoa) fn own_variance(&self, entry: &Entry) -> f32 {
        let correlation = &self.correlation;
        let common = correlation.at_rest * correlation.over(entry.span_s());
        let single = (1.0 - correlation.at_rest) * entry.worth / entry.readings;
        let stop = self.stop_sigma_rad * self.stop_sigma_rad / entry.worth;
        stop + (common + single) / entry.observation.information()
    }

    /// Covariance of the errors of two entries of a station, in stated sigmas, of which the errors of places and of time
    /// have fallen by these exponents.
    pub(super) fn covariance(&self, [a, b]: [&Entry; 2], place: f32, time: f32) -> f32 {
        let stop = self.stop_sigma_rad * self.stop_sigma_rad;
        let [a, b] = [a, b].map(|entry| entry.observation.sigma_rad());
        exp(-place) * (stop + self.correlation.at_rest * exp(-time) * a * b)
    }

    /// These errors as far as learned.
    pub(in crate::aoa) fn with(&self, learned: &Learned) -> Self {
        let mut errors = self.with_rates(learned);
        if learned.sigma_scale.mean > 0.0 {
            errors.sigma_scale = learned.sigma_scale.mean;
        }
        errors
    }

    /// These errors, with the rates as far as learned.
    pub(super) fn with_rates(&self, learned: &Learned) -> Self {
        let mut errors = *self;
        if learned.rates.outlier > 0.0 {
            errors.rates = learned.rates;
        }
        errors
    }

    /// The scale of the sigmas, and how well it is known.
    pub(in crate::aoa) fn scale_of(&self, learned: &Learned) -> SigmaScale {
        if learned.sigma_scale.mean > 0.0 {
            learned.sigma_scale
        } else {
            self.scale(0.0, 1.0)
        }
    }

    /// The scale, of which the mean and the variance of the logarithm are known, in prior sigmas.
    pub(super) fn scale(&self, mean: f32, variance: f32) -> SigmaScale {
        let mean = self.sigma_scale * exp(self.scale_sigma * mean);
        SigmaScale {
            mean,
            sigma: mean * self.scale_sigma * sqrt(variance),
        }
    }

    /// One step of expectation maximisation: the mean of the Dirichlet distribution of these rates and the counts; zero
    /// where they are not to be learned.
    pub(super) fn learned_rates(&self, counts: &Mixture) -> Mixture {
        let weight = self.prior_bearings;
        if weight > CERTAIN {
            return Mixture::ZERO;
        }
        let total = weight + counts.total();
        let rate = |mean: f32, count: f32| (weight * mean + count) / total;
        Mixture {
            direct: rate(self.rates.direct, counts.direct),
            mirrored: rate(self.rates.mirrored, counts.mirrored),
            outlier: rate(self.rates.outlier, counts.outlier),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_within_a_quarter_of_the_correlation_are_one() {
        for length_m in [10.0, 400.0] {
            let near: f32 = 0.24 * length_m;
            let far: f32 = 0.26 * length_m;
            assert!(Correlation::is_one_place(near * near, length_m));
            assert!(!Correlation::is_one_place(far * far, length_m));
        }
    }
}
