//! Numbers in messages, which some programs write as text.

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
    date_ms(value.as_str()?)
}

/// Milliseconds after 1970 of a date and time in UTC.
pub fn date_ms(text: &str) -> Option<i64> {
    let part = |from: usize, to: usize| -> Option<i64> {
        let digits = text.get(from..to)?;
        let are_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|_| are_digits)
    };
    let (year, month, day) = (part(0, 4)?, part(5, 7)?, part(8, 10)?);
    let (hour, minute, second) = (part(11, 13)?, part(14, 16)?, part(17, 19)?);
    if !(1970..=9999).contains(&year)
        || !(1..=12).contains(&month)
        || !(1..=31).contains(&day)
        || hour > 23
        || minute > 59
        || second > 60
    {
        return None;
    }
    let rest = text.get(19..)?.trim_end_matches('Z');
    let rest = rest.strip_suffix("+00:00").unwrap_or(rest);
    let fraction: f64 = if rest.is_empty() {
        0.0
    } else if rest.starts_with('.') && rest.len() > 1 {
        format!("0{rest}").parse().ok()?
    } else {
        return None;
    };
    let shifted = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = 365 * shifted + shifted / 4 - shifted / 100 + shifted / 400 + of_year - 719_468;
    let seconds = ((24 * days + hour) * 60 + minute) * 60 + second;
    Some(1_000 * seconds + (1e3 * fraction).round() as i64)
}
