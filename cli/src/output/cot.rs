//! Sources as events of Cursor on Target, version 2.0, as TAK programs read them.

use foxhunt_host::archive::times::date;

use crate::engine::message::Message;

/// Milliseconds for which an event holds.
const STALE_MS: i64 = 120_000;

/// An event for each source: a place that was computed by a machine (`m-g`), of an unknown thing on the ground (`a-u-G`). The
/// circle that its error says (`ce`) is that of the longer half axis of the 95 % ellipse.
pub fn events(message: &Message, name: &str) -> Vec<String> {
    let Message::Answer(answer) = message else {
        return Vec::new();
    };
    let (time, stale) = (date(answer.time_ms), date(answer.time_ms + STALE_MS));
    let event = |source: &crate::engine::message::Source| {
        let ellipse = source.ellipse;
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?><event version=\"2.0\" \
             uid=\"foxhunt.{name}.{number}\" type=\"a-u-G\" how=\"m-g\" time=\"{time}\" start=\"{time}\" \
             stale=\"{stale}\"><point lat=\"{:.7}\" lon=\"{:.7}\" hae=\"9999999.0\" ce=\"{:.1}\" le=\"9999999.0\"/>\
             <detail><contact callsign=\"{name} fox {number}\"/><remarks>95 %: {:.1} m by {:.1} m, longer axis at \
             {:.0} degrees, {} bearings</remarks></detail></event>",
            source.lat,
            source.lon,
            ellipse.semi_major_m,
            ellipse.semi_major_m,
            ellipse.semi_minor_m,
            ellipse.angle_deg,
            source.bearings,
            number = source.number,
        )
    };
    answer.sources.iter().map(event).collect()
}
