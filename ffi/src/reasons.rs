//! Why gateways reject lines and messages.

use foxhunt::gateway::{self, beacon};

/// Why the gateway of a vehicle did not use a line. The status sentence counts them in this order, from its seventh number on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntRejected {
    /// Checksum is wrong or missing.
    Checksum = 0,
    /// Line is too long.
    Overlong = 1,
    /// Line cannot be parsed.
    Unparsable = 2,
    /// Receiver has no fix.
    NoFix = 3,
    /// Position is 0 degrees north and east.
    NullPosition = 4,
    /// Time runs backwards.
    TimeBackwards = 5,
    /// Value is out of range.
    OutOfRange = 6,
    /// No position yet: the first waits for a later one that agrees.
    NoPosition = 7,
    /// Position is too old.
    StalePosition = 8,
    /// No heading: none is stated, and no course as the vehicle stands.
    NoHeading = 9,
    /// Vehicle is turning and its heading is unknown.
    Turning = 10,
    /// Quality is too low.
    LowQuality = 11,
    /// Unexpected frequency.
    OtherFrequency = 12,
    /// Unexpected tag.
    OtherTag = 13,
    /// Unexpected direction finder.
    OtherFinder = 14,
    /// Bearing is older than all that are kept.
    TooOld = 15,
    /// Bearing was used already.
    Duplicate = 16,
    /// Position is simulated or entered by hand.
    Simulated = 17,
    /// Position waits for a later one that agrees.
    Unconfirmed = 18,
    /// Magnetic variation is unknown.
    NoVariation = 19,
    /// Direction finder repeats its last spectrum: nothing is heard.
    Frozen = 20,
    /// Unexpected anchor.
    OtherAnchor = 21,
    /// Another reason.
    Other = 1000,
}

impl From<gateway::Rejected> for FoxhuntRejected {
    fn from(reason: gateway::Rejected) -> Self {
        use gateway::Rejected as Reason;
        match reason {
            Reason::Checksum => Self::Checksum,
            Reason::Overlong => Self::Overlong,
            Reason::Unparsable => Self::Unparsable,
            Reason::NoFix => Self::NoFix,
            Reason::NullPosition => Self::NullPosition,
            Reason::TimeBackwards => Self::TimeBackwards,
            Reason::OutOfRange => Self::OutOfRange,
            Reason::NoPosition => Self::NoPosition,
            Reason::StalePosition => Self::StalePosition,
            Reason::NoHeading => Self::NoHeading,
            Reason::Turning => Self::Turning,
            Reason::LowQuality => Self::LowQuality,
            Reason::OtherFrequency => Self::OtherFrequency,
            Reason::OtherTag => Self::OtherTag,
            Reason::OtherFinder => Self::OtherFinder,
            Reason::TooOld => Self::TooOld,
            Reason::Duplicate => Self::Duplicate,
            Reason::Simulated => Self::Simulated,
            Reason::Unconfirmed => Self::Unconfirmed,
            Reason::NoVariation => Self::NoVariation,
            Reason::Frozen => Self::Frozen,
            Reason::OtherAnchor => Self::OtherAnchor,
            _ => Self::Other,
        }
    }
}

/// Why the gateway of tags did not use a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntBeaconRejected {
    /// Checksum is wrong or missing.
    Checksum = 0,
    /// Message is too long.
    Overlong = 1,
    /// Message cannot be parsed.
    Unparsable = 2,
    /// Value is out of range.
    OutOfRange = 3,
    /// Radio is not in the map.
    UnknownRadio = 4,
    /// Packet is too old.
    TooOld = 5,
    /// No tracker is free.
    NoRoom = 6,
    /// Another reason.
    Other = 1000,
}

impl From<beacon::Rejected> for FoxhuntBeaconRejected {
    fn from(reason: beacon::Rejected) -> Self {
        use beacon::Rejected as Reason;
        match reason {
            Reason::Checksum => Self::Checksum,
            Reason::Overlong => Self::Overlong,
            Reason::Unparsable => Self::Unparsable,
            Reason::OutOfRange => Self::OutOfRange,
            Reason::UnknownRadio => Self::UnknownRadio,
            Reason::TooOld => Self::TooOld,
            Reason::NoRoom => Self::NoRoom,
            _ => Self::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So that a reason which the library gets is not forgotten here, and none has another's number.
    macro_rules! same {
        ($ours:ty, $library:ty) => {
            for (number, reason) in (0..).zip(<$library>::ALL) {
                let ours = <$ours>::from(reason);
                assert_eq!(ours as u32, number);
                assert_eq!(format!("{ours:?}"), format!("{reason:?}"));
            }
        };
    }

    #[test]
    fn the_library_has_the_same_reasons() {
        same!(FoxhuntRejected, gateway::Rejected);
        same!(FoxhuntBeaconRejected, beacon::Rejected);
    }
}
