//! What became of the lines.

use crate::aoa::{Fix, NotObservable};
use crate::error::messages;
use crate::snapshot::value;

/// What a line led to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event {
    /// A sentence of the receiver was used.
    Used,
    /// A bearing was used; the source is here, in metres from [`Vehicle::plane`](super::Vehicle::plane).
    Fix(Fix),
    /// A bearing was used; it cannot be said yet where the source is.
    NotObservable(NotObservable),
    /// The line was not used.
    Rejected(Rejected),
    /// The host has asked, and [`Vehicle::report`](super::Vehicle::report) answers.
    Queried,
    /// The host looks for another source: as [`Vehicle::restart`](super::Vehicle::restart), and the report confirms it.
    Restarted,
    /// A correct sentence that is none of the gateway's: [`Vehicle::line`](super::Vehicle::line) has it for others.
    Other,
}

/// Why a line was not used. The state of the locator is as if it had not been there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rejected {
    /// A sentence or frame whose checksum is wrong or missing.
    Checksum,
    /// The line is longer than any of its kind.
    Overlong,
    /// The line is of no known kind, or a field of it is missing or malformed.
    Unparsable,
    /// The receiver says that it has no position, or that its heading is void; or it says how the vehicle heads
    /// or moves before it has stated any time, or after a sentence with a time that was refused.
    NoFix,
    /// The receiver reports 0 degrees north and east: what many send before their first fix.
    NullPosition,
    /// A time stamp earlier than the one before it.
    TimeBackwards,
    /// A coordinate, angle or quality outside its range, or a place too far from [`super::Vehicle::plane`].
    OutOfRange,
    /// A bearing before any position was believed, which is about a second after the receiver states its first: that waits,
    /// as [`Self::Unconfirmed`]. Bearings before then are not kept: a line has one event. Without a receiver, a direction finder needs
    /// lines that state a time, and a place or [`Config::station`](super::Config::station).
    NoPosition,
    /// A bearing whose nearest position is older than [`Config::max_age_ms`](super::Config::max_age_ms), or as much
    /// newer. Or one whose line states no time, after
    /// [`Config::undated_bearings`](super::Config::undated_bearings) others at the same time of the
    /// receiver, or when that has just run backwards.
    StalePosition,
    /// A relative bearing with neither a fresh true heading nor a course of a vehicle that moves.
    NoHeading,
    /// A relative bearing of a vehicle whose heading is only known by its course, in a bend: see
    /// [`Config::max_turn_rate_deg_s`](super::Config::max_turn_rate_deg_s).
    Turning,
    /// A bearing of a quality below [`Config::min_quality`](super::Config::min_quality).
    LowQuality,
    /// A bearing on another frequency than its format is told, such as
    /// [`kraken::Config`](super::formats::kraken::Config).
    OtherFrequency,
    /// A bearing on another tag than its format is told, such as [`ublox::Config`](super::formats::ublox::Config).
    OtherTag,
    /// A bearing of another direction finder than [`formats::Config::finder`](super::formats::Config::finder).
    OtherFinder,
    /// A bearing that was taken before all that the locator still keeps.
    TooOld,
    /// A bearing of a port and time of which one has been used already: the page of a direction finder was read twice.
    Duplicate,
    /// A position that is simulated or was entered by hand: see
    /// [`formats::Config::simulated`](super::formats::Config::simulated).
    Simulated,
    /// The first position after a start or an outage, or one to which no vehicle can have got so soon: it waits for a
    /// later one that agrees. See [`Config::max_speed_m_s`](super::Config::max_speed_m_s). Or a bearing that was taken at
    /// such a place, while it is not known whether this or the one before was wrong: see
    /// [`Vehicle::plane`](super::Vehicle::plane).
    Unconfirmed,
    /// A heading from magnetic north, where neither a sentence nor
    /// [`Config::variation_deg`](super::Config::variation_deg) says how far that is from true north.
    NoVariation,
    /// A bearing whose line has a new time, but the spectrum of one before: the direction finder hears nothing now, and
    /// repeats what it last heard.
    Frozen,
    /// A bearing of a board that is not among [`ublox::Config::anchors`](super::formats::ublox::Config::anchors).
    OtherAnchor,
}

/// The reasons of a rejection in their order, with what they say.
macro_rules! reasons {
    ($error:ident { $($reason:ident => $message:literal),+ $(,)? }) => {
        impl $error {
            /// Every reason, in the order of the status sentence.
            pub const ALL: [Self; [$($message),+].len()] = [$(Self::$reason),+];
        }

        messages!($error { $(Self::$reason => $message),+ });
    };
}
pub(super) use reasons;

reasons!(Rejected {
    Checksum => "checksum is wrong or missing",
    Overlong => "line is too long",
    Unparsable => "line cannot be parsed",
    NoFix => "receiver has no fix",
    NullPosition => "position is 0 degrees north and east",
    TimeBackwards => "time runs backwards",
    OutOfRange => "value is out of range",
    NoPosition => "no position yet: the first waits for a later one that agrees",
    StalePosition => "position is too old",
    NoHeading => "no heading: none is stated, and no course as the vehicle stands",
    Turning => "vehicle is turning and its heading is unknown",
    LowQuality => "quality is too low",
    OtherFrequency => "unexpected frequency",
    OtherTag => "unexpected tag",
    OtherFinder => "unexpected direction finder",
    TooOld => "bearing is older than all that are kept",
    Duplicate => "bearing was used already",
    Simulated => "position is simulated or entered by hand",
    Unconfirmed => "position waits for a later one that agrees",
    NoVariation => "magnetic variation is unknown",
    Frozen => "direction finder repeats its last spectrum: nothing is heard",
    OtherAnchor => "unexpected anchor",
});

/// How many lines there were, each of which is counted once more by what became of it. Counts stay at their maximum when
/// they reach it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Counters {
    /// All lines that were not empty.
    pub lines: u32,
    /// Sentences of the receiver that were used.
    pub sentences: u32,
    /// Bearings that the locator took.
    pub bearings: u32,
    /// Correct sentences that are for others.
    pub ignored: u32,
    /// Queries of the host.
    pub queries: u32,
    /// Restarts by the host.
    pub restarts: u32,
    rejected: [u32; Rejected::ALL.len()],
}

impl Counters {
    pub(super) const EMPTY: Self = Self {
        lines: 0,
        sentences: 0,
        bearings: 0,
        ignored: 0,
        queries: 0,
        restarts: 0,
        rejected: [0; Rejected::ALL.len()],
    };

    /// How many lines were rejected for this reason.
    pub fn rejected(&self, reason: Rejected) -> u32 {
        self.rejected.get(reason as usize).copied().unwrap_or(0)
    }

    /// The counts in the order of the status sentence, but for rejections.
    pub(super) const fn of_lines(&self) -> [u32; 6] {
        [
            self.lines,
            self.sentences,
            self.bearings,
            self.ignored,
            self.queries,
            self.restarts,
        ]
    }

    /// Counts a line, and by what it led to.
    pub(super) fn count(&mut self, event: &Event) {
        let count = match event {
            Event::Used => &mut self.sentences,
            Event::Fix(_) | Event::NotObservable(_) => &mut self.bearings,
            Event::Other => &mut self.ignored,
            Event::Queried => &mut self.queries,
            Event::Restarted => &mut self.restarts,
            Event::Rejected(reason) => match self.rejected.get_mut(*reason as usize) {
                Some(count) => count,
                None => return,
            },
        };
        for count in [&mut self.lines, count] {
            *count = count.saturating_add(1);
        }
    }
}

value!(Counters {
    lines,
    sentences,
    bearings,
    ignored,
    queries,
    restarts,
    rejected,
});

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
