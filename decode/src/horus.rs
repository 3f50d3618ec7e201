//! What programs of Project Horus send to each other by UDP: bearings and positions of a car, as chasemapper reads them.

use foxhunt::gateway::{BearingRecord, BearingReference};
use serde_json::{Map, Value};

use super::number::{number, optional, place, required, time_ms, turn};
use super::{Bearing, Decoded, Key, Navigation, Refusal};

/// `{"type": "BEARING", "bearing_type": "relative" or "absolute", "bearing": ...}`, with `"delete": true` one that is to be
/// taken back.
///
/// # Errors
/// If a field is missing or has no sense.
pub fn bearing(object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    let station = object.get("source").and_then(Value::as_str);
    let stamp = object.get("timestamp").and_then(time_ms);
    let id = match object.get("id").or(object.get("key")) {
        Some(Value::String(id)) => Some(id.clone()),
        Some(Value::Number(id)) => Some(id.to_string()),
        _ => stamp.map(|time| time.to_string()),
    };
    let key = Key {
        station: station.unwrap_or_default().to_owned(),
        id,
    };
    let kind = object.get("bearing_type").and_then(Value::as_str);
    if kind == Some("delete") || object.get("delete") == Some(&Value::Bool(true)) {
        return Ok(Decoded::Delete(key));
    }
    let mut degrees = required(object, "bearing")?;
    let reference = match kind {
        Some("relative") => BearingReference::Relative,
        Some("absolute") => BearingReference::TrueNorth,
        _ => return Err(Refusal::Field("bearing_type")),
    };
    // Counts counter-clockwise, and chasemapper turns it round likewise.
    if station == Some("krakensdr_doa") && reference == BearingReference::Relative {
        degrees = -degrees;
    }
    let [latitude, longitude] = ["latitude", "longitude"].map(|name| object.get(name));
    let place = match (
        latitude.and_then(number),
        longitude.and_then(number),
        reference,
    ) {
        (Some(latitude), Some(longitude), _) => place(latitude, longitude)?,
        (_, _, BearingReference::TrueNorth) => return Err(Refusal::Field("latitude")),
        _ => None,
    };
    let confidence = optional(object, "confidence")?.unwrap_or(100.0);
    let record = BearingRecord {
        time_ms: None,
        place,
        reference,
        sigma_rad: optional(object, "sigma_deg")?.map(|sigma| sigma.to_radians() as f32),
        quality: confidence.clamp(0.0, 100.0) as f32,
        ..BearingRecord::new(turn(degrees))
    };
    Ok(Decoded::Bearing(Bearing {
        key,
        time_ms: stamp,
        is_of_others: false,
        record,
    }))
}

/// `{"type": "GPS", "latitude": ..., "longitude": ..., "speed": kilometres an hour, "heading": ...}`.
///
/// # Errors
/// If a field is missing or has no sense.
pub fn position(object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    let (latitude, longitude) = (
        required(object, "latitude")?,
        required(object, "longitude")?,
    );
    if object.get("valid") == Some(&Value::Bool(false)) || place(latitude, longitude)?.is_none() {
        return Ok(Decoded::Nothing);
    }
    let stamp = ["timestamp", "time"].map(|name| object.get(name).and_then(time_ms));
    let ([Some(time), _] | [None, Some(time)]) = stamp else {
        return Err(Refusal::Field("timestamp"));
    };
    let course = ["heading", "track"].map(|name| object.get(name).and_then(number));
    let navigation = Navigation {
        time_ms: time,
        latitude,
        longitude,
        speed_m_s: optional(object, "speed")?.map(|speed| speed / 3.6),
        course_deg: course[0].or(course[1]),
        heading_deg: None,
    };
    Ok(Decoded::Lines(navigation.lines()))
}
