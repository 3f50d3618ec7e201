//! Pieces in, results out.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use foxhunt::{
    aoa::{Observation, geodesy::Geodetic},
    gateway::{Counters, Event, Rejected},
};
use foxhunt_decode::{self as decode, Decoded, Key, Part, Refusal, Stream};
use foxhunt_host::archive::{Answered, Archive};

use super::{
    board::Board,
    dates::{DAY, Dates},
    hunt::{self, Hunt, PORTS},
    input::Input,
    message::{self, Mark, Message},
    piece::{Piece, What},
    refused::{Refusals, why},
    setup::Setup,
    site::{Site, rounded},
    words,
};

/// What follows from a piece.
pub enum Happened<'a> {
    /// For pages and other programs.
    Message(Message),
    /// Sentences, as the firmware sends them.
    Report(&'a str),
    /// What a line of an input led to.
    Line {
        input: usize,
        /// Its number among the lines of the input, from 1 on.
        number: u64,
        line: &'a [u8],
        event: &'a Event,
    },
    /// A message of an input was of no use.
    Refused {
        input: usize,
        number: u64,
        reason: Refusal,
    },
}

pub(super) type Say<'a> = &'a mut dyn FnMut(Happened<'_>);

/// A search.
pub struct Engine {
    pub(super) hunt: Box<dyn Hunt>,
    name: String,
    pub(super) inputs: Vec<Input>,
    pub(super) ports: Vec<Port>,
    pub(super) sites: Vec<Site>,
    pub(super) dates: Dates,
    pub(super) bearings: Vec<Taken>,
    pub(super) keys: BTreeMap<Key, u64>,
    pub(super) search: u32,
    pub(super) retracts: Retracts,
    pub(super) marks: BTreeMap<u64, Mark>,
    pub(super) next_mark: u64,
    pub(super) place: Option<Geodetic>,
    /// The time of the newest bearing of the search, as the locator counts it.
    newest_ms: u32,
    /// When the piece that is taken came in.
    pub(super) arrived_ms: i64,
    refusals: Refusals,
    pub(super) board: Board,
}

/// Where bearings come from: an input, or one of the stations whose messages come by it.
pub(super) struct Port {
    pub name: String,
    pub input: usize,
}

/// A bearing that was used.
pub(super) struct Taken {
    pub search: u32,
    pub index: usize,
    pub is_retracted: bool,
    /// The observation, and its probability of being an outlier as it was told last.
    pub told: Option<(Observation, Option<f64>)>,
}

/// Retracts by people, which they can undo: when, and of which bearing.
#[derive(Debug, Default)]
pub(super) struct Retracts {
    pub done: Vec<(i64, u64)>,
}

impl Engine {
    /// A search that has heard nothing yet.
    ///
    /// # Errors
    /// Names what is out of range, or of no use.
    pub fn new(setup: &Setup) -> Result<Self> {
        ensure!(
            setup.inputs.len() <= PORTS,
            "there can be {PORTS} inputs at most"
        );
        let sites: Vec<Site> = (setup.sites.iter()).map(Site::new).collect::<Result<_>>()?;
        let input = |(name, of): &(String, Option<String>)| {
            let site = match of {
                None => None,
                Some(of) => {
                    let place = sites.iter().position(|site| site.name() == of);
                    ensure!(place.is_some(), "input {name}: there is no site {of}");
                    place
                }
            };
            Ok(Input {
                site,
                ..Input::default()
            })
        };
        let inputs: Vec<Input> = setup.inputs.iter().map(input).collect::<Result<_>>()?;
        let names = setup.inputs.iter().map(|(name, _)| name.clone());
        let port = |(input, name)| Port { name, input };
        let ports = names.enumerate().map(port).collect();
        Ok(Self {
            hunt: hunt::hunt(setup.locator, &setup.reading, &setup.belief)?,
            name: setup.name.clone(),
            ports,
            inputs,
            sites,
            dates: Dates::default(),
            bearings: Vec::new(),
            keys: BTreeMap::new(),
            search: 0,
            retracts: Retracts::default(),
            marks: BTreeMap::new(),
            next_mark: 1,
            place: None,
            newest_ms: 0,
            arrived_ms: 0,
            refusals: Refusals::default(),
            board: Board::default(),
        })
    }

    /// What is there before anything has come in.
    pub fn begin(&self, say: Say) {
        for site in &self.sites {
            say(Happened::Message(Message::Site(site.message())));
        }
        let answer = words::answer(&*self.hunt, 0);
        say(Happened::Message(Message::Answer(answer)));
    }

    /// Takes a piece.
    ///
    /// # Errors
    /// Why a command cannot be done.
    pub fn take(&mut self, piece: &Piece, say: Say) -> Result<()> {
        self.dates.arrived(piece.time_ms);
        self.arrived_ms = piece.time_ms;
        match &piece.what {
            What::Bytes {
                input,
                bytes,
                is_message,
            } => {
                ensure!(*input < self.inputs.len(), "there is no input {input}");
                self.bytes(*input, bytes, *is_message, piece.time_ms, say);
            }
            What::End { input } => {
                if *input < self.inputs.len() {
                    self.stream(*input, say, |stream, take| stream.end(take));
                    self.push(*input, b"\n", say);
                }
            }
            What::Command(command) => self.command(command, piece.time_ms, say)?,
        }
        Ok(())
    }

    fn bytes(&mut self, input: usize, bytes: &[u8], is_message: bool, time_ms: i64, say: Say) {
        if let Some(site) = self.inputs[input].site.and_then(|k| self.sites.get_mut(k)) {
            // The last byte of a datagram may be its line's last.
            let end: &[u8] = if is_message { b"\n" } else { b"" };
            for byte in bytes.iter().chain(end) {
                if let Some((tag, report)) = site.push(*byte, time_ms) {
                    if !report.is_empty() {
                        say(Happened::Report(report));
                    }
                    if let Some(tag) = tag {
                        say(Happened::Message(Message::Tag(tag)));
                    }
                }
            }
        } else if is_message {
            self.decoded(input, bytes, decode::message(bytes), say);
        } else {
            self.hunt.announce(bytes);
            self.stream(input, say, |stream, take| stream.push(bytes, take));
        }
    }

    /// Parts a stream, and takes what comes of it.
    fn stream(
        &mut self,
        input: usize,
        say: Say,
        part: impl FnOnce(&mut Stream, &mut dyn FnMut(Part<'_>)),
    ) {
        let mut stream = std::mem::take(&mut self.inputs[input].stream);
        part(&mut stream, &mut |part| match part {
            Part::Bytes(bytes) => self.push(input, bytes, say),
            Part::Object(object) => {
                self.decoded(input, object, decode::json(object), say);
                self.inputs[input].lines += 1;
            }
        });
        self.inputs[input].stream = stream;
    }

    fn decoded(&mut self, input: usize, text: &[u8], decoded: Result<Decoded, Refusal>, say: Say) {
        let done = match decoded {
            Ok(Decoded::Lines(lines)) => {
                self.hunt.announce(&lines);
                self.push(input, &lines, say);
                Ok(())
            }
            Ok(Decoded::Bearing(bearing)) => self.bearing(input, text, bearing, say),
            Ok(Decoded::Delete(key)) => self.delete(&key, say),
            Ok(Decoded::Nothing) => Ok(()),
            Err(reason) => Err(reason),
        };
        if let Err(reason) = done {
            self.inputs[input].refused_messages += 1;
            self.inputs[input].refuse(reason.to_string());
            let number = self.inputs[input].lines + 1;
            say(Happened::Refused {
                input,
                number,
                reason,
            });
            if reason != Refusal::Known {
                self.refused(input, reason.to_string(), text, say);
            }
        }
    }

    /// Lets the gateway read.
    fn push(&mut self, port: usize, bytes: &[u8], say: Say) {
        for byte in bytes {
            if let Some(event) = self.hunt.push(port, *byte) {
                let mut line = self.hunt.line(port).to_vec();
                if line.is_empty() {
                    line.clone_from(&self.inputs[port].begun);
                }
                self.happened(port, &event, &line, None, say);
                self.inputs[port].begun.clear();
            }
            self.inputs[port].begin(*byte);
        }
    }

    /// A bearing that did not come as a line.
    fn bearing(
        &mut self,
        input: usize,
        text: &[u8],
        bearing: decode::Bearing,
        say: Say,
    ) -> Result<(), Refusal> {
        let decode::Bearing {
            key,
            time_ms,
            is_of_others,
            mut record,
        } = bearing;
        let is_known = key.id.is_some() && self.keys.contains_key(&key);
        if is_known {
            return Err(Refusal::Known);
        }
        let port = (self.port_of(input, &key.station)).ok_or(Refusal::Field("station"))?;
        if let Some(time) = time_ms {
            self.dates.stated(time);
        }
        // What states a place but no time was taken now.
        let now = Some(self.arrived_ms).filter(|time| record.place.is_some() && *time > 0);
        record.time_ms = (time_ms.or(now)).map(|time| time.rem_euclid(DAY) as u32);
        let event = self.hunt.record(port, &record);
        self.happened(port, &event, text, Some((key, is_of_others)), say);
        Ok(())
    }

    /// The port of a station whose messages come by an input.
    fn port_of(&mut self, input: usize, station: &str) -> Option<usize> {
        if station.is_empty() {
            return Some(input);
        }
        let known = |port: &Port| port.input == input && port.name == station;
        let found = self.ports.iter().position(known);
        found.or_else(|| {
            let number = self.ports.len();
            (number < PORTS).then(|| {
                let name = station.to_owned();
                self.ports.push(Port { name, input });
                number
            })
        })
    }

    /// What an event of a port means to others.
    fn happened(
        &mut self,
        port: usize,
        event: &Event,
        line: &[u8],
        key: Option<(Key, bool)>,
        say: Say,
    ) {
        let input = self.ports.get(port).map_or(port, |port| port.input);
        let number = self.inputs.get(input).map_or(0, |input| input.lines + 1);
        say(Happened::Line {
            input,
            number,
            line,
            event,
        });
        // What is read twice, as the page of a finder, does no harm.
        let is_harmless = matches!(
            event,
            Event::Rejected(Rejected::Duplicate | Rejected::Frozen)
        );
        if let Event::Rejected(reason) = event {
            let why = why(*reason, line);
            if let Some(input) = self.inputs.get_mut(input) {
                input.refuse(why.clone());
            }
            if !is_harmless {
                self.refused(port, why, line, say);
            }
        }
        if *event == Event::Other
            && let Some(report) = decode::report(line)
        {
            self.reported(port, line, report, say);
        }
        let is_bearing = matches!(event, Event::Fix(_) | Event::NotObservable(_));
        if key.is_none() && (is_bearing || *event == Event::Used) {
            self.dates.line(line);
        }
        if !self.hunt.report().is_empty() {
            say(Happened::Report(self.hunt.report()));
        }
        self.moved(say);
        if is_bearing {
            self.taken(port, key, say);
        }
    }

    /// Tells where the vehicle is, if that is news.
    fn moved(&mut self, say: Say) {
        let receiver = self.hunt.receiver();
        let place = receiver.place.map(|place| place.value);
        if place.is_none() || place == self.place {
            return;
        }
        self.place = place;
        let course = receiver.heading_deg.or(receiver.course_deg);
        say(Happened::Message(Message::Receiver(message::Receiver {
            name: self.name.clone(),
            kind: message::Kind::Vehicle,
            lat: place.map(|place| f64::from(place.latitude_e7()) / 1e7),
            lon: place.map(|place| f64::from(place.longitude_e7()) / 1e7),
            heading_deg: course.map(|course| rounded(course.value.into(), 1)),
            time_ms: receiver.time_ms.map_or(0, |time| self.dates.at(time)),
        })));
    }

    /// A bearing was used.
    fn taken(&mut self, port: usize, key: Option<(Key, bool)>, say: Say) {
        let is_of_others = key.as_ref().is_some_and(|(_, is)| *is);
        let key = key.map(|(key, _)| key);
        let count = self.hunt.bearings();
        if count == 1 {
            self.search += 1;
            self.newest_ms = 0;
        }
        self.bearings.push(Taken {
            search: self.search,
            index: count.saturating_sub(1),
            is_retracted: false,
            told: None,
        });
        let id = self.bearings.len() as u64;
        let station = key.as_ref().filter(|key| !key.station.is_empty()).cloned();
        if let Some(key) = key.filter(|key| key.id.is_some()) {
            self.keys.insert(key, id);
        }
        let (Some(plane), Some(observation)) = (self.hunt.plane(), self.hunt.observation()) else {
            return;
        };
        // One that has come late is older than the newest.
        self.newest_ms = self.newest_ms.max(observation.time_ms());
        let time_ms = self.now_ms() - i64::from(self.newest_ms - observation.time_ms());
        let place = foxhunt_host::archive::coordinates(&plane, observation.position());
        if let Some([lon, lat]) = place {
            if let Some(Key { station: name, .. }) = station {
                say(Happened::Message(Message::Receiver(message::Receiver {
                    name,
                    kind: message::Kind::Station,
                    lat: Some(lat),
                    lon: Some(lon),
                    heading_deg: None,
                    time_ms,
                })));
            }
            let chances = self.hunt.classify(&observation);
            let outlier = chances.map(|chances| rounded(chances.outlier.into(), 3));
            if let Some(taken) = self.bearings.last_mut() {
                taken.told = Some((observation, outlier));
            }
            say(Happened::Message(Message::Bearing(message::Bearing {
                id,
                receiver: (self.ports.get(port)).map_or(String::new(), |port| port.name.clone()),
                time_ms,
                lat,
                lon,
                bearing_deg: rounded(observation.bearing().compass_degrees().into(), 2),
                sigma_deg: rounded(observation.sigma_rad().to_degrees().into(), 2),
                used: true,
                reason: None,
                outlier,
                is_of_others,
            })));
        }
        self.answer(say);
    }

    pub(super) fn answer(&mut self, say: Say) {
        let answer = words::answer(&*self.hunt, self.now_ms());
        say(Happened::Message(Message::Answer(answer)));
        self.classify_again(say);
    }

    /// Tells of a line or message of a port that was not used.
    fn refused(&mut self, port: usize, reason: String, text: &[u8], say: Say) {
        let name = self.ports.get(port).map_or("", |port| &port.name);
        let told = (self.refusals).take(name, reason, text, self.arrived_ms);
        if let Some(told) = told {
            say(Happened::Message(Message::Refused(told)));
        }
    }

    fn now_ms(&self) -> i64 {
        self.hunt.time_ms().map_or(0, |time| self.dates.at(time))
    }

    /// What became of all lines.
    pub fn counters(&self) -> &Counters {
        self.hunt.counters()
    }

    /// What each bearing led to so far.
    pub fn answers(&self) -> &[Answered] {
        self.hunt.answers()
    }

    /// All that is known.
    ///
    /// # Errors
    /// If no bearing was used.
    pub fn archive(&self) -> Result<Archive> {
        let mut archive = self.hunt.archive()?;
        if let Some(first) = archive.answers.first() {
            let last = archive.last();
            let ends = (first.time_ms, last.time_ms);
            // The date is that of the last bearing.
            let days = i64::from(ends.1 < ends.0);
            let end = self.dates.at(ends.1);
            archive.midnight_ms = end - end.rem_euclid(DAY) - days * DAY;
        }
        Ok(archive)
    }
}
