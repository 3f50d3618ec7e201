//! Lines of logs that were not used, and why.

use std::{collections::BTreeMap, path::PathBuf};

use foxhunt::gateway::{Event, Rejected};
use serde::Serialize;

use crate::{
    engine::{Happened, legible, why},
    log,
};

/// Of each reason, the places that are told.
const PLACES: usize = 5;

/// Lines that were refused, by their reasons.
#[derive(Debug, Default)]
pub struct Refusals {
    logs: Vec<String>,
    by_reason: BTreeMap<String, Refused>,
    packets: u64,
}

/// Lines that were refused for one reason.
#[derive(Debug, Clone, Serialize)]
pub struct Refused {
    pub reason: String,
    pub count: u64,
    /// Where the first ones are: the log and the number of the line.
    pub places: Vec<String>,
    /// The first one.
    pub line: String,
    pub help: Option<&'static str>,
}

impl Refusals {
    /// None so far, of some logs.
    pub fn of(files: &[PathBuf]) -> Self {
        Self {
            logs: files.iter().map(|file| log::name(file)).collect(),
            ..Self::default()
        }
    }

    /// Notes what follows from a log.
    pub fn note(&mut self, happened: &Happened<'_>) {
        match happened {
            Happened::Line {
                input,
                number,
                line,
                event: Event::Rejected(reason),
            } => self.add(*input, *number, why(*reason, line), line, advice(*reason)),
            Happened::Refused {
                input,
                number,
                reason,
            } => self.add(*input, *number, reason.to_string(), b"", None),
            Happened::Line { line, .. } => {
                self.packets += u64::from(line.starts_with(b"$PFOXB,"));
            }
            _ => {}
        }
    }

    fn add(
        &mut self,
        input: usize,
        number: u64,
        reason: String,
        line: &[u8],
        help: Option<&'static str>,
    ) {
        let log = self.logs.get(input).or(self.logs.first());
        let place = format!("{}:{number}", log.map_or("", String::as_str));
        let entry = (self.by_reason)
            .entry(reason.clone())
            .or_insert_with(|| Refused {
                reason,
                count: 0,
                places: Vec::new(),
                line: legible(line),
                help,
            });
        entry.count += 1;
        if entry.places.len() < PLACES {
            entry.places.push(place);
        }
    }

    /// Those of each reason, the most frequent first.
    pub fn sorted(&self) -> Vec<&Refused> {
        let mut all: Vec<&Refused> = self.by_reason.values().collect();
        all.sort_by_key(|one| std::cmp::Reverse(one.count));
        all
    }

    /// What to do with a log of something else than bearings.
    pub fn hint(&self) -> Option<String> {
        (self.packets > 0).then(|| {
            format!(
                "{} lines are packets of tags: `foxhunt live` locates tags by them, if a [[site]] in its settings names the \
                 radio map and the input names the site (`foxhunt init` writes an example)",
                self.packets
            )
        })
    }
}

impl Refused {
    /// Where they are, in words: each log is named once in a row.
    pub fn where_they_are(&self) -> String {
        let mut last = "";
        let places = self
            .places
            .iter()
            .map(|place| match place.rsplit_once(':') {
                Some((log, number)) if log == last => number,
                Some((log, _)) => {
                    last = log;
                    place
                }
                None => place,
            });
        let places = places.collect::<Vec<_>>().join(", ");
        match self.count - self.places.len() as u64 {
            0 => places,
            more => format!("{places} and {more} more"),
        }
    }
}

/// What to do about lines that were refused.
fn advice(reason: Rejected) -> Option<&'static str> {
    Some(match reason {
        Rejected::NoHeading => {
            "bearings count from the bow: send HDT sentences, or say `--reference true-north` if they are absolute, or \
             `--heading station` of a KrakenSDR that stands"
        }
        Rejected::LowQuality => {
            "the finder hears nothing, or its quality is on another scale: try `--minimum-quality 0`"
        }
        Rejected::StalePosition => {
            "the receiver was silent, or the clock of the finder is wrong, or lines stand in another order than they came"
        }
        Rejected::NoPosition => "the receiver had no position yet",
        Rejected::Frozen => "the KrakenSDR heard nothing, and repeated what it last heard",
        Rejected::Duplicate => "the page of a finder was read twice, which does no harm",
        Rejected::Checksum => {
            "lines were damaged: look at the cable, the baud rate, and whether two programs read the port"
        }
        Rejected::Unparsable => "these are no lines of a known device, or parts of some",
        Rejected::Turning => "there is no compass, and the course is no heading in a bend",
        Rejected::NoVariation => "say how far magnetic north is off: `--variation DEGREES`",
        Rejected::Simulated => "to use positions of a simulator: `--simulated`",
        Rejected::TimeBackwards => "two clocks are mixed on one line, or a clock was set back",
        Rejected::Unconfirmed => {
            "a position waits for a second that agrees: one or two at the beginning are usual"
        }
        Rejected::OtherFrequency
        | Rejected::OtherTag
        | Rejected::OtherFinder
        | Rejected::OtherAnchor => "the options name another one",
        _ => return None,
    })
}
