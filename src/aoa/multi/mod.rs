//! Several sources on one channel.
//!
//! * Data association: a bearing goes to the track or the candidate that explains it best, if it is likelier to be of that
//!   source, direct or mirrored, than an outlier. If others explain it, too, it counts for the probability that it is of none
//!   of them.
//! * Track initiation: all other bearings are kept together. The modes of their posterior that would each make a fix are
//!   weighed together, as a mixture of sources and outliers: those are candidates whose Bayes factors beside the others are
//!   large enough. One after the other becomes a track of the bearings that it explains best; the others stay. So sources are
//!   told apart however their bearings alternate, and wherever the vehicle stops.
//! * Track deletion: a track ends when its source has been silent for longer than its own rate and its earlier pauses make
//!   likely (a cumulative sum test: Page 1954), or when it turns out to be that of another track, or when another track of a
//!   source at rest explains its bearings as well. The track of a silent source is kept while there is room, so that the
//!   source has its number when it is heard again.
//!
//! A bearing is associated when it comes, or later, when a track explains it. Those on sources at rest are looked at again
//! as more is known: one may go to another track, and what the bearings of all sources are off by at one place, as by the
//! error of a compass, is taken off.
//!
//! All sources have the scale of the errors and the bias of the array in common: each track is told what the others say of
//! them (expectation propagation: Minka 2001).

mod association;
mod config;
mod in_common;
mod review;
mod revision;
mod slot;

use super::robust::{self, Candidates, Shared};
use super::track::{Track, reading_of};
use super::{
    Advice, Alternative, Answer, Bias, Cloud, Fix, Hypothesis, Locate, Mixture, NotObservable,
    Observation, PushError, Retract, Retracted, SigmaScale, Source,
};
use crate::math::{ln, smaller};
use crate::random::Rng;
use crate::snapshot::Persist;
use crate::{ConfigError, persist};
pub use config::Config;
use in_common::Revision;
use slot::{FREE, Slot};

/// Tracks up to `K` sources, each by an `L`, and keeps up to `B` bearings that none of them explains: 96 are enough for four
/// sources that are heard from stops, beside outliers, and 64 for two or three on a drive. With as many as a track keeps,
/// both use the same code, which saves 6 kB of flash.
///
/// It takes `K` times what a track does, and 5.4 kB with `B` = 96; three robust locators of 256 particles and 64 bearings
/// make 35.2 kB. A bearing moves the particles of one track at most, or takes one search among the unassociated bearings
/// and starts those of one, and looks at 16 of the earlier bearings again if the sources are at rest: at worst it takes
/// hardly longer than with a single source.
///
/// Sources are numbered as their tracks start, from 0 on, and from 0 again after 65,536 of them, past the numbers of those
/// that are still tracked. A source that turns out to be that of another track has used a number, too.
///
/// ```
/// use foxhunt::aoa::{Bearing, Locator, MultiTarget, Observation, Robust, multi::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
///
/// let mut locator = Locator::<MultiTarget<3, Robust<256>>>::new(Config::DEFAULT)?;
/// // Driving east between two transmitters, of which every third bearing is of the second.
/// let places = [[600.0_f32, 800.0], [900.0, -500.0]];
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// for i in 0..60 {
///     let east = 25.0 * i as f32;
///     let [x, y] = places[usize::from(i % 3 == 0)];
///     let bearing = Bearing::from_radians(y.atan2(x - east) + 0.02 * normal(&mut rng));
///     locator.push(&Observation::new(1000 * i, [east, 0.0], bearing, 0.02)?, &mut rng)?;
/// }
/// for (index, place) in places.into_iter().enumerate() {
///     let source = locator.source(index).expect("both are found");
///     assert!(source.fix.ellipse(0.95).contains(place));
/// }
/// assert_eq!(locator.source(2), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MultiTarget<const K: usize, L, const B: usize = 96> {
    tracks: [L; K],
    /// Of the tracks.
    slots: [Slot; K],
    candidates: Candidates<B>,
    /// Bearings that no track explained, without those of which tracks have started since.
    outliers: f32,
    /// Of the next source, unless a source still has it.
    next_identity: u16,
    /// What is known while there is no track.
    reason: NotObservable,
    revision: Revision,
}

persist!(impl[const K: usize, L: Persist, const B: usize] MultiTarget<K, L, B> as "MultiTarget"(K, B) {
    tracks, slots, candidates, outliers, next_identity, reason, revision
});

/// Sigmas of their distance within which two sources are one: more join neighbours, fewer keep two tracks on one source.
const SAME: f32 = 2.0;

const NOTHING: NotObservable = NotObservable::TooFewBearings { have: 0 };

impl<const K: usize, L: Track, const B: usize> MultiTarget<K, L, B> {
    /// The tracks, with the identity of each source, in no particular order.
    pub fn tracks(&self) -> impl Iterator<Item = (u16, &L)> {
        let all = self.slots.iter().zip(&self.tracks);
        let live = all.filter(|(slot, _)| slot.is_live());
        live.filter_map(|(slot, track)| Some((slot.identity?, track)))
    }

    /// Starts a track, if there is a free one and a source among the unassociated bearings.
    fn initiate<R: Rng + ?Sized>(
        &mut self,
        config: &Config<L::Config>,
        beliefs: &robust::Config,
        rng: &mut R,
    ) {
        self.reason = NotObservable::NoIntersection;
        let Some(place) = self.free() else { return };
        let identity = self.unused_identity();
        let live = self.slots.iter().filter(|slot| slot.is_live());
        let explained: f32 = live.map(|slot| slot.heard / slot.of).sum();
        let Some((slot, track)) = self.slots.get_mut(place).zip(self.tracks.get_mut(place)) else {
            return;
        };
        let explained = explained.clamp(0.0, 0.9);
        for rank in 0..self.candidates.found() {
            let Some(candidate) = self.candidates.candidate(rank, beliefs) else {
                continue;
            };
            let own = candidate.readings();
            let log_factor = self.candidates.log_factor(rank);
            *slot = FREE;
            match track.initiate(&candidate, &config.track, rng) {
                Answer::Fix(_) => {
                    self.candidates.release(rank, beliefs);
                    let heard = smaller(own, self.outliers);
                    let of = self.outliers / (1.0 - explained);
                    self.outliers -= heard;
                    *slot = Slot {
                        identity: Some(identity),
                        heard,
                        of,
                        log_factor,
                        ..FREE
                    };
                    self.next_identity = identity.wrapping_add(1);
                    self.review(place, config);
                    self.delete_twin(place);
                    return;
                }
                // Particles have been moved: the expensive part runs once per bearing.
                Answer::NotObservable(
                    NotObservable::SeveralPlaces { .. } | NotObservable::WideRange { .. },
                ) => break,
                Answer::NotObservable(_) => {}
            }
        }
        if !self.slots.iter().any(Slot::is_live) {
            self.reason = self.candidates.reason(beliefs);
        }
    }

    /// The next number that no source has.
    fn unused_identity(&self) -> u16 {
        let mut identity = self.next_identity;
        // Each source is in the way once at most.
        for _ in 0..K {
            if (self.slots.iter()).any(|slot| slot.identity == Some(identity)) {
                identity = identity.wrapping_add(1);
            }
        }
        identity
    }

    /// Deletes this track or another one of the same source: that which rests on fewer bearings.
    fn delete_twin(&mut self, place: usize) {
        let Some(one) = self.fix_at(place) else {
            return;
        };
        for other in 0..K {
            if other != place
                && let Some(fix) = self.fix_at(other)
                && are_one(&one, &fix)
            {
                let less = if fix.bearings > one.bearings {
                    place
                } else {
                    other
                };
                if let Some(slot) = self.slots.get_mut(less) {
                    *slot = FREE;
                }
                return;
            }
        }
    }

    /// A free place for a track, or that of the source that has been silent for longest.
    fn free(&self) -> Option<usize> {
        let silence = |slot: &Slot| {
            if slot.identity.is_none() {
                f32::INFINITY
            } else {
                slot.silence
            }
        };
        let all = self
            .slots
            .iter()
            .enumerate()
            .filter(|(_, slot)| !slot.is_live());
        let longest = all.max_by(|(_, a), (_, b)| silence(a).total_cmp(&silence(b)));
        longest.map(|(place, _)| place)
    }

    /// What the bearings of all sources but one say of the errors that all have in common.
    fn shared(&self, but: Option<usize>) -> Shared {
        let all = self.slots.iter().zip(&self.tracks).enumerate();
        let others = all.filter(|(place, (slot, _))| slot.is_live() && but != Some(*place));
        Shared::together(others.map(|(_, (_, track))| track.shared()))
    }

    fn at(&mut self, place: Option<usize>) -> Option<(&mut Slot, &mut L)> {
        (self.slots.get_mut(place?)).zip(self.tracks.get_mut(place?))
    }

    fn fix_at(&self, place: usize) -> Option<Fix> {
        self.slots.get(place).filter(|slot| slot.is_live())?;
        self.tracks.get(place)?.fix()
    }

    /// The place of a source by its rank.
    #[inline(never)]
    fn place(&self, rank: usize) -> Option<usize> {
        let order = |place: usize| {
            let fix = self.fix_at(place)?;
            let identity = self.slots.get(place)?.identity?;
            // The more bearings the better, then the older the better.
            let age = self.next_identity.wrapping_sub(identity);
            Some(core::cmp::Reverse((fix.bearings, age)))
        };
        (0..K).find(|place| {
            order(*place).is_some_and(|one| {
                let better = |other: &usize| order(*other).is_some_and(|other| other < one);
                (0..K).filter(better).count() == rank
            })
        })
    }

    /// The track of the best known source or, if none has a fix, of the one that was heard most of late.
    #[inline(never)]
    fn best(&self) -> Option<&L> {
        if let Some(place) = self.place(0) {
            return self.tracks.get(place);
        }
        let all = self.slots.iter().zip(&self.tracks);
        let taken = all.filter(|(slot, _)| slot.is_live());
        taken
            .max_by(|(a, _), (b, _)| a.heard.total_cmp(&b.heard))
            .map(|(_, track)| track)
    }
}

impl<const K: usize, L: Track, const B: usize> Locate for MultiTarget<K, L, B> {
    type Config = Config<L::Config>;

    const ALTERNATIVES: bool = L::ALTERNATIVES;

    const EMPTY: Self = {
        assert!(
            K >= 1 && B >= 2,
            "a locator of several sources needs tracks and bearings"
        );
        Self {
            tracks: [const { L::EMPTY }; K],
            slots: [FREE; K],
            candidates: Candidates::EMPTY,
            outliers: 0.0,
            next_identity: 0,
            reason: NOTHING,
            revision: Revision::NEW,
        }
    };

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(&config.track)?;
        config.check_own()
    }

    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.push_alternatives(&[(*observation).into()], config, rng)
    }

    /// A track or the candidates may refuse a reading, before anything else changes. Takes up to four of its bearings: those
    /// after them are left out.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let beliefs = L::beliefs(&config.track);
        let reading;
        let alternatives = if L::RECLAIMS {
            reading = self.corrected(alternatives, config, &beliefs);
            reading.as_slice()
        } else {
            alternatives
        };
        let first = alternatives.first().ok_or(PushError::Empty)?.observation();
        let odds = self.odds(alternatives, config);
        let associated = self.associate(alternatives, &odds, &beliefs);
        let place = associated.map(|(place, _)| place);
        let outliers = self.outliers;
        let shared = self.shared(place);
        if let (Some((slot, track)), Some((_, alone))) = (self.at(place), associated) {
            track.assume(&shared, first)?;
            track.set_outliers_removed(outliers / (slot.heard + 1.0));
            let reading = reading_of(alternatives, |one| one.if_any(alone));
            track.push_alternatives(&reading, &config.track, rng)?;
        } else {
            let log_odds = -ln(config.false_initiation);
            (self.candidates).push(alternatives, &shared, log_odds, &beliefs, rng)?;
        }
        self.weigh(&odds, config);
        let most = -ln(config.false_deletion);
        for (other, slot) in self.slots.iter_mut().enumerate() {
            slot.count(Some(other) == place, most);
        }
        if let Some(place) = place {
            self.delete_twin(place);
        } else {
            self.outliers += 1.0;
            self.initiate(config, &beliefs, rng);
        }
        if L::RECLAIMS {
            self.reassociate(config, &beliefs);
            self.revise(config, &beliefs);
            self.give_up(config);
        }
        Ok(self.answer())
    }

    /// From all tracks, and from the bearings of none.
    fn retract<R: Rng + ?Sized>(
        &mut self,
        what: &Retract,
        config: &Self::Config,
        rng: &mut R,
    ) -> Retracted {
        let mut all = self.candidates.retract(what);
        for (slot, track) in self.slots.iter().zip(&mut self.tracks) {
            if slot.identity.is_some() {
                all = all.plus(track.retract(what, &config.track, rng));
            }
        }
        all
    }

    /// If no source has a fix, why the one that was heard most of late has none.
    fn answer(&self) -> Answer {
        match self.best() {
            Some(track) => track.answer(),
            None => Answer::NotObservable(self.reason),
        }
    }

    /// The numbers of sources go on from where they are.
    fn reset(&mut self) {
        for track in &mut self.tracks {
            track.reset();
        }
        self.slots = [FREE; K];
        self.candidates.clear();
        self.outliers = 0.0;
        self.reason = NOTHING;
        self.revision = Revision::NEW;
    }

    fn source(&self, index: usize) -> Option<Source> {
        let place = self.place(index)?;
        let slot = self.slots.get(place)?;
        Some(Source {
            identity: slot.identity?,
            probability: slot.probability(),
            ..self.tracks.get(place)?.source(0)?
        })
    }

    fn candidate(&self, index: usize) -> Option<Hypothesis> {
        self.candidates.ranked(index)
    }

    /// Of the best known source or, if none has a fix, of the one that was heard most of late; while there is none, of all
    /// bearings.
    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        match self.best() {
            Some(track) => track.hypothesis(index),
            None => self.candidates.hypotheses().nth(index),
        }
    }

    /// Of the same source as the hypotheses.
    fn bias(&self, config: &Self::Config) -> Option<Bias> {
        self.best()?.bias(&config.track)
    }

    /// Of the same source as the hypotheses.
    fn rates(&self, config: &Self::Config) -> Option<Mixture> {
        self.best()?.rates(&config.track)
    }

    /// Of the same source as the hypotheses.
    fn sigma_scale(&self, config: &Self::Config) -> Option<SigmaScale> {
        self.best()?.sigma_scale(&config.track)
    }

    /// For the same source as the hypotheses.
    fn advice(&self, config: &Self::Config) -> Option<Advice> {
        match self.best() {
            Some(track) => track.advice(&config.track),
            None => (self.candidates).advice(self.reason, &L::beliefs(&config.track)),
        }
    }

    /// By the source that explains it best.
    fn classify(&self, observation: &Observation, config: &Self::Config) -> Option<Mixture> {
        let reading = [(*observation).into()];
        let odds = self.odds(&reading, config);
        let associated = self.associate(&reading, &odds, &L::beliefs(&config.track));
        let track = associated.and_then(|(place, _)| self.tracks.get(place));
        track.or(self.best())?.classify(observation, &config.track)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.tracks.get(self.place(index)?)?.cloud(0)
    }
}

/// Whether two sources are at the same place as far as can be told.
fn are_one(a: &Fix, b: &Fix) -> bool {
    let ([ax, ay], [bx, by]) = (a.position, b.position);
    let offset = [ax - bx, ay - by];
    a.covariance.plus(&b.covariance).is_within(offset, SAME)
}

#[cfg(test)]
mod tests;
