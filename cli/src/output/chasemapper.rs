//! Bearings and sources as chasemapper reads them.

use foxhunt_host::archive::times::date;
use serde_json::json;

use crate::engine::message::Message;

/// A `BEARING` for each bearing, a `PAYLOAD_SUMMARY` for each source.
pub fn messages(message: &Message, name: &str) -> Vec<String> {
    match message {
        Message::Bearing(bearing) => vec![
            json!({
                "type": "BEARING", "bearing_type": "absolute", "source": bearing.receiver, "latitude": bearing.lat,
                "longitude": bearing.lon, "bearing": bearing.bearing_deg,
                "timestamp": bearing.time_ms as f64 / 1e3,
                "confidence": 100.0 * (1.0 - bearing.outlier.unwrap_or(0.0)),
            })
            .to_string(),
        ],
        Message::Answer(answer) => (answer.sources.iter())
            .map(|source| {
                let time = date(answer.time_ms);
                json!({
                    "type": "PAYLOAD_SUMMARY", "callsign": format!("{name}-fox-{}", source.number),
                    "latitude": source.lat, "longitude": source.lon, "altitude": 0, "speed": -1, "heading": -1,
                    "time": time.get(11..19).unwrap_or("00:00:00"),
                    "comment": format!("95 %: {} m by {} m", source.ellipse.semi_major_m, source.ellipse.semi_minor_m),
                })
                .to_string()
            })
            .collect(),
        _ => Vec::new(),
    }
}
