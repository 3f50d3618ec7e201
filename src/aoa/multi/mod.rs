//! Several sources on one channel.
//!
//! * Data association: a bearing goes to the track that explains it best, if it is likelier to be of that source, direct or
//!   mirrored, than an outlier.
//! * Track initiation: all others are kept together. Each mode of their posterior that would make a fix on its own is a
//!   candidate, weighed by a Bayes factor: one more source there against nothing but outliers. If that is large enough a
//!   track starts from the bearings that the candidate explains; the others stay. So sources are told apart however
//!   their bearings alternate.
//! * Track deletion: a track ends when its fraction of the latest bearings has faded, or when its source turns out to be that
//!   of another track.
//!
//! A bearing is associated once, when it comes. While two sources are seen in the same direction each takes some bearings of
//! the other; and each track learns the bias of the array for itself.

mod config;

use super::robust::{self, Candidates};
use super::track::Track;
use super::{
    Advice, Answer, Bias, Cloud, Fix, Hypothesis, Locate, Mixture, NotObservable, Observation,
    PushError, Retract, Retracted, SigmaScale, Source,
};
use crate::math::{exp, ln};
use crate::random::Rng;
use crate::snapshot::{Persist, value};
use crate::{ConfigError, persist};
pub use config::Config;

/// Tracks up to `K` sources, each by an `L`, and keeps up to `B` bearings that none of them explains.
///
/// It takes `K` times what a track does, and 3.3 kB with `B` = 64; three robust locators of 256 particles and 64 bearings
/// make 31.4 kB. A bearing moves the particles of one track at most, or takes one search among the unassociated bearings
/// and starts those of one: so it takes hardly longer than with a single source.
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
pub struct MultiTarget<const K: usize, L, const B: usize = 64> {
    tracks: [L; K],
    /// Of the tracks.
    slots: [Slot; K],
    candidates: Candidates<B>,
    /// Of the latest bearing, if any is recent.
    latest_ms: u32,
    /// How many bearings are recent.
    recent: f32,
    /// How many of the recent bearings no track explained.
    outliers: f32,
    /// Of the next source, unless a source still has it.
    next_identity: u16,
    /// What is known while there is no track.
    reason: NotObservable,
}

persist!(impl[const K: usize, L: Persist, const B: usize] MultiTarget<K, L, B> as "MultiTarget"(K, B) {
    tracks, slots, candidates, latest_ms, recent, outliers, next_identity, reason
});

/// What is kept of a track.
#[derive(Debug, Clone, Copy)]
struct Slot {
    /// `None` while it is free.
    identity: Option<u16>,
    /// How many of the recent bearings were of this source.
    recent: f32,
}

value!(Slot { identity, recent });

const FREE: Slot = Slot {
    identity: None,
    recent: 0.0,
};

/// Recent bearings from which on a fraction of them says anything: fewer delete new tracks in a row of outliers, more keep
/// false ones.
const ENOUGH: f32 = 8.0;

/// Sigmas of their distance within which two sources are one: more join neighbours, fewer keep two tracks on one source.
const SAME: f32 = 2.0;

const NOTHING: NotObservable = NotObservable::TooFewBearings { have: 0 };

impl<const K: usize, L: Track, const B: usize> MultiTarget<K, L, B> {
    /// The tracks, with the identity of each source, in no particular order.
    pub fn tracks(&self) -> impl Iterator<Item = (u16, &L)> {
        let all = self.slots.iter().zip(&self.tracks);
        all.filter_map(|(slot, track)| Some((slot.identity?, track)))
    }

    /// The track that explains a bearing best, if any does.
    fn associate(&self, observation: &Observation, config: &Config<L::Config>) -> Option<usize> {
        let mut best = None;
        let mut most = 1.0;
        for (place, (slot, track)) in self.slots.iter().zip(&self.tracks).enumerate() {
            if slot.identity.is_some() {
                let odds = track.odds(observation, &config.track);
                if odds > most {
                    (best, most) = (Some(place), odds);
                }
            }
        }
        best
    }

    /// Starts a track, if there is a free one and a source among the unassociated bearings.
    fn initiate<R: Rng + ?Sized>(
        &mut self,
        config: &Config<L::Config>,
        beliefs: &robust::Config,
        rng: &mut R,
    ) {
        self.reason = NotObservable::NoIntersection;
        let free = self.slots.iter().position(|slot| slot.identity.is_none());
        let Some(place) = free else { return };
        let identity = self.unused_identity();
        let Some((slot, track)) = self.slots.get_mut(place).zip(self.tracks.get_mut(place)) else {
            return;
        };
        let log_odds = -ln(config.false_initiation);
        let found = self.candidates.found(log_odds, beliefs);
        for mode in &found {
            let Some(candidate) = self.candidates.candidate(*mode, beliefs) else {
                continue;
            };
            let own = candidate.observations().count() as f32;
            match track.initiate(&candidate, &config.track, rng) {
                Answer::Fix(_) => {
                    self.candidates.release(*mode, beliefs);
                    let recent = if own < self.outliers {
                        own
                    } else {
                        self.outliers
                    };
                    self.outliers -= recent;
                    *slot = Slot {
                        identity: Some(identity),
                        recent,
                    };
                    self.next_identity = identity.wrapping_add(1);
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
        if self.slots.iter().all(|slot| slot.identity.is_none()) {
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

    /// Deletes the tracks that have less than a fraction of the recent bearings.
    fn delete_faded(&mut self, least_rate: f32) {
        let least = least_rate * self.recent;
        for slot in &mut self.slots {
            if self.recent > ENOUGH && slot.recent < least {
                *slot = FREE;
            }
        }
    }

    fn at(&mut self, place: Option<usize>) -> Option<(&mut Slot, &mut L)> {
        (self.slots.get_mut(place?)).zip(self.tracks.get_mut(place?))
    }

    fn fix_at(&self, place: usize) -> Option<Fix> {
        self.slots.get(place)?.identity?;
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
        let taken = all.filter(|(slot, _)| slot.identity.is_some());
        taken
            .max_by(|(a, _), (b, _)| a.recent.total_cmp(&b.recent))
            .map(|(_, track)| track)
    }
}

impl<const K: usize, L: Track, const B: usize> Locate for MultiTarget<K, L, B> {
    type Config = Config<L::Config>;

    const EMPTY: Self = {
        assert!(
            K >= 1 && B >= 2,
            "a locator of several sources needs tracks and bearings"
        );
        Self {
            tracks: [const { L::EMPTY }; K],
            slots: [FREE; K],
            candidates: Candidates::EMPTY,
            latest_ms: 0,
            recent: 0.0,
            outliers: 0.0,
            next_identity: 0,
            reason: NOTHING,
        }
    };

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(&config.track)?;
        config.check_own()
    }

    /// A track or the candidates may refuse a bearing, before anything else changes.
    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let beliefs = L::beliefs(&config.track);
        let elapsed_ms = if self.recent > 0.0 {
            observation.since_ms(self.latest_ms)
        } else {
            0
        };
        let seconds = elapsed_ms.max(0) as f32 / 1000.0;
        let kept = exp(-(1.0 / config.memory_bearings + seconds / config.memory_s));
        let place = self.associate(observation, config);
        let outliers = kept * self.outliers;
        if let Some((slot, track)) = self.at(place) {
            track.set_outliers_removed(outliers / (kept * slot.recent + 1.0));
            track.push(observation, &config.track, rng)?;
        } else {
            self.candidates.push(observation, &beliefs, rng)?;
        }
        if elapsed_ms >= 0 {
            self.latest_ms = observation.time_ms();
        }
        self.recent = kept * self.recent + 1.0;
        self.outliers = outliers;
        for slot in &mut self.slots {
            slot.recent *= kept;
        }
        if let Some(place) = place {
            if let Some(slot) = self.slots.get_mut(place) {
                slot.recent += 1.0;
            }
            self.delete_twin(place);
        } else {
            self.outliers += 1.0;
            self.initiate(config, &beliefs, rng);
        }
        self.delete_faded(config.least_rate);
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
        (self.recent, self.outliers) = (0.0, 0.0);
        self.reason = NOTHING;
    }

    fn source(&self, index: usize) -> Option<Source> {
        let place = self.place(index)?;
        Some(Source {
            identity: self.slots.get(place)?.identity?,
            ..self.tracks.get(place)?.source(0)?
        })
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
        let associated = self.associate(observation, config);
        let track = associated.and_then(|place| self.tracks.get(place));
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
