//! The search with its times for globes: KML 2.2.

use std::fmt::{Arguments, Write};

use super::coordinates::{coordinates, degrees};
use super::features::{ellipse, ray};
use super::times::{Days, date};
use super::{Archive, thinned};

/// The most of each: of a longer log every second, third, ... is shown.
const MOST: usize = 800;

/// Colours as KML has them: opacity, blue, green, red.
const STYLES: &str = "<Style id=\"bearing\"><LineStyle><color>7f968900</color><width>1</width></LineStyle></Style>\n\
    <Style id=\"fix\"><IconStyle><color>ff461ec8</color><scale>0.6</scale></IconStyle></Style>\n\
    <Style id=\"ellipse\"><LineStyle><color>ff461ec8</color><width>3</width></LineStyle>\
    <PolyStyle><fill>0</fill></PolyStyle></Style>\n\
    <Style id=\"track\"><LineStyle><color>ff382326</color><width>2</width></LineStyle></Style>";

impl Archive {
    /// The way of the vehicle, every bearing and every fix with its time, and the last ellipses.
    pub fn kml(&self, title: &str) -> String {
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        let mut line = |arguments: Arguments| {
            writeln!(text, "{arguments}").expect("a string takes all");
        };
        line(format_args!(
            "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>{}</name>\n{STYLES}",
            escaped(title)
        ));
        self.kml_track(&mut line);
        let (range, mut days) = (self.range(), Days::new(self.midnight_ms));
        line(format_args!("<Folder><name>bearings</name>"));
        for taken in thinned(&self.bearings, MOST) {
            let when = date(days.at(taken.time_ms));
            let ends = ray(taken, range).map(|place| coordinates(&taken.plane, place));
            if let [Some([x, y]), Some([to_x, to_y])] = ends {
                line(format_args!(
                    "<Placemark><TimeStamp><when>{when}</when></TimeStamp><styleUrl>#bearing</styleUrl><LineString>\
                     <coordinates>{x:.7},{y:.7} {to_x:.7},{to_y:.7}</coordinates></LineString></Placemark>"
                ));
            }
        }
        line(format_args!("</Folder>\n<Folder><name>fixes</name>"));
        let mut days = Days::new(self.midnight_ms);
        for known in thinned(&self.answers, MOST) {
            let when = date(days.at(known.time_ms));
            for source in &known.sources {
                if let Some([x, y]) = coordinates(&known.plane, source.fix.position) {
                    line(format_args!(
                        "<Placemark><name>{}</name><TimeStamp><when>{when}</when></TimeStamp>\
                         <styleUrl>#fix</styleUrl><Point><coordinates>{x:.7},{y:.7}</coordinates></Point></Placemark>",
                        source.identity
                    ));
                }
            }
        }
        line(format_args!("</Folder>"));
        self.kml_ellipses(&mut line);
        line(format_args!("</Document></kml>"));
        text
    }

    fn kml_track(&self, line: &mut impl FnMut(Arguments)) {
        let places: Vec<String> = (self.track.iter())
            .map(|passed| degrees(passed.place))
            .map(|[x, y]| format!("{x:.7},{y:.7}"))
            .collect();
        if places.len() >= 2 {
            line(format_args!(
                "<Placemark><name>vehicle</name><styleUrl>#track</styleUrl><LineString><coordinates>{}\
                 </coordinates></LineString></Placemark>",
                places.join(" ")
            ));
        }
    }

    fn kml_ellipses(&self, line: &mut impl FnMut(Arguments)) {
        let last = self.last();
        for source in &last.sources {
            let ring = ellipse(&last.plane, &source.fix.ellipse(0.95));
            let ring: Vec<String> = (ring.iter().chain(ring.first()))
                .map(|[x, y]| format!("{x:.7},{y:.7}"))
                .collect();
            line(format_args!(
                "<Placemark><name>source {}, 95 %</name><styleUrl>#ellipse</styleUrl><Polygon><outerBoundaryIs>\
                 <LinearRing><coordinates>{}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>",
                source.identity,
                ring.join(" ")
            ));
        }
    }
}

/// Text as XML has it.
pub(super) fn escaped(text: &str) -> String {
    let is_legal = |c: &char| !c.is_control();
    let mut escaped = String::new();
    for c in text.chars().filter(is_legal) {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
    }
    escaped
}
