//! Sources as waypoints that chart plotters show.

use foxhunt_decode::{coordinate, sentence};

use crate::engine::message::Message;

/// `$GPWPL` for each source.
pub fn waypoints(message: &Message) -> Vec<String> {
    let Message::Answer(answer) = message else {
        return Vec::new();
    };
    let waypoint = |source: &crate::engine::message::Source| {
        let north = if source.lat < 0.0 { 'S' } else { 'N' };
        let east = if source.lon < 0.0 { 'W' } else { 'E' };
        let payload = format!(
            "GPWPL,{},{north},{},{east},FOX{}",
            coordinate(source.lat, 2),
            coordinate(source.lon, 3),
            source.number
        );
        sentence(&payload).trim_end().to_owned()
    };
    answer.sources.iter().map(waypoint).collect()
}
