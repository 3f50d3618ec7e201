//! What messages say, and why they are of no use.

use foxhunt::gateway::BearingRecord;

/// What a message says.
#[derive(Debug, Clone, PartialEq)]
pub enum Decoded {
    /// Lines for the gateway.
    Lines(Vec<u8>),
    /// A bearing.
    Bearing(Bearing),
    /// A bearing is to be taken back.
    Delete(Key),
    /// Nothing that a search needs.
    Nothing,
}

/// A bearing by a station.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Which it is.
    pub key: Key,
    /// When it was taken, in milliseconds after 1970, if the message says so.
    pub time_ms: Option<i64>,
    /// It is another vehicle's, which tells of it itself.
    pub is_of_others: bool,
    /// For the gateway.
    pub record: BearingRecord,
}

/// By which a bearing is told from others.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// The station; empty for the one whose input this is.
    pub station: String,
    /// What the station calls it: an identifier, or its time.
    pub id: Option<String>,
}

/// Why a message is of no use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Refusal {
    /// It is neither JSON nor XML.
    Malformed,
    /// It is of no known kind.
    Unknown,
    /// It has come before, and was used.
    Known,
    /// A field is missing or has no sense.
    Field(&'static str),
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Malformed => f.write_str("message is neither JSON nor XML"),
            Self::Unknown => f.write_str("message is of no known kind"),
            Self::Known => f.write_str("message has come before"),
            Self::Field(name) => write!(f, "{name} is missing or out of range"),
        }
    }
}
