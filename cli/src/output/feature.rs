//! Results as GeoJSON: fixes, tags, bearings, each with its uncertainty and an identifier of its own.

use serde_json::{Value, json};

use crate::engine::message::Message;

/// Features, each with the end of its topic. `name` and `run` make identifiers that no other vehicle and no other run has.
pub fn features(message: &Message, name: &str, run: u64, seq: u64) -> Vec<(String, Value)> {
    let feature = |place: Option<(f64, f64)>, properties: Value| {
        let geometry = place.map(|(lat, lon)| json!({"type": "Point", "coordinates": [lon, lat]}));
        json!({"type": "Feature", "geometry": geometry, "properties": properties})
    };
    match message {
        Message::Answer(answer) => (answer.sources.iter())
            .map(|source| {
                let properties = json!({
                    "kind": "fix", "station": name, "id": format!("{seq}-{}", source.number),
                    "source": source.number, "time_ms": answer.time_ms, "covariance_m2": source.covariance,
                    "semi_major_m": source.ellipse.semi_major_m, "semi_minor_m": source.ellipse.semi_minor_m,
                    "angle_deg": source.ellipse.angle_deg, "probability": source.probability,
                    "bearings": source.bearings,
                });
                let place = Some((source.lat, source.lon));
                (format!("fix/{}", source.number), feature(place, properties))
            })
            .collect(),
        Message::Tag(tag) => {
            let mut properties = json!({
                "kind": "tag", "station": name, "id": seq.to_string(), "site": tag.site, "tag": tag.id,
                "time_ms": tag.time_ms, "x": tag.x, "y": tag.y, "covariance_m2": tag.covariance, "state": tag.state,
            });
            if let Some(floor) = tag.floor {
                properties["floor"] = floor.into();
                properties["floor_probability"] = tag.floor_probability.into();
            }
            if let Some(room) = &tag.room {
                properties["room"] = room.as_str().into();
                properties["room_probability"] = tag.room_probability.into();
            }
            let place = tag.lat.zip(tag.lon);
            vec![(
                format!("tag/{}/{}", tag.site, tag.id),
                feature(place, properties),
            )]
        }
        Message::Bearing(bearing) if !bearing.is_of_others => {
            let properties = json!({
                "kind": "bearing", "station": name, "id": format!("{run}-{}", bearing.id),
                "receiver": bearing.receiver, "time_ms": bearing.time_ms, "bearing_deg": bearing.bearing_deg,
                "sigma_deg": bearing.sigma_deg,
            });
            let place = Some((bearing.lat, bearing.lon));
            vec![("bearing".into(), feature(place, properties))]
        }
        Message::Retracted { id, .. } => {
            let properties = json!({
                "kind": "bearing", "station": name, "id": format!("{run}-{id}"), "retracted": true,
            });
            vec![("bearing".into(), feature(None, properties))]
        }
        _ => Vec::new(),
    }
}
