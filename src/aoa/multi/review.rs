//! What a new source says of those that were found before it.
//!
//! A track may start at a wrong place, by a few bearings that were taken from one side. Later bearings of its source do not
//! fit then, and start a second track, at the right place: that one explains the bearings of the first, too. The same holds
//! when bearings that came later make the first unlikely.

use super::slot::{FREE, Slot};
use super::{Config, MultiTarget};
use crate::aoa::core::Entry;
use crate::aoa::track::Track;
use crate::math::ln;

impl<const K: usize, L: Track, const B: usize> MultiTarget<K, L, B> {
    /// Weighs the bearings of all other sources again, beside the one of the track that has just been started at `new`. A
    /// track whose source is then more likely not to be there is deleted.
    #[inline(never)]
    pub(super) fn review(&mut self, new: usize, config: &Config<L::Config>) {
        for place in 0..K {
            if place == new {
                continue;
            }
            let gain = self.gain(place, new, config);
            if let Some(slot) = self.slots.get_mut(place)
                && gain < 0.0
            {
                slot.weigh(gain);
                if slot.is_unlikely() {
                    self.hand_over(place, new, config);
                }
            }
        }
    }

    /// Deletes the tracks whose sources are more likely not to be there, if another one explains half of their bearings.
    #[inline(never)]
    pub(super) fn give_up(&mut self, config: &Config<L::Config>) {
        for place in 0..K {
            let live = self.slots.get(place).filter(|slot| slot.is_live());
            if live.is_some_and(Slot::is_unlikely)
                && let Some(heir) = (0..K).find(|other| self.explains_half(*other, place, config))
            {
                self.hand_over(place, heir, config);
            }
        }
    }

    /// Whether one track explains half of the bearings of another.
    fn explains_half(&self, one: usize, other: usize, config: &Config<L::Config>) -> bool {
        let Some((heir, track)) = self.tracks.get(one).zip(self.tracks.get(other)) else {
            return false;
        };
        let (mut explained, mut all) = (0.0, 0.0);
        for entry in track.entries() {
            all += entry.readings;
            if heir.odds(&entry.observation, &config.track) > 1.0 {
                explained += entry.readings;
            }
        }
        one != other && self.fix_at(one).is_some() && explained > 0.5 * all
    }

    /// What another source adds to the logarithm of the Bayes factor of a live one, by the bearings of that.
    fn gain(&self, place: usize, other: usize, config: &Config<L::Config>) -> f32 {
        let of_entry = |entry: &Entry| {
            let odds = self.odds(&[entry.observation.into()], config);
            let (fits, total) = self.fits(&odds, config);
            let part = |place: usize| {
                let slot = self.slots.get(place)?;
                Some((fits.get(place)?, slot.rate()))
            };
            let (own, rate) = part(place)?;
            let (new, new_rate) = part(other)?;
            let before = total - new + new_rate;
            let factor = total / (total - own + rate) * (before - own + rate) / before;
            Some(entry.worth * ln(factor))
        };
        let live = self.slots.get(place).filter(|slot| slot.is_live());
        let track = live.and_then(|_| self.tracks.get(place));
        let entries = track.map_or(&[][..], L::entries);
        // Of several bearings of a reading, not more than one is the source's.
        let single = entries.iter().filter(|entry| !entry.is_one_of_several());
        single.filter_map(of_entry).sum()
    }

    /// Deletes a track. Its heir takes the bearings that it explains.
    fn hand_over(&mut self, place: usize, heir: usize, config: &Config<L::Config>) {
        let slots = self.slots.get_disjoint_mut([place, heir]);
        let tracks = self.tracks.get_disjoint_mut([place, heir]);
        let (Ok([slot, heir_slot]), Ok([track, heir])) = (slots, tracks) else {
            return;
        };
        for entry in track.entries() {
            if !entry.is_one_of_several() && heir.odds(&entry.observation, &config.track) > 1.0 {
                heir_slot.heard += entry.readings;
                heir.inherit(entry, &config.track);
            }
        }
        *slot = FREE;
    }
}
