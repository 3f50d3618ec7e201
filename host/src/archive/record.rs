//! What is noted while a log is read.

use std::f64::consts::PI;

use anyhow::{Context, Result};
use foxhunt::{
    ConfigError,
    aoa::{Locate, Mixture, Observation, Source, geodesy::Geodetic},
    gateway::{Config, Event},
};

use super::{Answered, Archive, Kind, PROBABILITIES, Taken};
use crate::{
    density, drive,
    replay::{FullReplay, SOURCES},
};
use foxhunt_simulation::{Sight, sight::wrap};

/// The most hypotheses that are asked for.
const HYPOTHESES: usize = 16;
/// A hypothesis of less than this probability is not worth a line.
const SMALLEST: f32 = 1e-3;

/// Reads a log, and notes what every bearing led to.
#[derive(Debug)]
pub struct Recorder<L: Locate> {
    replay: FullReplay<L>,
    track: Vec<Geodetic>,
    answers: Vec<Answered>,
    taken: Vec<Taken>,
    /// The beginning of the log, where a simulated one says where its sources are.
    beginning: Vec<u8>,
}

/// Bytes of the sentences that say so: as many as sources are asked for.
const BEGINNING: usize = 64 * SOURCES;

impl<L: Locate> Recorder<L> {
    /// A recorder that has read nothing yet.
    ///
    /// # Errors
    /// Names the field of the configuration that is out of range.
    pub fn new(config: Config<L::Config>) -> Result<Self, ConfigError> {
        Ok(Self {
            replay: FullReplay::new(config)?,
            track: Vec::new(),
            answers: Vec::new(),
            taken: Vec::new(),
            beginning: Vec::new(),
        })
    }

    /// The gateway and what it said.
    pub fn replay(&self) -> &FullReplay<L> {
        &self.replay
    }

    /// What each bearing led to so far.
    pub fn answers(&self) -> &[Answered] {
        &self.answers
    }

    /// Reads on.
    pub fn push(&mut self, bytes: &[u8]) {
        let room = BEGINNING.saturating_sub(self.beginning.len());
        self.beginning.extend(bytes.iter().take(room));
        for &byte in bytes {
            if let Some(Event::Fix(_) | Event::NotObservable(_)) = self.replay.step(byte) {
                self.note();
            }
            if matches!(byte, b'\r' | b'\n')
                && let Some(place) = self.replay.gateway().place()
                && self.track.last() != Some(&place)
            {
                self.track.push(place);
            }
        }
    }

    /// After a bearing was used.
    fn note(&mut self) {
        let gateway = self.replay.gateway();
        let (Some(plane), Some(observation), Some(time_ms)) =
            (gateway.plane(), gateway.observation(), gateway.time_ms())
        else {
            return;
        };
        let bearings = self.replay.sights().len() as u32;
        let last = self.answers.last().map_or(0, |last| last.search);
        let search = last + u32::from(bearings == 1);
        let (locator, config) = (gateway.locator(), self.replay.config());
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

    /// What is known now.
    ///
    /// # Errors
    /// If no bearing was used yet.
    pub fn archive(&self) -> Result<Archive> {
        let last = self.answers.last().context("no bearing was used")?;
        let (locator, config) = (self.replay.gateway().locator(), self.replay.config());
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
        let bearings = self.taken.iter().map(now).collect();
        Ok(Archive {
            track: self.track.clone(),
            answers: self.answers.clone(),
            bearings,
            hypotheses: (0..HYPOTHESES)
                .map_while(|index| locator.hypothesis(index))
                .filter(|hypothesis| hypothesis.probability >= SMALLEST)
                .collect(),
            particles: self.replay.particles(),
            densities: (self.replay.clouds())
                .map(|cloud| density::regions(&cloud, &PROBABILITIES))
                .collect(),
            advice: locator.advice(config),
            truths: drive::truths(&self.beginning).collect(),
        })
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
