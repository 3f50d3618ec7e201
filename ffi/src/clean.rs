//! The locator for clean bearings.

use foxhunt::ConfigError;
use foxhunt::aoa::{Locate, clean};

use crate::door::{opaque, plain};
use crate::locator::{self, Fault, Told};
use crate::result::{FoxhuntResult, FoxhuntText};
use crate::types::Clean;
use crate::words::{FoxhuntAnswer, FoxhuntGenerator, FoxhuntObservation};

opaque!(
    /// Locates one stationary source by bearings of which none is an outlier.
    FoxhuntClean = b"fxCl": clean::Config, Clean = Clean::EMPTY
);

/// What a locator for clean bearings can be told.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntCleanConfig {
    /// Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
    pub relative_range_sigma: f32,
    /// Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
    pub resample_below: f32,
    /// Moves of every particle after a resampling, 1 to 16.
    pub moves: u32,
}

plain!(FoxhuntCleanConfig);

impl From<clean::Config> for FoxhuntCleanConfig {
    fn from(config: clean::Config) -> Self {
        Self {
            relative_range_sigma: config.relative_range_sigma,
            resample_below: config.resample_below,
            moves: config.moves.into(),
        }
    }
}

impl Told for FoxhuntCleanConfig {
    type Rust = clean::Config;

    fn to_rust(self) -> Result<clean::Config, Fault> {
        Ok(clean::Config {
            relative_range_sigma: self.relative_range_sigma,
            resample_below: self.resample_below,
            // Out of range is out of range.
            moves: u8::try_from(self.moves).unwrap_or(u8::MAX),
            refinement: (),
        })
    }

    fn check(config: &clean::Config) -> Result<(), ConfigError> {
        Clean::check(config)
    }
}

/// Fills a configuration for a direction finder on a vehicle.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_config_default(config: *mut FoxhuntCleanConfig) -> FoxhuntResult {
    locator::write(config, clean::Config::DEFAULT.into())
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_config_fault(config: *const FoxhuntCleanConfig) -> FoxhuntText {
    locator::fault(config)
}

/// Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_init(
    locator: *mut FoxhuntClean,
    size: usize,
    config: *const FoxhuntCleanConfig,
) -> FoxhuntResult {
    locator::init(locator, size, config)
}

/// Forgets the source and its bearings.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_reset(locator: *mut FoxhuntClean) -> FoxhuntResult {
    locator::reset(locator)
}

/// Takes a bearing, and says what is known with it; `answer` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_push(
    locator: *mut FoxhuntClean,
    observation: *const FoxhuntObservation,
    generator: *mut FoxhuntGenerator,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    locator::push(locator, observation, generator, answer)
}

/// What is known of the source.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_clean_answer(
    locator: *const FoxhuntClean,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    locator::answer(locator, answer)
}
