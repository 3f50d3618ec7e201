//! How configurations are checked.

use core::fmt;

/// A field of a configuration that is out of range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ConfigError {
    message: &'static str,
}

impl ConfigError {
    /// An error whose `message` begins with the name of the field and says what the field may be.
    pub const fn new(message: &'static str) -> Self {
        Self { message }
    }

    /// The name of the field. Where one configuration holds another, this is the innermost field alone, without the fields
    /// that lead to it.
    pub fn field(&self) -> &'static str {
        self.message.split(' ').next().unwrap_or_default()
    }

    /// The name of the field and what it may be.
    pub const fn message(&self) -> &'static str {
        self.message
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message)
    }
}

impl core::error::Error for ConfigError {}

/// Checks a configuration while it compiles.
///
/// A configuration is a plain struct with one public field for each thing that can be told, with the unit in its name, a
/// `DEFAULT`, and a `check` whose error names the field:
///
/// ```
/// use foxhunt::aoa::clean::Config;
///
/// const CONFIG: Config = foxhunt::config!(Config { moves: 3, ..Config::DEFAULT });
/// let wrong = Config { moves: 0, ..Config::DEFAULT };
/// assert_eq!(wrong.check().unwrap_err().field(), "moves");
/// ```
///
/// A value that is out of range does not compile:
///
/// ```compile_fail
/// use foxhunt::aoa::clean::Config;
///
/// const CONFIG: Config = foxhunt::config!(Config { moves: 0, ..Config::DEFAULT });
/// ```
#[macro_export]
macro_rules! config {
    ($config:expr) => {
        const {
            let config = $config;
            if let Err(error) = config.check() {
                panic!("{}", error.message());
            }
            config
        }
    };
}

/// Returns from a `check` with a [`ConfigError`] unless a condition holds. Write it so that NaN makes it
/// false.
macro_rules! require {
    ($holds:expr, $message:literal) => {
        let holds = $holds;
        if !holds {
            return Err($crate::ConfigError::new($message));
        }
    };
}
pub(crate) use require;

/// Returns from a `check` with a [`ConfigError`] unless each field is within its range: the call
/// `require_within!(self: moves 1..=16, tempering 0.05..=1.0)`. False for NaN.
macro_rules! require_within {
    ($config:ident: $($field:ident $least:literal..=$most:literal),+ $(,)?) => {$(
        if !($config.$field >= $least && $config.$field <= $most) {
            return Err($crate::ConfigError::new(concat!(
                stringify!($field), " must be from ", $least, " to ", $most
            )));
        }
    )+};
}
pub(crate) use require_within;

/// Returns from a `check` with the error of a part of the configuration, if there is one.
macro_rules! require_all {
    ($($part:expr),+ $(,)?) => {$(
        if let Err(error) = $part.check() {
            return Err(error);
        }
    )+};
}
pub(crate) use require_all;

/// Returns from a `check` with a [`ConfigError`] unless each field is positive, finite, and not so small that its inverse is
/// infinite.
macro_rules! require_positive {
    ($config:ident: $($field:ident),+ $(,)?) => {$(
        if !($config.$field >= f32::MIN_POSITIVE && $config.$field <= f32::MAX) {
            return Err($crate::ConfigError::new(concat!(
                stringify!($field), " must be positive and finite"
            )));
        }
    )+};
}
pub(crate) use require_positive;
