//! What locators of several and of manoeuvring sources need of the locator that they build on.

use heapless::Vec;

use super::core::Entry;
use super::robust::outside::read;
use super::robust::{self, Candidate, Errors, Learned, Shared};
use super::{Alternative, Answer, Locate, Observation, PushError};
use crate::random::Rng;

/// A locator of one source that others can build on: it starts from some of the bearings of a channel, and says which of the
/// next are its source's.
pub trait Track: Locate {
    /// What is believed of bearings before any: candidates for new tracks are found by it.
    fn beliefs(config: &Self::Config) -> robust::Config;

    /// The errors of bearings, as learned so far.
    fn errors(&self, config: &Self::Config) -> Errors;

    /// The latest bearing by time, whether it was pushed, recalled or came with the candidate.
    fn latest(&self) -> Option<&Observation>;

    /// Forgets everything, and starts from the bearings of a candidate. The source is found if that makes a fix.
    fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Self::Config,
        rng: &mut R,
    ) -> Answer;

    /// Odds that a bearing is this source's, direct or mirrored, rather than an outlier, if it is the next one. Meaningful
    /// for tracks that have had a fix.
    fn odds(&self, observation: &Observation, config: &Self::Config) -> f32;

    /// The bearings of a source at rest as they are kept; none of a source that may move, whose place was another one then.
    fn entries(&self) -> &[Entry] {
        &[]
    }

    /// One of them, to be changed: particles move with the next bearing.
    fn entry_mut(&mut self, _index: usize) -> Option<&mut Entry> {
        None
    }

    /// Gives one of them away: particles move with the next bearing.
    fn take(&mut self, _index: usize) -> Option<Entry> {
        None
    }

    /// How far off a bearing is, if it is this source's.
    fn off_by(&self, _entry: &Entry, _config: &Self::Config) -> OffBy {
        OffBy::NOTHING
    }

    /// What the bearings of this source say of the errors that all sources have in common.
    fn shared(&self) -> Shared {
        Shared::NOTHING
    }

    /// States what those of others say of them, for the next bearing.
    ///
    /// # Errors
    /// If that bearing would be refused: then nothing changes.
    fn assume(&mut self, _others: &Shared, _next: &Observation) -> Result<(), PushError> {
        Ok(())
    }

    /// Whether it takes bearings that came earlier.
    const RECLAIMS: bool = false;

    /// Takes a bearing of this source that came earlier, and was not known to be one: for tracks that have a fix.
    fn reclaim(&mut self, _earlier: &Entry, _config: &Self::Config) {}

    /// Takes a bearing of a track that was deleted because this source explains it, too, as long as there is
    /// room: particles move with the next one.
    fn inherit(&mut self, _earlier: &Entry, _config: &Self::Config) {}

    /// States how many outliers were removed upstream for each bearing that the track gets: they count for its rates, if it
    /// learns any. To be stated before each push.
    fn set_outliers_removed(&mut self, _per_bearing: f32) {}
}

/// A locator of a stationary source that a locator of a manoeuvring one builds on.
pub trait Stationary: Track {
    /// Mean and covariance of position (metres) and bias (prior sigmas).
    fn moments(&self) -> ([f32; 3], [[f32; 3]; 3]);

    /// What bearings have taught of their errors.
    fn learned(&self) -> Learned {
        Learned::NOTHING
    }

    /// Forgets all bearings, and goes on with what was learned of their errors.
    fn restart(&mut self, learned: &Learned);

    /// Makes the source as likely within `range_m` of `centre` as farther away, whatever the bearings say. The first
    /// bearing centres the prior on where it was taken, so this comes later. A flat prior stays flat.
    fn centre_prior(&mut self, _centre: [f32; 2], _range_m: f32) {}

    /// Takes an earlier bearing without moving particles: the next push does.
    fn recall(&mut self, observation: &Observation, config: &Self::Config);
}

/// The bearings of a reading.
pub(in crate::aoa) type Reading = Vec<Alternative, ALTERNATIVES>;

/// The most bearings of a reading that are taken: one more than a spectrum has peaks.
const ALTERNATIVES: usize = 4;

/// A reading of which every bearing is changed.
pub(in crate::aoa) fn reading_of(
    alternatives: &[Alternative],
    change: impl Fn(&Alternative) -> Alternative,
) -> Reading {
    let mut reading = Reading::new();
    for one in alternatives {
        let _ = reading.push(change(one));
    }
    reading
}

/// How far off a bearing is of a source.
#[derive(Clone, Copy)]
pub struct OffBy {
    /// Measured less expected, before any correction, in radians.
    pub(in crate::aoa) error: f32,
    /// Its variance, of what the bearing has on its own and of the place of the source.
    pub(in crate::aoa) variance: f32,
    /// What a square radian of stated variance adds to that.
    pub(in crate::aoa) by_stated: f32,
    /// The probability that the bearing is the source's rather than an outlier.
    pub(in crate::aoa) probability: f32,
}

impl OffBy {
    const NOTHING: Self = Self {
        error: 0.0,
        variance: 1.0,
        by_stated: 1.0,
        probability: 0.0,
    };
}

/// By the normal distribution of position and bias with the moments of the particles.
#[inline(never)]
pub(in crate::aoa) fn off_by_moments(
    entry: &Entry,
    errors: &Errors,
    (mean, covariance): &([f32; 3], [[f32; 3]; 3]),
) -> OffBy {
    let line = read(&entry.observation, errors, mean);
    let all = line.variance_with(covariance);
    let odds = entry.probability * line.odds(line.error, all, errors);
    let scale = errors.sigma_scale * errors.sigma_scale;
    let by_stated = scale * errors.own_variance(entry) * entry.observation.information();
    let stated = entry.correction.stated_variance(&entry.observation);
    OffBy {
        error: entry.correction.offset - line.error,
        variance: by_stated * stated + (all - line.variance),
        by_stated,
        probability: odds / (1.0 + odds),
    }
}

/// The odds of [`Track::odds`] by the normal distribution of position and bias with the moments of the particles.
pub(in crate::aoa) fn odds_by_moments(
    observation: &Observation,
    errors: &Errors,
    (mean, covariance): &([f32; 3], [[f32; 3]; 3]),
) -> f32 {
    let line = read(observation, errors, mean);
    line.odds(line.error, line.variance_with(covariance), errors)
}
