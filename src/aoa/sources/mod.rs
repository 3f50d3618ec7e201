//! Several sources on one channel.
//!
//! * A bearing goes to the source that explains it best, if it is likelier to be of that source, direct or mirrored,
//!   than wild.
//! * All others are kept together. Each mode of their posterior that would make a fix on its own is weighed by a Bayes
//!   factor: one more source there against nothing but wild bearings. If that is large enough a source is born, from
//!   the bearings that it explains; the others stay. So sources are told apart however their bearings alternate.
//! * A source dies when its share of the recent bearings has faded, or when it turns out to be another's twin.
//!
//! Which source a bearing is of is decided once, when it comes. While two are seen in the same direction each takes some
//! of the other's bearings; and each learns the bias of the array for itself.

mod settings;
mod snapshot;
mod track;

use super::Observation;
use super::advice::Advice;
use super::locate::elapsed;
use super::locator::{Answer, Fix, NotObservable};
use super::robust::{Bias, Hypothesis, Nursery, Shares};
use super::{Cloud, Locate, Source};
use crate::math::exp;
use crate::random::Rng;
pub use settings::{Settings, SettingsError};
pub use track::Track;

/// Tracks up to `K` sources, each by a `T`, and keeps up to `B` bearings that none of them explains.
///
/// It takes `K` times what a track does, and 4.3 kB with `B` = 64; three robust locators of 256 particles and 64 bearings
/// make 32.4 kB. A bearing moves the particles of one source at most, or takes one search among the unexplained
/// bearings and starts those of one: so it takes hardly longer than with a single source.
///
/// Sources are numbered as they are born, from 0 on, and from 0 again after 65,536 of them, past the numbers of those
/// that are still tracked. One that turns out to be another's twin has spent a number, too.
///
/// ```
/// use foxhunt::aoa::{Bearing, Locate, Observation};
/// use foxhunt::aoa::robust::{self, Errors, RobustLocator};
/// use foxhunt::aoa::sources::{Settings, Sources};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// type Track = RobustLocator<256, 64>;
/// const TRACK: Track = Track::new(robust::Settings::new(Errors::new()));
/// let mut sources = Sources::<3, Track>::new(Settings::new(), [TRACK; 3]);
///
/// // Driving east between two transmitters, of which every third bearing is of the second.
/// let places = [[600.0_f32, 800.0], [900.0, -500.0]];
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// for i in 0..60 {
///     let east = 25.0 * i as f32;
///     let [x, y] = places[usize::from(i % 3 == 0)];
///     let bearing = Bearing::from_radians(y.atan2(x - east));
///     let observation = Observation::new([east, 0.0], bearing, 0.02).unwrap();
///     sources.push_after(observation, 1.0, &mut rng);
/// }
/// for (index, place) in places.into_iter().enumerate() {
///     let source = sources.source(index).unwrap();
///     assert!(source.fix.ellipse(0.95).contains(place));
/// }
/// assert_eq!(sources.source(2), None);
/// ```
#[derive(Debug, Clone)]
pub struct Sources<const K: usize, T, const B: usize = 64> {
    settings: Settings,
    tracks: [T; K],
    /// Of the tracks.
    slots: [Slot; K],
    nursery: Nursery<B>,
    /// Seconds since the nursery's last bearing.
    silence_s: f32,
    /// How many bearings are recent.
    recent: f32,
    /// How many of the recent bearings no source explained.
    wild: f32,
    /// Of the next source, unless a source still has it.
    next_identity: u16,
    /// What is known while there is no source.
    reason: NotObservable,
}

/// What is kept of a track.
#[derive(Debug, Clone, Copy)]
struct Slot {
    /// `None` while it is free.
    identity: Option<u16>,
    /// How many of the recent bearings were of this source.
    recent: f32,
    /// Seconds since the last of them.
    silence_s: f32,
}

const FREE: Slot = Slot {
    identity: None,
    recent: 0.0,
    silence_s: 0.0,
};

/// Before so many bearings are recent a share of them says nothing.
const FEW: f32 = 8.0;

/// Squared deviations of their difference within which two sources are one.
const SAME: f32 = 4.0;

const NOTHING: NotObservable = NotObservable::TooFewBearings { have: 0 };

impl<const K: usize, T: Track, const B: usize> Sources<K, T, B> {
    /// No sources yet; `tracks` are to follow them, all fresh and with the same settings.
    pub const fn new(settings: Settings, tracks: [T; K]) -> Self {
        const { assert!(K >= 1 && B >= 2, "sources need tracks and bearings") };
        Self {
            settings,
            tracks,
            slots: [FREE; K],
            nursery: Nursery::new(),
            silence_s: 0.0,
            recent: 0.0,
            wild: 0.0,
            next_identity: 0,
            reason: NOTHING,
        }
    }

    /// Takes one bearing, and says what is known of the best known source with it.
    pub fn push<R: Rng + ?Sized>(&mut self, observation: Observation, rng: &mut R) -> Answer {
        self.push_after(observation, 0.0, rng)
    }

    /// The tracks of sources, with the identity of each, in no particular order.
    pub fn tracks(&self) -> impl Iterator<Item = (u16, &T)> {
        let all = self.slots.iter().zip(&self.tracks);
        all.filter_map(|(slot, track)| Some((slot.identity?, track)))
    }

    /// The track that explains a bearing best, if any does.
    fn explain(&self, observation: &Observation) -> Option<usize> {
        let mut best = None;
        let mut most = 1.0;
        for (place, (slot, track)) in self.slots.iter().zip(&self.tracks).enumerate() {
            if slot.identity.is_some() {
                let odds = track.odds(observation, slot.silence_s);
                if odds > most {
                    (best, most) = (Some(place), odds);
                }
            }
        }
        best
    }

    /// Looks for a source in the nursery.
    fn bear<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        self.reason = NotObservable::NoIntersection;
        let free = self.slots.iter().position(|slot| slot.identity.is_none());
        let Some(place) = free else { return };
        let identity = self.unused_identity();
        let Some((slot, track)) = self.slots.get_mut(place).zip(self.tracks.get_mut(place)) else {
            return;
        };
        let settings = *track.settings();
        for rank in 0..Nursery::<B>::MODES {
            let Some(seed) = self
                .nursery
                .candidate(rank, self.settings.log_odds, &settings)
            else {
                continue;
            };
            let own = seed.observations().count() as f32;
            match track.plant(&seed, rng) {
                Answer::Fix(_) => {
                    self.nursery.release(rank, &settings);
                    let recent = if own < self.wild { own } else { self.wild };
                    self.wild -= recent;
                    *slot = Slot {
                        identity: Some(identity),
                        recent,
                        silence_s: 0.0,
                    };
                    self.next_identity = identity.wrapping_add(1);
                    self.part(place);
                    return;
                }
                // Particles have been moved.
                Answer::NotObservable(NotObservable::NoIntersection) => break,
                Answer::NotObservable(_) => {}
            }
        }
        if self.slots.iter().all(|slot| slot.identity.is_none()) {
            self.reason = self.nursery.reason(&settings);
        }
    }

    /// The next number that no source has.
    fn unused_identity(&self) -> u16 {
        let mut identity = self.next_identity;
        // Each source is in the way once at most.
        for _ in 0..K {
            if self
                .slots
                .iter()
                .any(|slot| slot.identity == Some(identity))
            {
                identity = identity.wrapping_add(1);
            }
        }
        identity
    }

    /// Frees the slot of a source that is the same as this one, or this one's.
    fn part(&mut self, place: usize) {
        let Some(one) = self.fix(place) else { return };
        for other in 0..K {
            if other != place
                && let Some(fix) = self.fix(other)
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

    /// Frees the slots of sources that have faded.
    fn bury(&mut self) {
        let least = self.settings.least_share * self.recent;
        for slot in &mut self.slots {
            if self.recent > FEW && slot.recent < least {
                *slot = FREE;
            }
        }
    }

    fn fix(&self, place: usize) -> Option<Fix> {
        self.slots.get(place)?.identity?;
        match self.tracks.get(place)?.answer() {
            Answer::Fix(fix) => Some(fix),
            Answer::NotObservable(_) => None,
        }
    }

    /// The place of a source by its rank.
    fn place(&self, rank: usize) -> Option<usize> {
        let order = |place: usize| {
            let fix = self.fix(place)?;
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
    fn best(&self) -> Option<&T> {
        match self.place(0) {
            Some(place) => self.tracks.get(place),
            None => self.most_heard(),
        }
    }

    fn most_heard(&self) -> Option<&T> {
        let all = self.slots.iter().zip(&self.tracks);
        let taken = all.filter(|(slot, _)| slot.identity.is_some());
        taken
            .max_by(|(a, _), (b, _)| a.recent.total_cmp(&b.recent))
            .map(|(_, track)| track)
    }
}

impl<const K: usize, T: Track, const B: usize> Locate for Sources<K, T, B> {
    fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        let seconds = elapsed(seconds);
        let Settings {
            bearings: count,
            seconds: time,
            ..
        } = self.settings;
        let kept = exp(-(1.0 / count + seconds / time));
        self.recent = kept * self.recent + 1.0;
        self.wild *= kept;
        self.silence_s += seconds;
        for slot in &mut self.slots {
            slot.recent *= kept;
            slot.silence_s += seconds;
        }
        if let Some(place) = self.explain(&observation)
            && let Some((slot, track)) = self.slots.get_mut(place).zip(self.tracks.get_mut(place))
        {
            slot.recent += 1.0;
            track.withhold(self.wild / slot.recent);
            track.push_after(observation, slot.silence_s, rng);
            slot.silence_s = 0.0;
            self.part(place);
        } else if let Some(track) = self.tracks.first() {
            let settings = *track.settings();
            self.nursery
                .push(observation, self.silence_s, &settings, rng);
            self.silence_s = 0.0;
            self.wild += 1.0;
            self.bear(rng);
        }
        self.bury();
        self.answer()
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
        self.nursery.clear();
        (self.silence_s, self.recent, self.wild) = (0.0, 0.0, 0.0);
        self.reason = NOTHING;
    }

    fn source(&self, index: usize) -> Option<Source> {
        let place = self.place(index)?;
        Some(Source {
            identity: self.slots.get(place)?.identity?,
            fix: self.fix(place)?,
            motion: self.tracks.get(place)?.source(0)?.motion,
        })
    }

    /// Of the best known source or, if none has a fix, of the one that was heard most of late; while there is none, of all
    /// bearings.
    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        match self.best() {
            Some(track) => track.hypothesis(index),
            None => self.nursery.hypotheses().nth(index),
        }
    }

    /// Of the same source as the hypotheses.
    fn bias(&self) -> Option<Bias> {
        self.best()?.bias()
    }

    /// Of the same source as the hypotheses.
    fn shares(&self) -> Option<Shares> {
        self.best()?.shares()
    }

    /// For the same source as the hypotheses.
    fn advice(&self) -> Option<Advice> {
        match self.best() {
            Some(track) => track.advice(),
            None => {
                let settings = self.tracks.first()?.settings();
                self.nursery.advice(self.reason, settings)
            }
        }
    }

    /// By the source that explains it best.
    fn classify(&self, observation: &Observation) -> Option<Shares> {
        let explained = self.explain(observation);
        let track = explained.and_then(|place| self.tracks.get(place));
        track.or(self.best())?.classify(observation)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.tracks.get(self.place(index)?)?.cloud(0)
    }
}

/// Whether two sources are at the same place as far as can be told.
fn are_one(a: &Fix, b: &Fix) -> bool {
    let [[axx, axy], [_, ayy]] = a.covariance;
    let [[bxx, bxy], [_, byy]] = b.covariance;
    let (xx, xy, yy) = (axx + bxx, axy + bxy, ayy + byy);
    let (dx, dy) = (a.position[0] - b.position[0], a.position[1] - b.position[1]);
    let determinant = xx * yy - xy * xy;
    dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx < SAME * determinant
}

#[cfg(test)]
mod tests;
