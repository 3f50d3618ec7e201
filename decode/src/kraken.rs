//! A KrakenSDR's reading as JSON, by request or WebSocket, as the line that it is for the gateway.

use std::fmt::Write;

use serde_json::{Map, Value};

use super::number::{number, time_ms};
use super::{Decoded, Refusal};

/// The fields of both forms: what a KrakenSDR sends to a map server, and `Full POST`.
///
/// # Errors
/// If a field is missing or has no sense.
pub fn reading(object: &Map<String, Value>) -> Result<Decoded, Refusal> {
    let first = |names: [&'static str; 2]| {
        let value = object.get(names[0]).or(object.get(names[1]));
        value.ok_or(Refusal::Field(names[0]))
    };
    let value = |names: [&'static str; 2]| number(first(names)?).ok_or(Refusal::Field(names[0]));
    let or = |names: [&'static str; 2], otherwise: f64| value(names).unwrap_or(otherwise);
    let time = first(["tStamp", "time"])?;
    let time = time_ms(time).ok_or(Refusal::Field("tStamp"))?;
    let text = |names: [&'static str; 2], otherwise: &str| -> String {
        let text = first(names).ok().and_then(Value::as_str);
        let kept = text.unwrap_or(otherwise).chars().take(32);
        // A comma within a name would be a field more.
        kept.filter(|c| !c.is_control() && *c != ',').collect()
    };
    let heading = or(["gpsBearing", "gpsheading"], 0.0);
    let mut line = format!(
        "{time}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {heading}, {heading}, GPS, R, R, R, R",
        value(["radioBearing", "radiobearing"])?,
        value(["conf", "confidence"])?,
        or(["power", "power"], 0.0),
        value(["freq", "frequency"])?.round(),
        text(["antType", "anttype"], "UCA"),
        or(["latency", "latency"], 0.0).round(),
        text(["station_id", "id"], "kraken"),
        or(["latitude", "lat"], 0.0),
        or(["longitude", "lng"], 0.0),
    );
    for level in levels(first(["doaArray", "doaarray"]).ok())? {
        write!(line, ", {level:.2}").expect("a string takes all");
    }
    line.push_str(" \n");
    Ok(Decoded::Lines(line.into_bytes()))
}

/// The spectrum: an array of numbers, or text with commas between them.
fn levels(value: Option<&Value>) -> Result<Vec<f64>, Refusal> {
    const REFUSED: Refusal = Refusal::Field("doaArray");
    let levels: Option<Vec<f64>> = match value {
        None | Some(Value::Null) => Some(Vec::new()),
        Some(Value::Array(values)) => values.iter().map(number).collect(),
        Some(Value::String(text)) => (text.split(','))
            .filter(|field| !field.trim().is_empty())
            .map(|field| field.trim().parse().ok().filter(|v: &f64| v.is_finite()))
            .collect(),
        Some(_) => None,
    };
    levels.filter(|levels| levels.len() <= 360).ok_or(REFUSED)
}
