//! What a tracker takes a walk and a radio for.

use core::fmt;

/// How a tag moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motion {
    /// Standard deviation of its velocity along an axis when nothing is known of it, in metres a second.
    pub velocity_m_s: f32,
    /// Variance that its velocity gains every second, in (m/s)^2 / s.
    pub agility: f32,
    /// Seconds after which a velocity is as good as forgotten (has fallen to 1/e); infinite for one that stays.
    pub memory_s: f32,
}

impl Motion {
    /// A person on foot, who stops and turns: 0.5 m/s, 0.09 (m/s)^2 / s, 7 s.
    pub const fn new() -> Self {
        Self {
            velocity_m_s: 0.5,
            agility: 0.09,
            memory_s: 7.0,
        }
    }
}

impl Default for Motion {
    fn default() -> Self {
        Self::new()
    }
}

/// How readings differ from the map.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Channel {
    /// Standard deviation, in dB, of what a walk differs from the survey by at one place, however many packets are
    /// averaged.
    pub mismatch_db: f32,
    /// How many readings of each beacon the survey took at each point.
    pub survey_samples: u16,
    /// The power to which likelihoods are raised: below 1 because readings that follow each other err alike.
    pub tempering: f32,
    /// Readings further off than so many deviations count as if they were as far: none of them excludes a place.
    /// Infinite for errors that are normal.
    pub gate_deviations: f32,
    /// The lowest and the highest strength, in dBm, that a radio can report.
    pub range_dbm: [f32; 2],
}

impl Channel {
    /// As measured in an office: 3.5 dB, 50 samples, a power of 1/4, 2.65 deviations, -110 to -10 dBm.
    pub const fn new() -> Self {
        Self {
            mismatch_db: 3.464,
            survey_samples: 50,
            tempering: 0.25,
            gate_deviations: 2.646,
            range_dbm: [-110.0, -10.0],
        }
    }
}

impl Default for Channel {
    fn default() -> Self {
        Self::new()
    }
}

/// How a tag may differ from the one that the survey was made with.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Offset {
    /// The probability that it does at all. At 0 no offset is estimated.
    pub probability: f32,
    /// Standard deviation, in dB, of its offset if it does.
    pub deviation_db: f32,
    /// Variance that the offset gains every second, in dB^2 / s: how it is worn.
    pub drift: f32,
}

impl Offset {
    /// One tag in ten, by 8 dB; 0.3 dB^2 / s.
    pub const fn new() -> Self {
        Self {
            probability: 0.1,
            deviation_db: 8.0,
            drift: 0.3,
        }
    }
}

impl Default for Offset {
    fn default() -> Self {
        Self::new()
    }
}

/// How a [`super::Tracker`] works; the defaults track people by Bluetooth.
///
/// ```
/// use foxhunt::fingerprint::tracker::{Motion, Settings};
///
/// const CART: Motion = Motion { velocity_m_s: 3.0, ..Motion::new() };
/// let settings = Settings::new().with_motion(CART)?;
/// # Ok::<(), foxhunt::fingerprint::tracker::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    pub(super) motion: Motion,
    pub(super) channel: Channel,
    pub(super) offset: Offset,
    pub(super) window_ms: u32,
    pub(super) recovery: f32,
    pub(super) uncertain_m: f32,
}

/// Which of the [`Settings`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `velocity_m_s` is not within 0.01 and 100.
    Velocity,
    /// `agility` is not within 0.0001 and 1000.
    Agility,
    /// `memory_s` is below 0.1 or NaN.
    Memory,
    /// `mismatch_db` is not within 0.1 and 30.
    Mismatch,
    /// `survey_samples` is 0.
    SurveySamples,
    /// `tempering` is not within 0.01 and 1.
    Tempering,
    /// `gate_deviations` is below 0.5 or NaN.
    Gate,
    /// `range_dbm` is not an interval of at least 10 dB within -128 and 127 dBm.
    Range,
    /// `probability` is not within 0 and 0.99.
    OffsetProbability,
    /// `deviation_db` is not within 0.1 and 50.
    OffsetDeviation,
    /// `drift` is not within 0 and 100.
    OffsetDrift,
    /// `window_ms` is longer than a minute.
    Window,
    /// `recovery` is not within 0 and 1.
    Recovery,
    /// `uncertain_m` is not positive and finite.
    Uncertain,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity => "velocity_m_s is not within 0.01 and 100",
            Self::Agility => "agility is not within 0.0001 and 1000",
            Self::Memory => "memory_s is below 0.1",
            Self::Mismatch => "mismatch_db is not within 0.1 and 30",
            Self::SurveySamples => "survey_samples is 0",
            Self::Tempering => "tempering is not within 0.01 and 1",
            Self::Gate => "gate_deviations is below 0.5",
            Self::Range => "range_dbm is not an interval of 10 dB within -128 and 127",
            Self::OffsetProbability => "probability of an offset is not within 0 and 0.99",
            Self::OffsetDeviation => "deviation_db of the offset is not within 0.1 and 50",
            Self::OffsetDrift => "drift of the offset is not within 0 and 100",
            Self::Window => "window_ms is longer than a minute",
            Self::Recovery => "recovery is not within 0 and 1",
            Self::Uncertain => "uncertain_m is not positive and finite",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// The defaults of [`Motion`], [`Channel`] and [`Offset`]; packets of half a second together; a third of the
    /// particles for a way back; uncertain from 5 m on.
    pub const fn new() -> Self {
        Self {
            motion: Motion::new(),
            channel: Channel::new(),
            offset: Offset::new(),
            window_ms: 500,
            recovery: 1.0 / 3.0,
            uncertain_m: 5.0,
        }
    }

    /// How a tag moves.
    ///
    /// # Errors
    /// When a field is out of its range.
    pub const fn with_motion(mut self, motion: Motion) -> Result<Self, SettingsError> {
        if !within(motion.velocity_m_s, 0.01, 100.0) {
            return Err(SettingsError::Velocity);
        }
        if !within(motion.agility, 1e-4, 1e3) {
            return Err(SettingsError::Agility);
        }
        if !within(motion.memory_s, 0.1, f32::INFINITY) {
            return Err(SettingsError::Memory);
        }
        self.motion = motion;
        Ok(self)
    }

    /// How readings differ from the map.
    ///
    /// # Errors
    /// When a field is out of its range.
    pub const fn with_channel(mut self, channel: Channel) -> Result<Self, SettingsError> {
        if !within(channel.mismatch_db, 0.1, 30.0) {
            return Err(SettingsError::Mismatch);
        }
        if channel.survey_samples == 0 {
            return Err(SettingsError::SurveySamples);
        }
        if !within(channel.tempering, 0.01, 1.0) {
            return Err(SettingsError::Tempering);
        }
        if !within(channel.gate_deviations, 0.5, f32::INFINITY) {
            return Err(SettingsError::Gate);
        }
        let [lowest, highest] = channel.range_dbm;
        if !(lowest >= -128.0 && highest <= 127.0 && highest - lowest >= 10.0) {
            return Err(SettingsError::Range);
        }
        self.channel = channel;
        Ok(self)
    }

    /// How a tag may differ from the one of the survey.
    ///
    /// # Errors
    /// When a field is out of its range.
    pub const fn with_offset(mut self, offset: Offset) -> Result<Self, SettingsError> {
        if !within(offset.probability, 0.0, 0.99) {
            return Err(SettingsError::OffsetProbability);
        }
        if !within(offset.deviation_db, 0.1, 50.0) {
            return Err(SettingsError::OffsetDeviation);
        }
        if !within(offset.drift, 0.0, 100.0) {
            return Err(SettingsError::OffsetDrift);
        }
        self.offset = offset;
        Ok(self)
    }

    /// Packets of so many milliseconds make one update, at their mean time; 0 for an update by every packet. Those of
    /// one beacon are averaged, so the work of an update does not grow with them.
    ///
    /// # Errors
    /// [`SettingsError::Window`] when it is longer than a minute.
    pub const fn with_window_ms(mut self, window: u32) -> Result<Self, SettingsError> {
        if window > 60_000 {
            return Err(SettingsError::Window);
        }
        self.window_ms = window;
        Ok(self)
    }

    /// The share of the particles that is drawn anew, from the match with the map, when the evidence has gone against
    /// where they are.
    ///
    /// # Errors
    /// [`SettingsError::Recovery`] when it is not within 0 and 1.
    pub const fn with_recovery(mut self, share: f32) -> Result<Self, SettingsError> {
        if !within(share, 0.0, 1.0) {
            return Err(SettingsError::Recovery);
        }
        self.recovery = share;
        Ok(self)
    }

    /// The standard deviation, in metres along the worst direction, from which on a place is uncertain.
    ///
    /// # Errors
    /// [`SettingsError::Uncertain`] when it is not positive and finite.
    pub const fn with_uncertain_m(mut self, deviation: f32) -> Result<Self, SettingsError> {
        if !(deviation > 0.0 && deviation < f32::INFINITY) {
            return Err(SettingsError::Uncertain);
        }
        self.uncertain_m = deviation;
        Ok(self)
    }

    /// Whether a radio can report such a strength.
    pub fn accepts(&self, rssi_dbm: f32) -> bool {
        let [lowest, highest] = self.channel.range_dbm;
        rssi_dbm >= lowest && rssi_dbm <= highest
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}

/// Not if it is NaN.
const fn within(value: f32, least: f32, most: f32) -> bool {
    value >= least && value <= most
}
