//! What gpsd says: reports of its protocol, version 3.

use serde_json::{Map, Value};

use super::number::{optional, place, required, time_ms};
use super::{Decoded, Navigation, Refusal};

/// A report of a class: `TPV` is used, what others say is not needed.
///
/// # Errors
/// If a field has no sense.
pub fn report(class: &str, object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    match class {
        "TPV" => position(object),
        "VERSION" | "DEVICES" | "DEVICE" | "WATCH" | "SKY" | "GST" | "ATT" | "IMU" | "TOFF"
        | "PPS" | "OSC" | "POLL" | "AIS" | "RTCM2" | "RTCM3" | "RAW" | "SUBFRAME" | "ERROR" => {
            Ok(Decoded::Nothing)
        }
        _ => Err(Refusal::Unknown),
    }
}

fn position(object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    /// A position on the plane.
    const FIX: f64 = 2.0;
    if required(object, "mode")? < FIX {
        return Ok(Decoded::Nothing);
    }
    let time = object.get("time").and_then(time_ms);
    let (latitude, longitude) = (required(object, "lat")?, required(object, "lon")?);
    if place(latitude, longitude)?.is_none() {
        return Ok(Decoded::Nothing);
    }
    let navigation = Navigation {
        time_ms: time.ok_or(Refusal::Field("time"))?,
        latitude,
        longitude,
        speed_m_s: optional(object, "speed")?,
        course_deg: optional(object, "track")?,
        heading_deg: None,
    };
    Ok(Decoded::Lines(navigation.lines()))
}
