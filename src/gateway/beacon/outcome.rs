//! What messages lead to, and their counts.

use super::{MapPiece, Spot};
use crate::error::messages;
use crate::fingerprint::tracker::Fix;
use crate::gateway::outcome::reasons;
use crate::snapshot::value;

/// What a message led to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event {
    /// A packet was taken, and waits for others.
    Taken {
        /// Of this tag.
        tag: u32,
    },
    /// A packet led to an update.
    Fix {
        /// Of this tag.
        tag: u32,
        /// Where it is.
        fix: Fix,
    },
    /// The message was not used.
    Rejected(Rejected),
    /// The host has asked, and [`BeaconGateway::report`](super::BeaconGateway::report) answers.
    Queried,
    /// All tags were forgotten.
    Restarted,
    /// What radios hear of a tag is recorded as a survey from now on; no more if there is none.
    Survey(Option<Spot>),
    /// A piece of another map has come, for [`BeaconGateway::take_map`](super::BeaconGateway::take_map).
    MapPiece(MapPiece),
    /// A correct sentence of another kind.
    Other,
}

/// Why a message was not used. The trackers are as before.
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
    /// The radio is not in the map.
    UnknownRadio,
    /// The packet is older than one of the same tag that was used.
    TooOld,
    /// All trackers belong to other tags that are still heard.
    NoRoom,
}

reasons!(Rejected {
    Checksum => "checksum is wrong or missing",
    Overlong => "message is too long",
    Unparsable => "message cannot be parsed",
    OutOfRange => "value is out of range",
    UnknownRadio => "radio is not in the map",
    TooOld => "packet is too old",
    NoRoom => "no tracker is free",
});

/// How many messages there were of each kind. Counts stay at their maximum when they reach it.
///
/// Every message is counted once: packets, ignored sentences, queries, restarts and rejected messages add up to
/// `messages`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// All messages that were not empty.
    pub messages: u32,
    /// Packets that a tracker took.
    pub packets: u32,
    /// Correct sentences of other kinds.
    pub ignored: u32,
    /// Queries, and commands of a survey and of a new map.
    pub queries: u32,
    /// Restarts.
    pub restarts: u32,
    /// Trackers that were taken from one tag and given to another.
    pub evicted: u32,
    rejected: [u32; Rejected::ALL.len()],
}

value!(Counters {
    messages,
    packets,
    queries,
    restarts,
    ignored,
    evicted,
    rejected
});

impl Counters {
    pub(super) const EMPTY: Self = Self {
        messages: 0,
        packets: 0,
        ignored: 0,
        queries: 0,
        restarts: 0,
        evicted: 0,
        rejected: [0; Rejected::ALL.len()],
    };

    /// How many messages were rejected for this reason.
    pub fn rejected(&self, reason: Rejected) -> u32 {
        self.rejected.get(reason as usize).copied().unwrap_or(0)
    }

    /// Counts a message, and what it led to.
    pub(super) fn count(&mut self, event: &Event) {
        let count = match event {
            Event::Taken { .. } | Event::Fix { .. } => &mut self.packets,
            Event::Queried | Event::Survey(_) | Event::MapPiece(_) => &mut self.queries,
            Event::Restarted => &mut self.restarts,
            Event::Other => &mut self.ignored,
            Event::Rejected(reason) => match self.rejected.get_mut(*reason as usize) {
                Some(count) => count,
                None => return,
            },
        };
        for count in [&mut self.messages, count] {
            *count = count.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_counted_in_its_place() {
        for (place, reason) in Rejected::ALL.into_iter().enumerate() {
            assert_eq!(reason as usize, place);
            let mut counters = Counters::EMPTY;
            counters.count(&Event::Rejected(reason));
            for other in Rejected::ALL {
                assert_eq!(counters.rejected(other), u32::from(other == reason));
            }
        }
    }
}
