//! What all locators have in common.

use foxhunt::ConfigError;
use foxhunt::aoa::Locate;

use crate::door::{self, Opaque, Out, Plain};
use crate::result::{FoxhuntResult, FoxhuntText, code};
use crate::words::{
    FoxhuntAnswer, FoxhuntGenerator, FoxhuntHypothesis, FoxhuntObservation, FoxhuntSource, draw,
};

/// Why a configuration is refused.
pub enum Fault {
    /// It, or what it points to, cannot be read.
    Unreadable(FoxhuntResult),
    /// A field is out of range.
    Field(ConfigError),
}

impl Fault {
    /// What it says: where it is a field, its name and what it may be.
    pub fn message(self) -> FoxhuntText {
        match self {
            Self::Unreadable(result) => result.text(),
            Self::Field(error) => in_c(&error).into(),
        }
    }
}

impl From<FoxhuntResult> for Fault {
    fn from(result: FoxhuntResult) -> Self {
        Self::Unreadable(result)
    }
}

impl From<ConfigError> for Fault {
    fn from(error: ConfigError) -> Self {
        Self::Field(error)
    }
}

impl From<Fault> for FoxhuntResult {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Unreadable(result) => result,
            Fault::Field(_) => Self::Config,
        }
    }
}

/// The message of an error with the name that the field has in C.
fn in_c(error: &ConfigError) -> &'static str {
    const RENAMED: [(&str, &str); 7] = [
        ("rates", "direct, mirrored and outlier must add up to 1"),
        ("at_rest", "correlation_at_rest must be from 0 to 0.999"),
        ("distance", "correlation_distance must be from 0 to 1"),
        ("distance_m", "correlation_distance_m must be from 0 to 1e6"),
        ("time_s", "correlation_time_s must be at least 0.001"),
        ("heading_deg", "station_heading_deg must be from 0 to 360"),
        (
            "range_dbm",
            "lowest_dbm and highest_dbm must be 10 dB or more apart, from -128 to 127",
        ),
    ];
    let renamed = RENAMED.iter().find(|(name, _)| *name == error.field());
    renamed.map_or(error.message(), |(_, message)| message)
}

/// A configuration as C has it.
pub trait Told: Plain {
    /// As the library has it.
    type Rust;

    /// In the library's words.
    ///
    /// # Errors
    /// Of a pointer in it, or of a field whose value means nothing.
    fn to_rust(self) -> Result<Self::Rust, Fault>;

    /// Checks it.
    ///
    /// # Errors
    /// Names the field that is out of range.
    fn check(config: &Self::Rust) -> Result<(), ConfigError>;
}

/// The configuration at a pointer, checked.
pub fn checked<C: Told>(config: *const C) -> Result<C::Rust, Fault> {
    let config = door::get(config)?.to_rust()?;
    C::check(&config)?;
    Ok(config)
}

/// What is wrong with a configuration: the name of the first field that is out of range, and what it may be. Nothing, if it
/// is right.
pub fn fault<C: Told>(config: *const C) -> FoxhuntText {
    match checked(config) {
        Ok(_) => "".into(),
        Err(fault) => fault.message(),
    }
}

/// Writes a configuration.
pub fn write<C: Copy>(config: *mut C, value: C) -> FoxhuntResult {
    code(Out::new(config).map(|out| out.write(value)))
}

/// Makes an empty locator or gateway.
pub fn init<T: Opaque, C: Told<Rust = T::Config>>(
    storage: *mut T,
    size: usize,
    config: *const C,
) -> FoxhuntResult {
    let result = || {
        let config = checked(config)?;
        door::init(storage, size, config)
    };
    code(result())
}

/// Forgets all.
pub fn reset<T: Opaque<State: Locate>>(locator: *mut T) -> FoxhuntResult {
    code(door::change(locator, |_, state| state.reset()))
}

/// Takes a bearing.
pub fn push<T: Opaque>(
    locator: *mut T,
    observation: *const FoxhuntObservation,
    generator: *mut FoxhuntGenerator,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult
where
    T::State: Locate<Config = T::Config>,
{
    let result = || {
        let out = Out::optional(answer)?;
        let observation = door::get(observation)?.to_rust()?;
        let answer = door::change(locator, |config, state| {
            draw(generator, |rng| state.push(&observation, config, rng))
        })???;
        out.write(answer.into());
        Ok(())
    };
    code(result())
}

/// What is known.
pub fn answer<T: Opaque<State: Locate>>(
    locator: *const T,
    answer: *mut FoxhuntAnswer,
) -> FoxhuntResult {
    let result = || {
        let out = Out::new(answer)?;
        out.write(door::look(locator, |_, state| state.answer())?.into());
        Ok(())
    };
    code(result())
}

/// A hypothesis.
pub fn hypothesis<T: Opaque<State: Locate>>(
    locator: *const T,
    index: u32,
    hypothesis: *mut FoxhuntHypothesis,
) -> FoxhuntResult {
    let result = || {
        let out = Out::new(hypothesis)?;
        let found = door::look(locator, |_, state| state.hypothesis(index as usize))?;
        out.write(found.ok_or(FoxhuntResult::Nothing)?.into());
        Ok(())
    };
    code(result())
}

/// A source.
pub fn source<T: Opaque<State: Locate>>(
    locator: *const T,
    index: u32,
    source: *mut FoxhuntSource,
) -> FoxhuntResult {
    let result = || {
        let out = Out::new(source)?;
        let found = door::look(locator, |_, state| state.source(index as usize))?;
        out.write(found.ok_or(FoxhuntResult::Nothing)?.into());
        Ok(())
    };
    code(result())
}
