//! Messages that are no lines: from bytes to bearings, and to lines that the gateway reads. And what lines themselves say of
//! the time.

mod feature;
mod form;
mod gpsd;
mod horus;
mod kraken;
mod number;
mod report;
mod sentence;
mod stream;
mod times;
mod words;
mod xml;

use serde_json::{Map, Value};

pub use form::form;
pub use report::{Region, Report, report};
pub use sentence::{Navigation, coordinate, sentence};
pub use stream::{Part, Stream};
pub use times::{time_and_date, time_of_day};
pub use words::{Bearing, Decoded, Key, Refusal};

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
