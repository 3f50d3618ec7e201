//! What became of the messages.

use core::fmt;

use crate::gateway::tally::Tally;

/// Why a message was not used. The trackers are as if it had not been there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rejected {
    /// The checksum is wrong or missing.
    Checksum,
    /// The message is longer than any.
    Overlong,
    /// The message is of no known kind, or a field of it is missing or malformed.
    Unparsable,
    /// A number that its field cannot hold, or a signal strength that no receiver measures.
    OutOfRange,
    /// The map does not know the radio.
    UnknownRadio,
    /// The packet is older than one of the same tag that was used.
    TimeBackwards,
}

impl Rejected {
    /// Every reason, in the order of the status sentence.
    pub const ALL: [Self; 6] = [
        Self::Checksum,
        Self::Overlong,
        Self::Unparsable,
        Self::OutOfRange,
        Self::UnknownRadio,
        Self::TimeBackwards,
    ];
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Checksum => "checksum is wrong or missing",
            Self::Overlong => "message is too long",
            Self::Unparsable => "message cannot be parsed",
            Self::OutOfRange => "value is out of range",
            Self::UnknownRadio => "radio is not in the map",
            Self::TimeBackwards => "time runs backwards",
        })
    }
}

impl core::error::Error for Rejected {}

/// How many messages there were of each kind. Counts stay at their maximum when they reach it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// All messages that were not empty.
    pub messages: u32,
    /// Packets that a tracker was given.
    pub packets: u32,
    /// Correct sentences of kinds that are of no use here.
    pub ignored: u32,
    /// Trackers that were taken from one tag and given to another.
    pub evicted: u32,
    rejected: Tally<{ Rejected::ALL.len() }>,
}

impl Counters {
    pub(super) const fn new() -> Self {
        Self {
            messages: 0,
            packets: 0,
            ignored: 0,
            evicted: 0,
            rejected: Tally::new(),
        }
    }

    /// How many messages were rejected for this reason.
    pub fn rejected(&self, reason: Rejected) -> u32 {
        self.rejected.get(reason as usize)
    }

    pub(super) fn reject(&mut self, reason: Rejected) {
        self.rejected.add(reason as usize);
    }
}

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
