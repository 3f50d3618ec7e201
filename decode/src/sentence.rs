//! Sentences that say what a message said.

use std::fmt::Write;

use chrono::DateTime;

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
        let time = DateTime::from_timestamp_millis(self.time_ms).unwrap_or_default();
        let (clock, date) = (time.format("%H%M%S"), time.format("%d%m%y"));
        let centiseconds = time.timestamp_subsec_millis() / 10;
        let side =
            |degrees: f64, [plus, minus]: [char; 2]| if degrees < 0.0 { minus } else { plus };
        let optional = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.3}"));
        let knots = self.speed_m_s.map(|speed| speed.max(0.0) * 3600.0 / 1852.0);
        let course = self.course_deg.map(|course| course.rem_euclid(360.0));
        let mut lines = sentence(&format!(
            "GPRMC,{clock}.{centiseconds:02},A,{},{},{},{},{},{},{date},,,A",
            coordinate(self.latitude, 2),
            side(self.latitude, ['N', 'S']),
            coordinate(self.longitude, 3),
            side(self.longitude, ['E', 'W']),
            optional(knots),
            optional(course),
        ));
        if let Some(heading) = self.heading_deg {
            let heading = heading.rem_euclid(360.0);
            lines += &sentence(&format!("GPHDT,{heading:.2},T"));
        }
        lines.into_bytes()
    }
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
