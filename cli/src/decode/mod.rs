//! Messages that are no lines: from bytes to bearings, and to lines that the gateway reads.

mod feature;
mod gpsd;
mod horus;
mod kraken;
mod number;
mod sentence;
mod stream;
mod xml;

use foxhunt::gateway::BearingRecord;
use serde_json::{Map, Value};

pub use sentence::{Navigation, coordinate, sentence};
pub use stream::{Part, Stream};

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
    /// A field is missing or has no sense.
    Field(&'static str),
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Malformed => f.write_str("message is neither JSON nor XML"),
            Self::Unknown => f.write_str("message is of no known kind"),
            Self::Field(name) => write!(f, "{name} is missing or out of range"),
        }
    }
}

/// Reads a whole message, such as a datagram or the body of a request: JSON of a known kind, `doa.xml`, or lines.
///
/// # Errors
/// Why it is of no use.
pub fn message(bytes: &[u8]) -> Result<Decoded, Refusal> {
    let trimmed = bytes.trim_ascii();
    match trimmed.first() {
        None => Ok(Decoded::Nothing),
        Some(b'{') => json(trimmed),
        Some(b'<') => xml::doa(trimmed),
        Some(_) => Ok(Decoded::Lines([bytes, b"\n"].concat())),
    }
}

/// Reads a JSON object.
///
/// # Errors
/// Why it is of no use.
pub fn json(bytes: &[u8]) -> Result<Decoded, Refusal> {
    let object: Map<String, Value> =
        serde_json::from_slice(bytes).map_err(|_| Refusal::Malformed)?;
    let text = |name: &str| object.get(name).and_then(Value::as_str);
    match (text("type"), text("class")) {
        (Some("BEARING"), _) => horus::bearing(&object),
        (Some("GPS"), _) => horus::position(&object),
        (Some("Feature"), _) => feature::bearing(&object),
        (Some("PAYLOAD_SUMMARY" | "PAYLOAD_TELEMETRY" | "MODEM_STATS"), _) => Ok(Decoded::Nothing),
        (_, Some(class)) => gpsd::report(class, &object),
        _ if object.contains_key("radioBearing") || object.contains_key("radiobearing") => {
            kraken::reading(&object)
        }
        _ => Err(Refusal::Unknown),
    }
}

#[cfg(test)]
mod tests;
