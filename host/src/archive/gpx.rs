//! The track and the fixes for navigation devices: GPX 1.1.

use std::fmt::Write;

use super::Archive;
use super::coordinates::{coordinates, degrees};
use super::kml::escaped;
use super::times::{Days, date};

impl Archive {
    /// The way of the vehicle as a track, and where each source is as a waypoint.
    pub fn gpx(&self, title: &str) -> String {
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        let mut line = |arguments: std::fmt::Arguments| {
            writeln!(text, "{arguments}").expect("a string takes all");
        };
        line(format_args!(
            "<gpx version=\"1.1\" creator=\"foxhunt\" xmlns=\"http://www.topografix.com/GPX/1/1\">"
        ));
        line(format_args!(
            "<metadata><name>{}</name></metadata>",
            escaped(title)
        ));
        let last = self.last();
        let mut days = Days::new(self.midnight_ms);
        let times = self.answers.iter().map(|known| days.at(known.time_ms));
        let time = date(times.last().unwrap_or_default());
        for source in &last.sources {
            if let Some([longitude, latitude]) = coordinates(&last.plane, source.fix.position) {
                let ellipse = source.fix.ellipse(0.95);
                line(format_args!(
                    "<wpt lat=\"{latitude:.7}\" lon=\"{longitude:.7}\"><time>{time}</time><name>fox {}</name>\
                     <desc>95 %: {:.1} m by {:.1} m, {} bearings</desc></wpt>",
                    source.identity, ellipse.semi_major, ellipse.semi_minor, source.fix.bearings,
                ));
            }
        }
        line(format_args!("<trk><name>vehicle</name><trkseg>"));
        let mut days = Days::new(self.midnight_ms);
        for passed in &self.track {
            let [longitude, latitude] = degrees(passed.place);
            let time = (passed.time_ms).map_or(String::new(), |time| {
                format!("<time>{}</time>", date(days.at(time)))
            });
            line(format_args!(
                "<trkpt lat=\"{latitude:.7}\" lon=\"{longitude:.7}\">{time}</trkpt>"
            ));
        }
        line(format_args!("</trkseg></trk>\n</gpx>"));
        text
    }
}
