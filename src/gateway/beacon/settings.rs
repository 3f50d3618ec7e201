//! How a gateway behaves.

use core::fmt;

/// How messages come over the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Framing {
    /// `$PFOXB` sentences.
    #[default]
    Lines,
    /// Binary frames, stuffed so that a zero ends each: a third of the bytes, and a better checksum.
    Frames,
}

/// How a [`super::BeaconGateway`] treats its messages; how it tracks is up to its
/// [`Site`](crate::fingerprint::tracker::Site).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    pub(super) framing: Framing,
    pub(super) seed: u64,
    pub(super) silence_ms: u32,
}

/// Which of the [`Settings`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `silence_ms` is not within a second and an hour.
    Silence,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Silence => "silence is not within a second and an hour",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// Sentences, and five seconds until a radio is silent.
    pub const fn new() -> Self {
        Self {
            framing: Framing::Lines,
            seed: 1,
            silence_ms: 5_000,
        }
    }

    /// How messages come. Reports are sentences in either case.
    pub const fn with_framing(mut self, framing: Framing) -> Self {
        self.framing = framing;
        self
    }

    /// Seeds the particles; the same bytes with the same seed give the same reports. Initially 1.
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// A radio that has heard nothing for so many milliseconds, while others have, is reported as silent.
    ///
    /// # Errors
    /// [`SettingsError::Silence`] when it is not within a second and an hour.
    pub const fn with_silence_ms(mut self, silence: u32) -> Result<Self, SettingsError> {
        if silence < 1_000 || silence > 3_600_000 {
            return Err(SettingsError::Silence);
        }
        self.silence_ms = silence;
        Ok(self)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}
