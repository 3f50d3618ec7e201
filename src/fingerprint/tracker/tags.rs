//! Many tags on one gateway.

use super::Tracker;
use crate::persist;

/// Trackers for up to `T` tags at once: T times a [`Tracker`] and 12 bytes.
///
/// A tag that comes when all are taken gets the tracker of the tag that was silent for longest.
///
/// ```
/// use foxhunt::fingerprint::tracker::Trackers;
///
/// let mut trackers = Trackers::<2, 100>::EMPTY;
/// assert_eq!(trackers.of(1, 10).1, None);
/// assert_eq!(trackers.of(2, 20).1, None);
/// trackers.of(1, 30);
/// assert_eq!(trackers.of(3, 40).1, Some(2));
/// assert!(trackers.iter().all(|(tag, _)| tag != 2));
/// ```
#[derive(Debug, Clone)]
pub struct Trackers<const T: usize, const N: usize, const B: usize = 16, const D: usize = 2> {
    slots: [Slot<N, B, D>; T],
}

#[derive(Debug, Clone)]
struct Slot<const N: usize, const B: usize, const D: usize> {
    /// Whose it is, and when that was heard last.
    owner: Option<(u32, u32)>,
    tracker: Tracker<N, B, D>,
}

impl<const T: usize, const N: usize, const B: usize, const D: usize> Trackers<T, N, B, D> {
    /// No tags yet, in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(T > 0, "at least one tag");
        Self {
            slots: [const {
                Slot {
                    owner: None,
                    tracker: Tracker::EMPTY,
                }
            }; T],
        }
    };

    /// The tracker of a tag that was heard at a time in milliseconds, and the tag that lost it, if one did.
    pub fn of(&mut self, tag: u32, time_ms: u32) -> (&mut Tracker<N, B, D>, Option<u32>) {
        let place = self.place_of(tag, time_ms);
        let place = if place < T { place } else { 0 };
        let Slot { owner, tracker } = &mut self.slots[place];
        let before = owner.map(|(tag, _)| tag);
        *owner = Some((tag, time_ms));
        if before == Some(tag) {
            (tracker, None)
        } else {
            tracker.reset();
            (tracker, before)
        }
    }

    /// The slot of a tag: its own, a free one, or that of the tag that was silent for longest.
    fn place_of(&self, tag: u32, time_ms: u32) -> usize {
        let mut silent = (0, 0);
        let mut free = None;
        for (place, slot) in self.slots.iter().enumerate() {
            match slot.owner {
                Some((owner, _)) if owner == tag => return place,
                Some((_, heard_ms)) => {
                    // Clocks overflow; a time ahead is no silence.
                    let silence = (time_ms.wrapping_sub(heard_ms) as i32).max(0);
                    if silence >= silent.1 {
                        silent = (place, silence);
                    }
                }
                None if free.is_none() => free = Some(place),
                None => {}
            }
        }
        free.unwrap_or(silent.0)
    }

    /// Forgets all tags.
    pub fn clear(&mut self) {
        for slot in &mut self.slots {
            slot.owner = None;
        }
    }

    /// All tags that are tracked, and their trackers.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Tracker<N, B, D>)> {
        self.slots
            .iter()
            .filter_map(|slot| slot.owner.map(|(tag, _)| (tag, &slot.tracker)))
    }

    /// All tags that are tracked, and their trackers.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (u32, &mut Tracker<N, B, D>)> {
        let slots = self.slots.iter_mut();
        slots.filter_map(|slot| slot.owner.map(|(tag, _)| (tag, &mut slot.tracker)))
    }
}

persist!(impl[const N: usize, const B: usize, const D: usize] Slot<N, B, D> as "Slot"(N, B) { owner, tracker });
persist!(impl[const T: usize, const N: usize, const B: usize, const D: usize] Trackers<T, N, B, D> as "Trackers"(T) { slots });
