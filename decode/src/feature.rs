//! A bearing as GeoJSON, as `foxhunt live` publishes it for others.

use foxhunt::gateway::BearingRecord;
use serde_json::{Map, Value};

use super::number::{number, place, required, time_ms, turn};
use super::{Bearing, Decoded, Key, Refusal};

/// A feature with a point, whose properties are `station`, `id`, `time_ms`, `bearing_deg` and `sigma_deg`; or `station`, `id` and
/// `"retracted": true`.
///
/// # Errors
/// If a field is missing or has no sense.
pub fn bearing(object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    let properties = object.get("properties").and_then(Value::as_object);
    let properties = properties.ok_or(Refusal::Field("properties"))?;
    let text = |name: &'static str| match properties.get(name) {
        Some(Value::String(text)) if !text.is_empty() => Ok(text.clone()),
        Some(Value::Number(number)) => Ok(number.to_string()),
        _ => Err(Refusal::Field(name)),
    };
    if !properties.contains_key("bearing_deg") && !properties.contains_key("retracted") {
        // A fix or a tag of another.
        return Ok(Decoded::Nothing);
    }
    let key = Key {
        station: text("station")?,
        id: Some(text("id")?),
    };
    if properties.get("retracted") == Some(&Value::Bool(true)) {
        return Ok(Decoded::Delete(key));
    }
    let point = object.get("geometry").and_then(|g| g.get("coordinates"));
    let at = |index: usize| point.and_then(|point| point.get(index)).and_then(number);
    let (Some(longitude), Some(latitude)) = (at(0), at(1)) else {
        return Err(Refusal::Field("geometry"));
    };
    let sigma = required(properties, "sigma_deg")?;
    let time = properties.get("time_ms").and_then(time_ms);
    Ok(Decoded::Bearing(Bearing {
        key,
        time_ms: Some(time.ok_or(Refusal::Field("time_ms"))?),
        is_of_others: true,
        record: BearingRecord {
            place: Some(place(latitude, longitude)?.ok_or(Refusal::Field("geometry"))?),
            sigma_rad: Some(sigma.to_radians() as f32),
            ..BearingRecord::new(turn(required(properties, "bearing_deg")?))
        },
    }))
}
