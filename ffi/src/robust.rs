//! The locator for bearings of which some are wrong.

use foxhunt::ConfigError;
use foxhunt::aoa::robust::{self, Biases, Correlation, Errors};
use foxhunt::aoa::{Locate, Mixture};

use crate::door::{opaque, plain};
use crate::locator::{self, Fault, Told};
use crate::result::{FoxhuntResult, FoxhuntText};
use crate::types::Robust;
use crate::words::{FoxhuntAnswer, FoxhuntGenerator, FoxhuntHypothesis, FoxhuntObservation};

opaque!(
    /// Locates one stationary source by bearings of which some are outliers, mirrored, biased or correlated.
    FoxhuntRobust = b"fxRo": robust::Config, Robust = Robust::EMPTY
);

/// All bearings have one bias in common: a value of `biases`.
pub const FOXHUNT_BIASES_COMMON: u32 = 0;
/// Those of one station have one: a value of `biases`.
pub const FOXHUNT_BIASES_PER_STATION: u32 = 1;
/// Those of one direction, as seen from the array, have one: a value of `biases`.
pub const FOXHUNT_BIASES_BY_DIRECTION: u32 = 2;

/// What a robust locator can be told. A zero switches a part of the errors off. `INFINITY` is a value.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntRobustConfig {
    /// Rate of direct bearings: what the other two leave of 1.
    pub direct: f32,
    /// Rate of mirrored bearings, 0 to 0.9.
    pub mirrored: f32,
    /// Rate of outliers, 0.001 to 0.9.
    pub outlier: f32,
    /// How many observed bearings the rates weigh as much as, at least 1. Infinity keeps them as they are.
    pub prior_bearings: f32,
    /// How many times as large as stated the standard deviations are, 0.1 to 10.
    pub sigma_scale: f32,
    /// Standard deviation of the natural logarithm of that scale before any bearing, 0 to 1.5; zero keeps the scale.
    pub scale_sigma: f32,
    /// Standard deviation of the error that bearings of one place have in common; radians, 0 to 1.
    pub stop_sigma_rad: f32,
    /// Standard deviation of the bias; radians, 0 to 0.5.
    pub bias_sigma_rad: f32,
    /// Which bearings have a bias in common: `FOXHUNT_BIASES_COMMON` and so on.
    pub biases: u32,
    /// Standard deviation of each coordinate of the places of bearings; metres, 0 to 1000.
    pub position_sigma_m: f32,
    /// Correlation of two bearings that are taken one after the other at one place, 0 to 0.999.
    pub correlation_at_rest: f32,
    /// It falls by a factor of e over this fraction of the range to the source, 0 to 1.
    pub correlation_distance: f32,
    /// And over so many metres, if that is farther, 0 to 1e6.
    pub correlation_distance_m: f32,
    /// And over this many seconds, at least 0.001.
    pub correlation_time_s: f32,
    /// Range from which on all orders of magnitude are as likely; metres, 0.01 to 1e6.
    pub nearest_m: f32,
    /// Range up to which they are, at least as large, up to 1e6.
    pub range_m: f32,
    /// Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
    pub relative_range_sigma: f32,
    /// Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
    pub resample_below: f32,
    /// Moves of every particle after a resampling, 1 to 16.
    pub moves: u32,
}

plain!(FoxhuntRobustConfig);

impl From<robust::Config> for FoxhuntRobustConfig {
    fn from(config: robust::Config) -> Self {
        let errors = config.errors;
        Self {
            direct: errors.rates.direct,
            mirrored: errors.rates.mirrored,
            outlier: errors.rates.outlier,
            prior_bearings: errors.prior_bearings,
            sigma_scale: errors.sigma_scale,
            scale_sigma: errors.scale_sigma,
            stop_sigma_rad: errors.stop_sigma_rad,
            bias_sigma_rad: errors.bias_sigma_rad,
            biases: match errors.biases {
                Biases::Common => FOXHUNT_BIASES_COMMON,
                Biases::PerStation => FOXHUNT_BIASES_PER_STATION,
                Biases::ByDirection => FOXHUNT_BIASES_BY_DIRECTION,
            },
            position_sigma_m: errors.position_sigma_m,
            correlation_at_rest: errors.correlation.at_rest,
            correlation_distance: errors.correlation.distance,
            correlation_distance_m: errors.correlation.distance_m,
            correlation_time_s: errors.correlation.time_s,
            nearest_m: config.nearest_m,
            range_m: config.range_m,
            relative_range_sigma: config.relative_range_sigma,
            resample_below: config.resample_below,
            moves: config.moves.into(),
        }
    }
}

impl Told for FoxhuntRobustConfig {
    type Rust = robust::Config;

    fn to_rust(self) -> Result<robust::Config, Fault> {
        let errors = Errors {
            rates: Mixture {
                direct: self.direct,
                mirrored: self.mirrored,
                outlier: self.outlier,
            },
            prior_bearings: self.prior_bearings,
            sigma_scale: self.sigma_scale,
            scale_sigma: self.scale_sigma,
            stop_sigma_rad: self.stop_sigma_rad,
            bias_sigma_rad: self.bias_sigma_rad,
            biases: match self.biases {
                FOXHUNT_BIASES_COMMON => Biases::Common,
                FOXHUNT_BIASES_PER_STATION => Biases::PerStation,
                FOXHUNT_BIASES_BY_DIRECTION => Biases::ByDirection,
                _ => return Err(ConfigError::new("biases must be from 0 to 2").into()),
            },
            position_sigma_m: self.position_sigma_m,
            correlation: Correlation {
                at_rest: self.correlation_at_rest,
                distance: self.correlation_distance,
                distance_m: self.correlation_distance_m,
                time_s: self.correlation_time_s,
            },
        };
        Ok(robust::Config {
            errors,
            nearest_m: self.nearest_m,
            range_m: self.range_m,
            relative_range_sigma: self.relative_range_sigma,
            resample_below: self.resample_below,
            moves: u8::try_from(self.moves).unwrap_or(u8::MAX),
        })
    }

    fn check(config: &robust::Config) -> Result<(), ConfigError> {
        Robust::check(config)
    }
}

/// Fills a configuration for any direction finder, in a room or on a vehicle: a source a metre to 20 km away.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_config_default(config: *mut FoxhuntRobustConfig) -> FoxhuntResult {
    locator::write(config, robust::Config::DEFAULT.into())
}

/// Fills a configuration for a vehicle in a city.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_config_city(config: *mut FoxhuntRobustConfig) -> FoxhuntResult {
    locator::write(config, robust::Config::CITY.into())
}

/// Fills a configuration for fixed arrays round a room.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_config_room(config: *mut FoxhuntRobustConfig) -> FoxhuntResult {
    locator::write(config, robust::Config::ROOM.into())
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_config_fault(config: *const FoxhuntRobustConfig) -> FoxhuntText {
    locator::fault(config)
}

/// Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_init(
    locator: *mut FoxhuntRobust,
    size: usize,
    config: *const FoxhuntRobustConfig,
) -> FoxhuntResult {
    locator::init(locator, size, config)
}

/// Forgets the source, its bearings and what they have taught.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_reset(locator: *mut FoxhuntRobust) -> FoxhuntResult {
    locator::reset(locator)
}

/// Takes a bearing, and says what is known with it; `answer` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_push(
    locator: *mut FoxhuntRobust,
    observation: *const FoxhuntObservation,
    generator: *mut FoxhuntGenerator,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    locator::push(locator, observation, generator, answer)
}

/// What is known of the source.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_answer(
    locator: *const FoxhuntRobust,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    locator::answer(locator, answer)
}

/// A place where the source may be, of up to four, before a fix, too: `FOXHUNT_RESULT_NOTHING` beyond the last index.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_hypothesis(
    locator: *const FoxhuntRobust,
    index: u32,
    hypothesis: *mut FoxhuntHypothesis,
) -> FoxhuntResult {
    locator::hypothesis(locator, index, hypothesis)
}
