//! The reports of a vehicle.

use std::fmt;

use foxhunt::gateway::Rejected;
use foxhunt_host::geodesy::Place;

use super::sentence::fields;

/// A report of the gateway.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    Fix(ReportedFix),
    /// No fix, and the words why.
    NoFix(String),
    Status(Status),
}

/// A fix as it is reported.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportedFix {
    time: String,
    pub place: Place,
    /// Standard deviations along the axes of the uncertainty, in metres.
    pub sigmas: [f64; 2],
    pub bearings: u32,
}

/// What became of the lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    /// Lines, sentences used, bearings used, sentences ignored, and the rejections by reason.
    counts: Vec<u32>,
}

/// All whole reports of the gateway among the bytes, in order; other lines are left out.
pub fn parse(bytes: &[u8]) -> Vec<Report> {
    String::from_utf8_lossy(bytes)
        .lines()
        .filter_map(sentence)
        .collect()
}

fn sentence(line: &str) -> Option<Report> {
    let fields = fields(line)?;
    match fields.as_slice() {
        [
            "PFOXF",
            time,
            latitude,
            north,
            longitude,
            east,
            major,
            minor,
            _orientation,
            bearings,
            ..,
        ] => Some(Report::Fix(ReportedFix {
            time: (*time).to_owned(),
            place: Place::from_nmea(&[*latitude, north, longitude, east].join(","))?,
            sigmas: [major.parse().ok()?, minor.parse().ok()?],
            bearings: bearings.parse().ok()?,
        })),
        ["PFOXN", _time, reason, bearings, ..] => {
            Some(Report::NoFix(format!("{reason} after {bearings} bearings")))
        }
        ["PFOXS", counts @ ..] => {
            let counts = counts
                .iter()
                .map(|count| count.parse().ok())
                .collect::<Option<_>>()?;
            Some(Report::Status(Status { counts }))
        }
        _ => None,
    }
}

impl ReportedFix {
    /// One line for the terminal.
    pub fn line(&self, truth: Place) -> String {
        let [east, north] = truth.local(self.place);
        let clock: Vec<&str> = [0..2, 2..4, 4..6]
            .into_iter()
            .filter_map(|part| self.time.get(part))
            .collect();
        format!(
            "{}  {:3} bearings  {:.7} {:.7}  {:8.2} m from the truth  1 sigma {:.2} x {:.2} m",
            clock.join(":"),
            self.bearings,
            self.place.latitude,
            self.place.longitude,
            east.hypot(north),
            self.sigmas[0],
            self.sigmas[1],
        )
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 4] = [
            "lines",
            "sentences used",
            "bearings used",
            "sentences ignored",
        ];
        let (counts, rejections) = self.counts.split_at(NAMES.len().min(self.counts.len()));
        let counts = counts
            .iter()
            .zip(NAMES)
            .map(|(count, name)| format!("{count} {name}"));
        let rejections = rejections
            .iter()
            .zip(Rejected::ALL)
            .filter(|(count, _)| **count > 0)
            .map(|(count, reason)| format!("{count} rejected ({reason})"));
        f.write_str(&counts.chain(rejections).collect::<Vec<_>>().join(", "))
    }
}
