//! What all locators have in common.

use foxhunt::ConfigError;
use foxhunt::aoa::Locate;

use crate::door::{self, Opaque, Out, Plain};
use crate::result::{FoxhuntResult, FoxhuntText, code};
use crate::words::{
    FoxhuntAnswer, FoxhuntGenerator, FoxhuntHypothesis, FoxhuntObservation, FoxhuntSource, draw,
};

/// A configuration as C has it.
pub trait Told: Plain {
    /// As the library has it.
    type Rust;

    /// In the library's words.
    ///
    /// # Errors
    /// Of a pointer in it, or of a value that means nothing.
    fn to_rust(self) -> Result<Self::Rust, FoxhuntResult>;

    /// Checks it.
    ///
    /// # Errors
    /// Names the field that is out of range.
    fn check(config: &Self::Rust) -> Result<(), ConfigError>;
}

/// The configuration at a pointer, checked.
pub fn checked<C: Told>(config: *const C) -> Result<C::Rust, FoxhuntResult> {
    let config = door::get(config)?.to_rust()?;
    match C::check(&config) {
        Ok(()) => Ok(config),
        Err(_) => Err(FoxhuntResult::Config),
    }
}

/// What is wrong with a configuration: the name of the first field that is out of range, and what it may be. Nothing, if it
/// is right.
pub fn fault<C: Told>(config: *const C) -> FoxhuntText {
    match door::get(config).and_then(C::to_rust) {
        Ok(config) => match C::check(&config) {
            Ok(()) => "".into(),
            Err(error) => error.message().into(),
        },
        Err(FoxhuntResult::Config) => "a number stands for nothing".into(),
        Err(_) => "a pointer is null or not aligned".into(),
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
    code(checked(config).and_then(|config| door::init(storage, size, config)))
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
