//! What is noted while a log is read.

use std::f64::consts::PI;

use anyhow::{Context, Result};
use foxhunt::{
    ConfigError,
    aoa::{Locate, Mixture, Observation, Source},
    gateway::{Config, Event, ReportForm, Vehicle, formats::Formats},
};

use super::{Answered, Archive, Kind, PROBABILITIES, Passed, Taken};
use crate::{
    density, drive,
    replay::{FullReplay, SOURCES, by_weight},
};
use foxhunt_simulation::{Sight, sight::wrap};

/// The most hypotheses that are asked for.
const HYPOTHESES: usize = 16;
/// A hypothesis of less than this probability is not worth a line.
const SMALLEST: f32 = 1e-3;

/// What is noted of a gateway while it reads.
#[derive(Debug, Clone, Default)]
pub struct Notes {
    track: Vec<Passed>,
    answers: Vec<Answered>,
    taken: Vec<Taken>,
    /// The beginning of the log, where a simulated one says where its sources are.
    beginning: Vec<u8>,
}

/// Bytes of the sentences that say so: as many as sources are asked for.
const BEGINNING: usize = 64 * SOURCES;

impl Notes {
    /// What each bearing led to so far.
    pub fn answers(&self) -> &[Answered] {
        &self.answers
    }

    /// Every bearing that was used, as judged when it was taken.
    pub fn bearings(&self) -> &[Taken] {
        &self.taken
    }

    /// Bytes that are about to be read.
    pub fn bytes(&mut self, bytes: &[u8]) {
        let room = BEGINNING.saturating_sub(self.beginning.len());
        self.beginning.extend(bytes.iter().take(room));
    }

    /// After a line has ended.
    pub fn line<L: Locate, F: Formats, R: ReportForm, const P: usize>(
        &mut self,
        gateway: &Vehicle<L, F, R, P>,
    ) {
        let Some(place) = gateway.place() else {
            return;
        };
        if self.track.last().is_none_or(|last| last.place != place) {
            let time_ms = gateway.receiver().time_ms.or(gateway.time_ms());
            self.track.push(Passed { time_ms, place });
        }
    }

    /// After a bearing was used, the last of so many of its search.
    pub fn bearing<L: Locate, F: Formats, R: ReportForm, const P: usize>(
        &mut self,
        gateway: &Vehicle<L, F, R, P>,
        config: &L::Config,
        bearings: u32,
    ) {
        let (Some(plane), Some(observation), Some(time_ms)) =
            (gateway.plane(), gateway.observation(), gateway.time_ms())
        else {
            return;
        };
        let last = self.answers.last().map_or(0, |last| last.search);
        let search = last + u32::from(bearings == 1 || last == 0);
        let locator = gateway.locator();
        let known = Answered {
            time_ms,
            search,
            plane: *plane,
            bearings,
            answer: locator.answer(),
            sources: (0..SOURCES)
                .map_while(|index| locator.source(index))
                .collect(),
            bias: locator.bias(config),
            rates: locator.rates(config),
        };
        let taken = Taken {
            time_ms,
            search,
            plane: *plane,
            observation,
            chances: None,
            past: false,
            fits: None,
        };
        self.taken.push(judged(taken, &known, locator, config));
        self.answers.push(known);
    }

    /// After bearings were taken back: what is known with the last one is other now.
    pub fn renew<L: Locate, F: Formats, R: ReportForm, const P: usize>(
        &mut self,
        gateway: &Vehicle<L, F, R, P>,
        config: &L::Config,
    ) {
        let locator = gateway.locator();
        if let Some(last) = self.answers.last_mut() {
            last.answer = locator.answer();
            last.sources = (0..SOURCES)
                .map_while(|index| locator.source(index))
                .collect();
            last.bias = locator.bias(config);
            last.rates = locator.rates(config);
        }
    }

    /// What is known now, without the bearings that were taken back, by their place among all.
    ///
    /// # Errors
    /// If no bearing was used yet.
    pub fn archive<L: Locate, F: Formats, R: ReportForm, const P: usize>(
        &self,
        gateway: &Vehicle<L, F, R, P>,
        config: &L::Config,
        is_retracted: impl Fn(usize) -> bool,
    ) -> Result<Archive> {
        let last = self.answers.last().context("no bearing was used")?;
        let locator = gateway.locator();
        let now = |then: &Taken| {
            // Of a search before the last it is known what it was when it was taken.
            if then.search != last.search {
                return *then;
            }
            let now = judged(*then, last, locator, config);
            let has_left = |(source, _): &(Source, f64)| {
                let same = |other: &&Source| other.identity == source.identity;
                let found = last.sources.iter().find(same);
                found.is_none_or(|found| found.motion.is_some())
            };
            let is_past = now.kind() == Some(Kind::Outlier)
                && matches!(then.kind(), Some(Kind::Direct | Kind::Mirrored))
                && then.fits.as_ref().is_some_and(has_left);
            if is_past {
                Taken {
                    past: true,
                    ..*then
                }
            } else {
                now
            }
        };
        let kept = |(index, taken)| (!is_retracted(index)).then(|| now(taken));
        let clouds = || (0..SOURCES).map_while(|index| locator.cloud(index));
        Ok(Archive {
            midnight_ms: 0,
            track: self.track.clone(),
            answers: self.answers.clone(),
            bearings: self.taken.iter().enumerate().filter_map(kept).collect(),
            hypotheses: (0..HYPOTHESES)
                .map_while(|index| locator.hypothesis(index))
                .filter(|hypothesis| hypothesis.probability >= SMALLEST)
                .collect(),
            particles: clouds().flat_map(|cloud| by_weight(&cloud)).collect(),
            densities: clouds()
                .map(|cloud| density::regions(&cloud, &PROBABILITIES))
                .collect(),
            advice: locator.advice(config),
            truths: drive::truths(&self.beginning).collect(),
        })
    }
}

/// Reads a log, and notes what every bearing led to.
#[derive(Debug)]
pub struct Recorder<L: Locate> {
    replay: FullReplay<L>,
    notes: Notes,
}

impl<L: Locate> Recorder<L> {
    /// A recorder that has read nothing yet.
    ///
    /// # Errors
    /// Names the field of the configuration that is out of range.
    pub fn new(config: Config<L::Config>) -> Result<Self, ConfigError> {
        Ok(Self {
            replay: FullReplay::new(config)?,
            notes: Notes::default(),
        })
    }

    /// The gateway and what it said.
    pub fn replay(&self) -> &FullReplay<L> {
        &self.replay
    }

    /// What each bearing led to so far.
    pub fn answers(&self) -> &[Answered] {
        self.notes.answers()
    }

    /// Reads on.
    pub fn push(&mut self, bytes: &[u8]) {
        self.notes.bytes(bytes);
        for &byte in bytes {
            let event = self.replay.step(byte);
            let (gateway, config) = (self.replay.gateway(), self.replay.config());
            if let Some(Event::Fix(_) | Event::NotObservable(_)) = event {
                let bearings = self.replay.sights().len() as u32;
                self.notes.bearing(gateway, config, bearings);
            }
            if matches!(byte, b'\r' | b'\n') {
                self.notes.line(gateway);
            }
        }
    }

    /// What is known now.
    ///
    /// # Errors
    /// If no bearing was used yet.
    pub fn archive(&self) -> Result<Archive> {
        let (gateway, config) = (self.replay.gateway(), self.replay.config());
        self.notes.archive(gateway, config, |_| false)
    }
}

/// The bearing with what it is by what a locator knows.
fn judged<L: Locate>(taken: Taken, known: &Answered, locator: &L, config: &L::Config) -> Taken {
    let chances = locator.classify(&taken.observation, config);
    Taken {
        chances,
        fits: fits(known, &taken.observation, chances),
        ..taken
    }
}

/// The source that a bearing fits best, and what it is off.
fn fits(
    known: &Answered,
    observation: &Observation,
    chances: Option<Mixture>,
) -> Option<(Source, f64)> {
    let bias = known.bias.map_or(0.0, |bias| f64::from(bias.mean_rad));
    let mirrored = chances.is_some_and(|chances| chances.mirrored > chances.direct);
    let turn = bias + if mirrored { PI } else { 0.0 };
    let sight = Sight::from(observation);
    (known.sources.iter())
        .map(|source| {
            let off = sight.residual(source.fix.position.map(f64::from)) - turn;
            (*source, wrap(off))
        })
        .min_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
}
