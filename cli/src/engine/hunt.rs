//! A gateway with whatever locator, behind one face.

use std::collections::BTreeSet;

use anyhow::Result;
use foxhunt::{
    aoa::{
        Advice, Answer, Hypothesis, Locate, Manoeuvring, Mixture, Observation, Robust, Source,
        clean, geodesy::LocalPlane, manoeuvring, multi,
    },
    gateway::{BearingRecord, Counters, Event, FullReport, Gateway, Receiver, formats::All},
};
use foxhunt_gateways::{plain, robust};
use foxhunt_host::archive::{Answered, Archive, Notes};

use super::kept::{self, Kept};
use crate::reading::{Belief, Kind, Reading};

/// The most inputs: each has a port of its own.
pub const PORTS: usize = 64;

/// The most sources and hypotheses that are asked for.
const MOST: usize = 16;

/// A gateway, its locator, and what was noted of both.
pub trait Hunt: Send {
    /// Notes bytes that are about to be read.
    fn announce(&mut self, bytes: &[u8]);
    /// See [`foxhunt::gateway::Vehicle::push`].
    fn push(&mut self, port: usize, byte: u8) -> Option<Event>;
    /// See [`foxhunt::gateway::Vehicle::push_record`].
    fn record(&mut self, port: usize, record: &BearingRecord) -> Event;
    /// Takes a bearing of this search back, or takes it again, by its place; says whether anything has changed.
    fn retract(&mut self, index: usize, is_retracted: bool) -> bool;
    /// How many bearings this search had.
    fn bearings(&self) -> usize;
    fn report(&self) -> &str;
    fn line(&self, port: usize) -> &[u8];
    fn counters(&self) -> &Counters;
    fn port_counters(&self, port: usize) -> Option<&Counters>;
    fn receiver(&self) -> Receiver;
    fn plane(&self) -> Option<LocalPlane>;
    fn observation(&self) -> Option<Observation>;
    /// The time of the newest bearing, in milliseconds after midnight.
    fn time_ms(&self) -> Option<u32>;
    fn answer(&self) -> Answer;
    fn sources(&self) -> Vec<Source>;
    /// Where the source may be, or where one more may be.
    fn hypotheses(&self) -> Vec<Hypothesis>;
    fn advice(&self) -> Option<Advice>;
    fn classify(&self, observation: &Observation) -> Option<Mixture>;
    /// Particles of all sources, at most so many, in metres.
    fn particles(&self, most: usize) -> Vec<[f32; 2]>;
    /// What each bearing led to so far.
    fn answers(&self) -> &[Answered];
    /// All that is known.
    fn archive(&self) -> Result<Archive>;
}

struct Hunter<L: Locate + Clone> {
    gateway: Box<Gateway<Kept<L>, All, FullReport, PORTS>>,
    notes: Notes,
    /// Bearings before this search.
    before: usize,
    /// Bearings of all searches that were taken back.
    retracted: BTreeSet<usize>,
}

/// A gateway with the locator of a kind.
///
/// # Errors
/// Names what is out of range, or of no use.
pub fn hunt(kind: Kind, reading: &Reading, belief: &Belief) -> Result<Box<dyn Hunt>> {
    belief.check(kind)?;
    match kind {
        Kind::Plain => boxed::<plain::Locator>(reading, clean::Config::DEFAULT),
        Kind::Robust => {
            let track = manoeuvring::Config::new(belief.config()?);
            boxed::<robust::Locator>(reading, multi::Config::new(track))
        }
        Kind::Single => boxed::<Robust<256>>(reading, belief.config()?),
        Kind::Moving => {
            let config = manoeuvring::Config::new(belief.config()?);
            boxed::<Manoeuvring<Robust<256>>>(reading, config)
        }
    }
}

fn boxed<L: Locate + Clone + Send + 'static>(
    reading: &Reading,
    inner: L::Config,
) -> Result<Box<dyn Hunt>>
where
    L::Config: Send,
{
    let seed = reading.seed();
    let config = reading.config(kept::Config { inner, seed })?;
    Ok(Box::new(Hunter::<L> {
        gateway: Box::new(Gateway::new(config)?),
        notes: Notes::default(),
        before: 0,
        retracted: BTreeSet::new(),
    }))
}

impl<L: Locate + Clone> Hunter<L> {
    fn locator(&self) -> &Kept<L> {
        self.gateway.vehicle().locator()
    }

    fn config(&self) -> &kept::Config<L::Config> {
        &self.gateway.config().locator
    }

    fn note(&mut self, event: &Event) {
        if let Event::Fix(_) | Event::NotObservable(_) = event {
            let bearings = self.locator().count();
            self.before = (self.notes.answers().len() + 1).saturating_sub(bearings);
            let config = &self.gateway.config().locator;
            (self.notes).bearing(self.gateway.vehicle(), config, bearings as u32);
        }
    }
}

impl<L: Locate + Clone + Send> Hunt for Hunter<L>
where
    L::Config: Send,
{
    fn announce(&mut self, bytes: &[u8]) {
        self.notes.bytes(bytes);
    }

    fn push(&mut self, port: usize, byte: u8) -> Option<Event> {
        let event = self.gateway.push(port, byte);
        if let Some(event) = &event {
            self.note(event);
        }
        if event.is_some() {
            self.notes.line(self.gateway.vehicle());
        }
        event
    }

    fn record(&mut self, port: usize, record: &BearingRecord) -> Event {
        let config = *self.gateway.config();
        let event = (self.gateway.vehicle_mut()).push_record(port, record, &config);
        self.note(&event);
        self.notes.line(self.gateway.vehicle());
        event
    }

    fn retract(&mut self, index: usize, is_retracted: bool) -> bool {
        let config = *self.config();
        let locator = self.gateway.vehicle_mut().locator_mut();
        let has_changed = locator.retract(index, is_retracted, &config);
        if has_changed {
            self.notes.renew(self.gateway.vehicle(), &config);
            let index = self.before + index;
            if is_retracted {
                self.retracted.insert(index);
            } else {
                self.retracted.remove(&index);
            }
        }
        has_changed
    }

    fn bearings(&self) -> usize {
        self.locator().count()
    }

    fn report(&self) -> &str {
        self.gateway.vehicle().report()
    }

    fn line(&self, port: usize) -> &[u8] {
        self.gateway.vehicle().line(port)
    }

    fn counters(&self) -> &Counters {
        self.gateway.vehicle().counters()
    }

    fn port_counters(&self, port: usize) -> Option<&Counters> {
        self.gateway.vehicle().port_counters(port)
    }

    fn receiver(&self) -> Receiver {
        self.gateway.vehicle().receiver()
    }

    fn plane(&self) -> Option<LocalPlane> {
        self.gateway.vehicle().plane().copied()
    }

    fn observation(&self) -> Option<Observation> {
        self.gateway.vehicle().observation()
    }

    fn time_ms(&self) -> Option<u32> {
        self.gateway.vehicle().time_ms()
    }

    fn answer(&self) -> Answer {
        self.locator().answer()
    }

    fn sources(&self) -> Vec<Source> {
        let locator = self.locator();
        (0..MOST).map_while(|k| locator.source(k)).collect()
    }

    fn hypotheses(&self) -> Vec<Hypothesis> {
        let locator = self.locator();
        let candidates = (0..MOST).map_while(|k| locator.candidate(k));
        match locator.fix() {
            Some(_) => candidates.collect(),
            None => (0..MOST).map_while(|k| locator.hypothesis(k)).collect(),
        }
    }

    fn advice(&self) -> Option<Advice> {
        self.locator().advice(self.config())
    }

    fn classify(&self, observation: &Observation) -> Option<Mixture> {
        self.locator().classify(observation, self.config())
    }

    fn particles(&self, most: usize) -> Vec<[f32; 2]> {
        let locator = self.locator();
        let clouds: Vec<_> = (0..MOST).map_while(|k| locator.cloud(k)).collect();
        let each = most.checked_div(clouds.len()).unwrap_or(0);
        let drawn = clouds.iter().flat_map(|cloud| {
            let mut places = Vec::with_capacity(each);
            // Systematic, from the middle of the first of so many equal parts of the weight.
            let (mut sum, mut next) = (0.0, 0.5);
            for ((east, north), weight) in cloud.east.iter().zip(cloud.north).zip(cloud.weights) {
                sum += weight * each as f32;
                while next <= sum && places.len() < each {
                    places.push([*east, *north]);
                    next += 1.0;
                }
            }
            places
        });
        drawn.collect()
    }

    fn answers(&self) -> &[Answered] {
        self.notes.answers()
    }

    fn archive(&self) -> Result<Archive> {
        let (vehicle, config) = (self.gateway.vehicle(), self.config());
        let is_retracted = |index: usize| self.retracted.contains(&index);
        self.notes.archive(vehicle, config, is_retracted)
    }
}
