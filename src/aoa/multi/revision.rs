//! What earlier bearings say in the light of later ones.
//!
//! With each bearing that comes, some of the earlier ones are looked at again, in turn:
//!
//! * One that another source explains better goes to the track of that. For the others, the probability is renewed that
//!   they are of no other source. Over many bearings this is expectation maximisation (Dempster, Laird and Rubin 1977).
//! * What the bearings of several sources are off by at one place, as by the error of a compass there, is taken off: each is
//!   corrected by what those of the *other* sources say of that error, as a Kalman filter would do it, with the variance
//!   that is left. How large such errors are is learned from the products of what two sources' bearings are off by at one
//!   place, which are zero in the mean if there are none.

use super::in_common::AtPlace;
use super::{Config, MultiTarget};
use crate::aoa::core::{Entry, square_of_distance};
use crate::aoa::robust;
use crate::aoa::track::{Reading, Track, reading_of};
use crate::aoa::words::Correction;
use crate::aoa::{Alternative, Observation};
use crate::math::larger;

/// Entries that are looked at again with each bearing: more keep all up to date, and cost time.
const AT_ONCE: u32 = 16;
/// How many times as likely a bearing has to be another source's to go to its track: less moves bearings to and fro.
const CLEARLY: f32 = 1.5;
/// How much a probability has to change, and a correction in stated sigmas, until particles move for it: less moves them
/// more often, more leaves errors.
const PROBABILITY: f32 = 0.1;
const SIGMAS: f32 = 0.2;

impl<const K: usize, L: Track, const B: usize> MultiTarget<K, L, B> {
    /// A reading corrected by what is known of the error of its place.
    #[inline(never)]
    pub(super) fn corrected(
        &self,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
        beliefs: &robust::Config,
    ) -> Reading {
        let variance = self.revision.variance;
        let Some(first) = alternatives.first().filter(|_| variance > 0.0) else {
            return reading_of(alternatives, |one| *one);
        };
        let at_place = self.at_place(first.observation(), config, beliefs);
        reading_of(alternatives, |one| {
            let entry = Entry::from(one);
            let by_stated = |track: &L| track.off_by(&entry, &config.track).by_stated;
            let by_stated = self.best().map_or(1.0, by_stated);
            one.corrected(&at_place.correction(None, variance, by_stated))
        })
    }

    /// Looks at some of the earlier bearings again.
    #[inline(never)]
    pub(super) fn revise(&mut self, config: &Config<L::Config>, beliefs: &robust::Config) {
        for _ in 0..AT_ONCE {
            let Some(at) = self.next_entry() else {
                self.revision.begin_again();
                return;
            };
            if !self.reassign(at, config, beliefs) {
                self.correct(at, config, beliefs);
            }
        }
    }

    /// The entries of a track that has a fix; after those of all tracks, the unassociated ones.
    fn entries_at(&self, place: usize) -> &[Entry] {
        if place == K {
            return self.candidates.entries();
        }
        match (self.fix_at(place), self.tracks.get(place)) {
            (Some(_), Some(track)) => track.entries(),
            _ => &[],
        }
    }

    /// Where the next entry is; `None` after the last one.
    fn next_entry(&mut self) -> Option<[usize; 2]> {
        loop {
            let [place, index] = [self.revision.place, self.revision.index].map(usize::from);
            if place > K {
                return None;
            }
            if index < self.entries_at(place).len() {
                self.revision.index += 1;
                return Some([place, index]);
            }
            self.revision.place += 1;
            self.revision.index = 0;
        }
    }

    /// Gives a bearing to the track that explains it better, or says how likely it is of no other source. Whether it was
    /// given away.
    fn reassign(
        &mut self,
        [place, index]: [usize; 2],
        config: &Config<L::Config>,
        beliefs: &robust::Config,
    ) -> bool {
        let entries = self.entries_at(place);
        let Some(entry) = entries.get(index).copied().filter(|_| place < K) else {
            return false;
        };
        // Of several bearings of a reading, not more than one is the source's.
        let is_of_reading =
            |one: &&Entry| one.position() == entry.position() && one.holds(&entry.observation);
        if entries.iter().filter(is_of_reading).count() > 1 {
            return false;
        }
        let odds = self.odds(&[entry.observation.into()], config);
        let (mut other, mut most, mut own) = (None, 1.0, 0.0);
        let mut sum = self.candidates.odds(&entry.observation, beliefs);
        for (at, odds) in odds.into_iter().enumerate() {
            if at == place {
                own = odds;
                continue;
            }
            sum += odds;
            if odds > most && self.fix_at(at).is_some() {
                (other, most) = (Some(at), odds);
            }
        }
        match other {
            Some(other) if most > CLEARLY * own => {
                let probability = 1.0 / (1.0 + sum - most + own);
                self.move_entry([place, index], other, probability, config);
                true
            }
            _ => {
                let probability = 1.0 / (1.0 + sum);
                if (probability - entry.probability).abs() > PROBABILITY
                    && let Some(entry) = self
                        .tracks
                        .get_mut(place)
                        .and_then(|track| track.entry_mut(index))
                {
                    entry.probability = probability;
                }
                false
            }
        }
    }

    fn move_entry(
        &mut self,
        [place, index]: [usize; 2],
        other: usize,
        probability: f32,
        config: &Config<L::Config>,
    ) {
        let Some((slot, track)) = self.at(Some(place)) else {
            return;
        };
        let Some(entry) = track.take(index) else {
            return;
        };
        slot.heard = larger(slot.heard - entry.readings, 0.0);
        if let Some((slot, track)) = self.at(Some(other)) {
            slot.heard += entry.readings;
            track.reclaim(
                &Entry {
                    probability,
                    ..entry
                },
                &config.track,
            );
        }
    }

    /// Corrects an entry by what the bearings of other sources at its place say.
    fn correct(&mut self, at: [usize; 2], config: &Config<L::Config>, beliefs: &robust::Config) {
        let [place, index] = at;
        let entry = self.entries_at(place).get(index).copied();
        let Some(entry) = entry.filter(Entry::is_of_one_place) else {
            return;
        };
        let at_place = self.at_place(&entry.observation, config, beliefs);
        if at_place.first == Some(at) {
            let [products, pairs] = at_place.products();
            self.revision.products += products;
            self.revision.pairs += pairs;
        }
        let own = match self.tracks.get(place) {
            Some(track) => Some((place, track.off_by(&entry, &config.track))),
            None => (self.candidates.explained(&entry, beliefs))
                .map(|(rank, off_by)| (K + rank, off_by)),
        };
        let by_stated = own.map_or(1.0, |(_, off_by)| off_by.by_stated);
        let own = own.map(|(source, _)| source);
        let next = at_place.correction(own, self.revision.variance, by_stated);
        if is_worth_a_move(&entry, &next) {
            let entry = match self.tracks.get_mut(place) {
                Some(track) => track.entry_mut(index),
                None => self.candidates.entry_mut(index),
            };
            if let Some(entry) = entry {
                entry.correct(&next);
            }
        }
    }

    /// What all bearings of one station and place say of their errors.
    #[inline(never)]
    fn at_place(
        &self,
        at: &Observation,
        config: &Config<L::Config>,
        beliefs: &robust::Config,
    ) -> AtPlace<K> {
        let mut all = AtPlace::NOTHING;
        let is_of_it = |entry: &Entry, square: f32| {
            entry.is_of_one_place()
                && entry.observation.station() == at.station()
                && square_of_distance(entry.position(), at.position()) < square
        };
        for (place, sum) in all.of_tracks.iter_mut().enumerate() {
            let Some((fix, track)) = self.fix_at(place).zip(self.tracks.get(place)) else {
                continue;
            };
            let square = beliefs.errors.square_of_place(at.position(), fix.position);
            for (index, entry) in track.entries().iter().enumerate() {
                if is_of_it(entry, square) {
                    all.first = all.first.or(Some([place, index]));
                    sum.add(&track.off_by(entry, &config.track));
                }
            }
        }
        let Some(source) = self.candidates.source() else {
            return all;
        };
        let square = beliefs.errors.square_of_place(at.position(), source);
        for (index, entry) in self.candidates.entries().iter().enumerate() {
            if is_of_it(entry, square)
                && let Some((rank, off_by)) = self.candidates.explained(entry, beliefs)
                && let Some(sum) = all.of_modes.get_mut(rank)
            {
                all.first = all.first.or(Some([K, index]));
                sum.add(&off_by);
            }
        }
        all
    }
}

/// Whether an entry is to be corrected by something else than before.
fn is_worth_a_move(entry: &Entry, next: &Correction) -> bool {
    let before = entry.correction;
    let stated = before.stated_variance(&entry.observation);
    let turn = next.offset - before.offset;
    turn * turn > SIGMAS * SIGMAS * stated
        || (next.variance - before.variance).abs() > SIGMAS * stated
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_changes_wait() {
        use crate::aoa::Bearing;
        let bearing = Observation::new(0, [0.0; 2], Bearing::from_radians(1.0), 0.1).unwrap();
        let entry = Entry::new(bearing, 1.0);
        for (offset, variance, moves) in [
            (0.019, 0.0, false),
            (-0.019, 0.0019, false),
            (0.021, 0.0, true),
            (-0.021, 0.0, true),
            (0.0, 0.0021, true),
        ] {
            assert_eq!(
                is_worth_a_move(&entry, &Correction { offset, variance }),
                moves
            );
        }
    }
}
