//! The reports of a tunnel's gateway.

use std::fmt;

use foxhunt::gateway::beacon::Rejected;

use super::sentence::fields;

/// A report of the gateway.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    Fix(TagFix),
    /// A radio hears nothing, or hears again.
    Radio {
        time: f64,
        radio: u32,
        is_silent: bool,
    },
    Status(Status),
}

/// A fix as it is reported: seconds and metres.
#[derive(Debug, Clone, PartialEq)]
pub struct TagFix {
    pub time: f64,
    pub tag: u32,
    pub state: String,
    pub place: [f64; 2],
    pub velocity: [f64; 2],
    /// Along the longer axis of its uncertainty.
    pub sigma: f64,
    /// In dB.
    pub offset: f64,
}

/// What became of the messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    counts: Vec<u32>,
}

impl TagFix {
    /// Where the tag is at another time, if it goes on as it did.
    pub fn place_at(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|d| self.place[d] + (time - self.time) * self.velocity[d])
    }
}

/// All whole reports of the gateway among the bytes, in order; other lines are left out.
pub fn parse(bytes: &[u8]) -> Vec<Report> {
    String::from_utf8_lossy(bytes)
        .lines()
        .filter_map(|line| sentence(&fields(line)?))
        .collect()
}

fn sentence(fields: &[&str]) -> Option<Report> {
    let number = |text: &str| text.parse::<f64>().ok();
    match fields {
        [
            "PFOXT",
            time,
            tag,
            state,
            x,
            y,
            vx,
            vy,
            major,
            _minor,
            _orientation,
            offset,
            _size,
        ] => Some(Report::Fix(TagFix {
            time: 1e-3 * number(time)?,
            tag: tag.parse().ok()?,
            state: (*state).to_owned(),
            place: [number(x)?, number(y)?],
            velocity: [number(vx)?, number(vy)?],
            sigma: number(major)?,
            offset: number(offset)?,
        })),
        ["PFOXL", time, radio, what @ ("SILENT" | "HEARD")] => Some(Report::Radio {
            time: 1e-3 * number(time)?,
            radio: radio.parse().ok()?,
            is_silent: *what == "SILENT",
        }),
        ["PFOXS", counts @ ..] => {
            let counts = counts.iter().map(|count| count.parse().ok());
            Some(Report::Status(Status {
                counts: counts.collect::<Option<_>>()?,
            }))
        }
        _ => None,
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MESSAGES: [&str; 5] = [
            "messages",
            "packets used",
            "sentences ignored",
            "queries",
            "restarts",
        ];
        const TAGS: [&str; 3] = ["tags", "radios silent", "tags evicted"];
        let names = MESSAGES.map(String::from).into_iter();
        let names = names.chain(Rejected::ALL.map(|reason| format!("rejected ({reason})")));
        let names = names.chain(TAGS.map(String::from));
        let counts = self.counts.iter().zip(names);
        let counts = counts
            .filter(|(count, name)| **count > 0 || !name.starts_with("rejected"))
            .map(|(count, name)| format!("{count} {name}"));
        f.write_str(&counts.collect::<Vec<_>>().join(", "))
    }
}
