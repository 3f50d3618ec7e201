//! What became of the lines.

use core::fmt;

use super::tally::Tally;
use crate::snapshot::value;

/// Why a line was not used. The state of the locator is as if it had not been there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rejected {
    /// A sentence whose checksum is wrong or missing.
    Checksum,
    /// The line is longer than any of its kind.
    Overlong,
    /// The line is of no known kind, or a field of it is missing or malformed.
    Unparsable,
    /// The receiver says that it has no position, or that its heading is void; or it says how the vehicle heads
    /// or moves before it has stated any time.
    NoFix,
    /// The receiver reports 0 degrees north and east: what many send before their first fix.
    NullPosition,
    /// A time stamp earlier than the one before it.
    TimeBackwards,
    /// A coordinate, angle or quality outside its range, or a place too far from [`super::Vehicle::plane`].
    OutOfRange,
    /// A bearing before there was any position.
    NoPosition,
    /// A bearing whose nearest position is older than [`super::Settings::maximum_age_ms`], or as much newer. Or
    /// one whose line states no time, after [`super::Settings::undated_bearings`] others at the same time of the
    /// receiver, or when that has just run backwards.
    StalePosition,
    /// A relative bearing with neither a fresh true heading nor a course of a vehicle that moves.
    NoHeading,
    /// A relative bearing of a vehicle whose heading is only known by its course, in a bend: see
    /// [`super::Settings::maximum_turn_rate_deg_s`].
    Turning,
    /// A bearing of a quality below [`super::Settings::minimum_quality`].
    LowQuality,
    /// A bearing on another frequency than [`super::Settings::kraken_frequency_hz`].
    OtherFrequency,
    /// A bearing on another tag than [`super::Settings::ublox_tag`].
    OtherTag,
    /// A bearing of another direction finder than [`super::Settings::finder`].
    OtherFinder,
}

impl Rejected {
    /// Every reason, in the order of the status sentence.
    pub const ALL: [Self; 15] = [
        Self::Checksum,
        Self::Overlong,
        Self::Unparsable,
        Self::NoFix,
        Self::NullPosition,
        Self::TimeBackwards,
        Self::OutOfRange,
        Self::NoPosition,
        Self::StalePosition,
        Self::NoHeading,
        Self::Turning,
        Self::LowQuality,
        Self::OtherFrequency,
        Self::OtherTag,
        Self::OtherFinder,
    ];
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Checksum => "checksum is wrong or missing",
            Self::Overlong => "line is too long",
            Self::Unparsable => "line cannot be parsed",
            Self::NoFix => "receiver has no fix",
            Self::NullPosition => "position is 0 degrees north and east",
            Self::TimeBackwards => "time runs backwards",
            Self::OutOfRange => "value is out of range",
            Self::NoPosition => "no position yet",
            Self::StalePosition => "position is too old",
            Self::NoHeading => "heading is unknown",
            Self::Turning => "vehicle is turning and its heading is unknown",
            Self::LowQuality => "quality is too low",
            Self::OtherFrequency => "frequency is another",
            Self::OtherTag => "tag is another",
            Self::OtherFinder => "direction finder is another",
        })
    }
}

impl core::error::Error for Rejected {}

/// How many lines there were of each kind. Counts stay at their maximum when they reach it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// All lines that were not empty.
    pub lines: u32,
    /// NMEA sentences that were used.
    pub sentences: u32,
    /// Bearings that the locator was given.
    pub bearings: u32,
    /// Correct sentences of kinds that are of no use here.
    pub ignored: u32,
    rejected: Tally<{ Rejected::ALL.len() }>,
}

impl Counters {
    pub(super) const fn new() -> Self {
        Self {
            lines: 0,
            sentences: 0,
            bearings: 0,
            ignored: 0,
            rejected: Tally::new(),
        }
    }

    /// How many lines were rejected for this reason.
    pub fn rejected(&self, reason: Rejected) -> u32 {
        self.rejected.get(reason as usize)
    }

    pub(super) fn reject(&mut self, reason: Rejected) {
        self.rejected.add(reason as usize);
    }
}

value!(Counters {
    lines,
    sentences,
    bearings,
    ignored,
    rejected,
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_counted_in_its_place() {
        for (place, reason) in Rejected::ALL.into_iter().enumerate() {
            assert_eq!(reason as usize, place);
            let mut counters = Counters::new();
            counters.reject(reason);
            for other in Rejected::ALL {
                assert_eq!(counters.rejected(other), u32::from(other == reason));
            }
        }
    }
}
