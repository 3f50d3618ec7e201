//! Sentences that say what a message said.

use std::fmt::Write;

/// What a receiver says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Navigation {
    /// Milliseconds after 1970.
    pub time_ms: i64,
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Over ground, in metres a second.
    pub speed_m_s: Option<f64>,
    /// Over ground, in degrees clockwise from true north.
    pub course_deg: Option<f64>,
    /// Of the bow, in degrees clockwise from true north.
    pub heading_deg: Option<f64>,
}

impl Navigation {
    /// RMC, and HDT if there is a heading.
    pub fn lines(&self) -> Vec<u8> {
        let [year, month, day, hour, minute, milliseconds] = parts(self.time_ms);
        let (seconds, centiseconds) = (milliseconds / 1000, milliseconds % 1000 / 10);
        let side =
            |degrees: f64, [plus, minus]: [char; 2]| if degrees < 0.0 { minus } else { plus };
        let optional = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.3}"));
        let knots = self.speed_m_s.map(|speed| speed.max(0.0) * 3600.0 / 1852.0);
        let course = self.course_deg.map(|course| course.rem_euclid(360.0));
        let mut lines = sentence(&format!(
            "GPRMC,{hour:02}{minute:02}{seconds:02}.{centiseconds:02},A,{},{},{},{},{},{},{day:02}{month:02}{:02},,,A",
            coordinate(self.latitude, 2),
            side(self.latitude, ['N', 'S']),
            coordinate(self.longitude, 3),
            side(self.longitude, ['E', 'W']),
            optional(knots),
            optional(course),
            year % 100,
        ));
        if let Some(heading) = self.heading_deg {
            let heading = heading.rem_euclid(360.0);
            lines += &sentence(&format!("GPHDT,{heading:.2},T"));
        }
        lines.into_bytes()
    }
}

/// Year, month, day, hour, minute, milliseconds.
fn parts(time_ms: i64) -> [i64; 6] {
    let text = foxhunt_host::archive::times::date(time_ms);
    let number = |from: usize, to: usize| text.get(from..to).and_then(|t| t.parse().ok());
    let part = |from, to| number(from, to).unwrap_or(0);
    [
        part(0, 4),
        part(5, 7),
        part(8, 10),
        part(11, 13),
        part(14, 16),
        1_000 * part(17, 19) + part(20, 23),
    ]
}

/// Degrees and minutes, the degrees of so many digits, without the sign.
pub fn coordinate(degrees: f64, width: usize) -> String {
    let minutes = (degrees.abs() * 60.0 * 1e7).round() as u64;
    let (whole, rest) = (minutes / 600_000_000, minutes % 600_000_000);
    format!(
        "{whole:0width$}{:02}.{:07}",
        rest / 10_000_000,
        rest % 10_000_000
    )
}

/// A sentence with its dollar, its checksum and its end.
pub fn sentence(payload: &str) -> String {
    let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
    let mut sentence = String::with_capacity(payload.len() + 6);
    write!(sentence, "${payload}*{sum:02X}\r\n").expect("a string takes all");
    sentence
}
