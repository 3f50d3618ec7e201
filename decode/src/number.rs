//! Numbers in messages, which some programs write as text.

use chrono::NaiveDateTime;
use serde_json::{Map, Value};

use super::Refusal;

/// A finite number, also one that is written as text.
pub fn number(value: &Value) -> Option<f64> {
    let number = match value {
        Value::Number(number) => number.as_f64()?,
        Value::String(text) => text.trim().parse().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

/// The number of a field, if there is such a field and it is not null.
///
/// # Errors
/// If the field holds anything else.
pub fn optional(object: &Map<String, Value>, name: &'static str) -> Result<Option<f64>, Refusal> {
    match object.get(name) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => number(value).map(Some).ok_or(Refusal::Field(name)),
    }
}

/// The number of a field.
///
/// # Errors
/// If there is none.
pub fn required(object: &Map<String, Value>, name: &'static str) -> Result<f64, Refusal> {
    optional(object, name)?.ok_or(Refusal::Field(name))
}

/// Degrees within a turn.
pub fn turn(degrees: f64) -> f32 {
    let within = degrees.rem_euclid(360.0) as f32;
    if within >= 360.0 { 0.0 } else { within }
}

/// A place in degrees; `None` for 0 degrees north and east, which many send before their first fix.
///
/// # Errors
/// If it is not on earth.
pub fn place(
    latitude: f64,
    longitude: f64,
) -> Result<Option<foxhunt::aoa::geodesy::Geodetic>, Refusal> {
    if !(-90.0..=90.0).contains(&latitude) {
        return Err(Refusal::Field("latitude"));
    }
    if !(-180.0..=180.0).contains(&longitude) {
        return Err(Refusal::Field("longitude"));
    }
    if latitude == 0.0 && longitude == 0.0 {
        return Ok(None);
    }
    let [latitude, longitude] = [latitude, longitude].map(|degrees| (degrees * 1e7).round() as i32);
    foxhunt::aoa::geodesy::Geodetic::new(latitude, longitude)
        .map(Some)
        .map_err(|_| Refusal::Field("latitude"))
}

/// Milliseconds after 1970 of seconds or of milliseconds, whichever it is, or of a date such as `2026-11-28T09:30:04.5Z`.
pub fn time_ms(value: &Value) -> Option<i64> {
    /// Seconds until the year 5138; milliseconds until 1973.
    const SECONDS: f64 = 1e11;
    if let Some(number) = number(value) {
        let milliseconds = if number < SECONDS {
            1e3 * number
        } else {
            number
        };
        return (0.0..9e15)
            .contains(&milliseconds)
            .then(|| milliseconds.round() as i64);
    }
    // A date in UTC, with or without saying so.
    let text = value.as_str()?.trim_end_matches('Z');
    let text = text.strip_suffix("+00:00").unwrap_or(text);
    let date: NaiveDateTime = text.parse().ok()?;
    Some(date.and_utc().timestamp_millis()).filter(|time| (0..9_000_000_000_000_000).contains(time))
}
