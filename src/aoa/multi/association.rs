//! Which source a bearing is of.

use super::{Config, MultiTarget};
use crate::aoa::robust;
use crate::aoa::track::Track;
use crate::aoa::{Alternative, Observation};
use crate::math::{larger, ln, smaller};

impl<const K: usize, L: Track, const B: usize> MultiTarget<K, L, B> {
    /// The track that explains a reading best, if any does; and the probability that the reading is of no other source.
    pub(super) fn associate(
        &self,
        reading: &[Alternative],
        odds: &[f32; K],
        beliefs: &robust::Config,
    ) -> Option<(usize, f32)> {
        let (mut best, mut most) = (None, 1.0);
        let mut sum = mean(reading, |one| self.candidates.odds(one, beliefs));
        if sum > most {
            most = sum;
        }
        for (place, odds) in odds.iter().enumerate() {
            sum += odds;
            if *odds > most {
                (best, most) = (Some(place), *odds);
            }
        }
        Some((best?, 1.0 / (1.0 + (sum - most))))
    }

    /// For each track, the odds that a reading is of its source rather than an outlier.
    pub(super) fn odds(&self, reading: &[Alternative], config: &Config<L::Config>) -> [f32; K] {
        let mut all = [0.0; K];
        let tracks = self.slots.iter().zip(&self.tracks);
        for (odds, (slot, track)) in all.iter_mut().zip(tracks) {
            if slot.identity.is_some() {
                *odds = mean(reading, |one| track.odds(one, &config.track));
            }
        }
        all
    }

    /// Counts a bearing, of which these are the odds, for what it says of how many sources there are.
    pub(super) fn weigh(&mut self, odds: &[f32; K], config: &Config<L::Config>) {
        let (fits, total) = self.fits(odds, config);
        for (slot, fit) in self.slots.iter_mut().zip(fits) {
            slot.weigh(ln(total / (total - fit + slot.rate())));
        }
    }

    /// How likely a bearing is that of each source, from its odds, and how likely altogether, in what it is as an outlier
    /// if all bearings are outliers.
    #[inline(never)]
    pub(super) fn fits(&self, odds: &[f32; K], config: &Config<L::Config>) -> ([f32; K], f32) {
        /// The least part of the bearings that are of no source: less makes one outlier say more.
        const LEAST: f32 = 0.01;
        let mut fits = [0.0; K];
        let (mut others, mut total) = (1.0, 0.0);
        let tracks = self.slots.iter().zip(&self.tracks).zip(odds);
        for (fit, ((slot, track), odds)) in fits.iter_mut().zip(tracks) {
            let outlier = track.errors(&config.track).rates.outlier;
            *fit = slot.rate() * odds * outlier / (1.0 - outlier);
            others -= slot.rate();
            total += *fit;
        }
        (fits, total + larger(others, LEAST))
    }

    /// Gives one of the unassociated bearings to the track that now explains it: when the bearing came, the track did not exist
    /// yet, or knew less of its source and of the errors.
    #[inline(never)]
    pub(super) fn reassociate(&mut self, config: &Config<L::Config>, beliefs: &robust::Config) {
        let Some((index, place)) = self.explained(config, beliefs) else {
            return;
        };
        let Some(entry) = self.candidates.take(index) else {
            return;
        };
        let moved = entry.readings;
        self.outliers -= smaller(moved, self.outliers);
        if let Some((slot, track)) = self.at(Some(place)) {
            slot.heard += moved;
            track.reclaim(&entry, &config.track);
        }
    }

    /// Which of the unassociated bearings is explained best by a track, and by which.
    fn explained(
        &self,
        config: &Config<L::Config>,
        beliefs: &robust::Config,
    ) -> Option<(usize, usize)> {
        let (mut best, mut most) = (None, 1.0);
        for (index, entry) in self.candidates.entries().iter().enumerate() {
            // Of several bearings of a reading, not more than one is the source's.
            if entry.is_one_of_several() {
                continue;
            }
            let reading = [entry.observation.into()];
            let all = self.odds(&reading, config);
            if !all.iter().any(|odds| *odds > most) {
                continue;
            }
            if let Some((place, alone)) = self.associate(&reading, &all, beliefs)
                && let Some(odds) = all.get(place)
                && odds * alone > most
                && self.fix_at(place).is_some()
            {
                (best, most) = (Some((index, place)), odds * alone);
            }
        }
        best
    }
}

/// The mean of something over the bearings of a reading, by their probabilities.
fn mean(reading: &[Alternative], of: impl Fn(&Observation) -> f32) -> f32 {
    let all = reading.iter();
    all.map(|one| one.probability() * of(one.observation()))
        .sum()
}
