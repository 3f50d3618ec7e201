//! `doa.xml`, as a KrakenSDR writes it for df-aggregator: the angle runs counter-clockwise from the bow.

use foxhunt::gateway::{BearingRecord, BearingReference};

use super::number::{place, turn};
use super::{Bearing, Decoded, Key, Refusal};

/// Decibels at which the confidence tells no more.
const LARGEST_CONFIDENCE: f64 = 25.6;

/// The reading.
///
/// # Errors
/// If a field is missing or has no sense.
pub fn doa(bytes: &[u8]) -> Result<Decoded, Refusal> {
    let text = std::str::from_utf8(bytes).map_err(|_| Refusal::Malformed)?;
    let text = |name: &'static str| element(text, name).ok_or(Refusal::Field(name));
    let value = |name: &'static str| {
        let value: Result<f64, _> = text(name)?.parse();
        value
            .ok()
            .filter(|value| value.is_finite())
            .ok_or(Refusal::Field(name))
    };
    let time = value("TIME")?;
    if !(0.0..9e15).contains(&time) {
        return Err(Refusal::Field("TIME"));
    }
    let latency = value("LATENCY").unwrap_or(0.0).clamp(0.0, 60_000.0);
    let time_ms = time as i64 - (latency / 2.0) as i64;
    // Of the maximum of the spectrum over its mean, in hundredths of a decibel; the quality that the gateway makes of it.
    let decibels = value("CONF")? / 100.0;
    if !(0.0..=100.0).contains(&decibels) {
        return Err(Refusal::Field("CONF"));
    }
    let quality = 100.0 - 100.0 * 10f64.powf(-0.1 * decibels.min(LARGEST_CONFIDENCE));
    let place = match (value("LATITUDE"), value("LONGITUDE")) {
        (Ok(latitude), Ok(longitude)) => place(latitude, longitude)?,
        _ => None,
    };
    // Zero is the heading that nobody has entered.
    let heading = value("HEADING").ok().filter(|heading| *heading != 0.0);
    let record = BearingRecord {
        place,
        reference: BearingReference::Relative,
        heading_deg: heading.map(turn),
        quality: quality as f32,
        ..BearingRecord::new(turn(-value("DOA")?))
    };
    Ok(Decoded::Bearing(Bearing {
        key: Key {
            station: String::new(),
            id: Some(format!("{time}")),
        },
        time_ms: Some(time_ms),
        is_of_others: false,
        record,
    }))
}

/// The text of the first element of a name.
fn element<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("<{name}>"))?;
    let (inner, _) = rest.split_once("</")?;
    Some(inner.trim())
}
