//! The locator of several sources, any of which may drive off.

use foxhunt::ConfigError;
use foxhunt::aoa::{Locate, manoeuvring, multi, presets};

use crate::door::{opaque, plain};
use crate::locator::{self, Fault, Told};
use crate::result::{FoxhuntResult, FoxhuntText};
use crate::robust::FoxhuntRobustConfig;
use crate::types::{Several, SeveralConfig};
use crate::words::{FoxhuntAnswer, FoxhuntGenerator, FoxhuntObservation, FoxhuntSource};

opaque!(
    /// Locates several sources, stationary or manoeuvring, by bearings of which some are wrong.
    FoxhuntSeveral = b"fxSe": SeveralConfig, Several = Several::EMPTY
);

/// What a locator of several sources can be told.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntSeveralConfig {
    /// What is believed of the bearings, and of a source at rest.
    pub stationary: FoxhuntRobustConfig,
    /// Root mean square of the speed of the fastest source that is thought of, in metres a second, 0.05 to 100.
    pub speed_m_s: f32,
    /// The same of the slowest, at least 0.05 and at most as large.
    pub slowest_m_s: f32,
    /// Mean time for which a source is stationary, in seconds, 1 to 1e6.
    pub stationary_s: f32,
    /// Mean time for which it moves before it stops again, in seconds, 1 to 1e6.
    pub moving_s: f32,
    /// Mean time for which it moves straight on, in seconds, 1 to 1e5.
    pub straight_s: f32,
    /// Probability that outliers ever look like one more source, 1e-9 to 0.5.
    pub false_initiation: f32,
    /// Probability that a source is given up though it is still heard as often as before, 1e-9 to 0.5.
    pub false_deletion: f32,
}

plain!(FoxhuntSeveralConfig);

impl From<SeveralConfig> for FoxhuntSeveralConfig {
    fn from(config: SeveralConfig) -> Self {
        let track = config.track;
        Self {
            stationary: track.stationary.into(),
            speed_m_s: track.speed_m_s,
            slowest_m_s: track.slowest_m_s,
            stationary_s: track.stationary_s,
            moving_s: track.moving_s,
            straight_s: track.straight_s,
            false_initiation: config.false_initiation,
            false_deletion: config.false_deletion,
        }
    }
}

impl Told for FoxhuntSeveralConfig {
    type Rust = SeveralConfig;

    fn to_rust(self) -> Result<SeveralConfig, Fault> {
        let track = manoeuvring::Config {
            stationary: self.stationary.to_rust()?,
            speed_m_s: self.speed_m_s,
            slowest_m_s: self.slowest_m_s,
            stationary_s: self.stationary_s,
            moving_s: self.moving_s,
            straight_s: self.straight_s,
        };
        Ok(multi::Config {
            track,
            false_initiation: self.false_initiation,
            false_deletion: self.false_deletion,
        })
    }

    fn check(config: &SeveralConfig) -> Result<(), ConfigError> {
        Several::check(config)
    }
}

/// Fills a configuration for sources in a city, of which any may drive off.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_config_city(config: *mut FoxhuntSeveralConfig) -> FoxhuntResult {
    locator::write(config, presets::CITY.into())
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_config_fault(config: *const FoxhuntSeveralConfig) -> FoxhuntText {
    locator::fault(config)
}

/// Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_init(
    locator: *mut FoxhuntSeveral,
    size: usize,
    config: *const FoxhuntSeveralConfig,
) -> FoxhuntResult {
    locator::init(locator, size, config)
}

/// Forgets all sources and their bearings.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_reset(locator: *mut FoxhuntSeveral) -> FoxhuntResult {
    locator::reset(locator)
}

/// Takes a bearing, and says what is known with it of the best known source; `answer` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_push(
    locator: *mut FoxhuntSeveral,
    observation: *const FoxhuntObservation,
    generator: *mut FoxhuntGenerator,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    locator::push(locator, observation, generator, answer)
}

/// The source of this index among those with a fix, the best known first: `FOXHUNT_RESULT_NOTHING` beyond the last.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_several_source(
    locator: *const FoxhuntSeveral,
    index: u32,
    source: *mut FoxhuntSource,
) -> FoxhuntResult {
    locator::source(locator, index, source)
}
