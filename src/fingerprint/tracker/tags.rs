//! Many tags on one gateway.

use super::present::Present;
use super::{Packed, Stored, Tracker};
use crate::persist;

/// Trackers for up to `T` tags at once: T times a [`Tracker`] and 12 bytes, and 12 bytes more. In a
/// [`Building`](super::Building), `S` is that of a [`BuildingTracker`](super::BuildingTracker).
///
/// A tag that comes when all are taken gets the tracker of the tag that was silent for longest, if that was silent for
/// [`Trackers::ABSENT_MS`]; otherwise there is none for it: were one taken from a tag that is heard, one tag too many would
/// cost all tags their trackers, one after the other.
///
/// Silence counts from when a packet of the tag came, by the time that the packets of all tags agree on. What time the
/// packet of a tag states makes it neither present nor absent: a packet from the future keeps no tracker, a late one
/// loses none, and one of a new tag takes none.
///
/// ```
/// use foxhunt::fingerprint::tracker::Trackers;
///
/// let mut trackers = Trackers::<2, 100>::EMPTY;
/// assert_eq!(trackers.of(1, 10).unwrap().1, None);
/// assert_eq!(trackers.of(2, 20).unwrap().1, None);
/// // A third one has to wait until one of them is gone.
/// assert!(trackers.of(3, 40).is_none());
/// for time_ms in (100..60_000).step_by(500) {
///     trackers.of(1, time_ms);
/// }
/// assert_eq!(trackers.of(3, 60_000).unwrap().1, Some(2));
/// assert!(trackers.iter().all(|(tag, _)| tag != 2));
/// ```
#[derive(Debug, Clone)]
pub struct Trackers<
    const T: usize,
    const N: usize,
    const B: usize = 16,
    const D: usize = 2,
    S: Stored = Packed<D>,
> {
    slots: [Slot<N, B, D, S>; T],
    present: Present,
}

#[derive(Debug, Clone)]
struct Slot<const N: usize, const B: usize, const D: usize, S: Stored> {
    /// Whose it is, and when that was heard last.
    owner: Option<(u32, u32)>,
    tracker: Tracker<N, B, D, S>,
}

impl<const T: usize, const N: usize, const B: usize, const D: usize, S: Stored>
    Trackers<T, N, B, D, S>
{
    /// A tag that was silent for so many milliseconds gives its tracker to another. Less would take those of people behind
    /// a steel door; more lets newcomers wait.
    pub const ABSENT_MS: u32 = 30_000;

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
            present: Present::EMPTY,
        }
    };

    /// The tracker of a tag of which a packet came that states a time in milliseconds, and the tag that lost it, if one did;
    /// none if all are taken by tags that are still heard.
    pub fn of(
        &mut self,
        tag: u32,
        time_ms: u32,
    ) -> Option<(&mut Tracker<N, B, D, S>, Option<u32>)> {
        let now_ms = self.present.hear(time_ms);
        let place = self.place_of(tag, now_ms)?;
        let Slot { owner, tracker } = self.slots.get_mut(place)?;
        let before = owner.map(|(tag, _)| tag);
        *owner = Some((tag, now_ms));
        if before == Some(tag) {
            return Some((tracker, None));
        }
        tracker.reset();
        Some((tracker, before))
    }

    /// The slot of a tag: its own, a free one, or that of the tag that was silent for longest, if for long enough.
    fn place_of(&self, tag: u32, now_ms: u32) -> Option<usize> {
        let mut silent = (None, Self::ABSENT_MS);
        let mut free = None;
        for (place, slot) in self.slots.iter().enumerate() {
            match slot.owner {
                Some((owner, _)) if owner == tag => return Some(place),
                Some((_, heard_ms)) => {
                    // Clocks overflow. After one was set back, nobody has been silent.
                    let silence = now_ms.wrapping_sub(heard_ms) as i32;
                    let silence = u32::try_from(silence).unwrap_or(0);
                    if silence >= silent.1 {
                        silent = (Some(place), silence);
                    }
                }
                None if free.is_none() => free = Some(place),
                None => {}
            }
        }
        free.or(silent.0)
    }

    /// The time in milliseconds that the packets agree on.
    pub fn now_ms(&self) -> u32 {
        self.present.now_ms()
    }

    /// Forgets all tags.
    pub fn clear(&mut self) {
        for slot in &mut self.slots {
            slot.owner = None;
        }
        self.present = Present::EMPTY;
    }

    /// All tags that are tracked, and their trackers.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Tracker<N, B, D, S>)> {
        self.slots
            .iter()
            .filter_map(|slot| slot.owner.map(|(tag, _)| (tag, &slot.tracker)))
    }

    /// All tags that are tracked, and their trackers.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (u32, &mut Tracker<N, B, D, S>)> {
        let slots = self.slots.iter_mut();
        slots.filter_map(|slot| slot.owner.map(|(tag, _)| (tag, &mut slot.tracker)))
    }
}

persist!(
    impl[const N: usize, const B: usize, const D: usize, S: Stored] Slot<N, B, D, S> as "Slot"(N, B)
    { owner, tracker }
);
persist!(
    impl[const T: usize, const N: usize, const B: usize, const D: usize, S: Stored]
    Trackers<T, N, B, D, S> as "Trackers"(T)
    { slots, present }
);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    type Few = Trackers<3, 10>;

    fn tags(trackers: &Few) -> Vec<u32> {
        let mut tags: Vec<u32> = trackers.iter().map(|(tag, _)| tag).collect();
        tags.sort_unstable();
        tags
    }

    /// Three tags, each heard once a second for a minute from `start` on; then one of them falls silent for 40 s.
    fn with_a_silent_tag(start: u32, mut each: impl FnMut(&mut Few, u32)) -> Few {
        let mut trackers = Few::EMPTY;
        for i in 0..300 {
            let time_ms = start.wrapping_add(333 * i);
            let tag = i % 3;
            if tag != 1 || i < 180 {
                assert_eq!(trackers.of(tag, time_ms).unwrap().1, None);
            }
            each(&mut trackers, time_ms);
        }
        trackers
    }

    #[test]
    fn the_longest_silent_tag_is_evicted_while_the_clock_overflows() {
        let start = u32::MAX - 80_000;
        let mut trackers = with_a_silent_tag(start, |_, _| {});
        let (_, evicted) = trackers.of(7, start.wrapping_add(100_000)).unwrap();
        assert_eq!(evicted, Some(1));
        assert_eq!(tags(&trackers), [0, 2, 7]);
    }

    #[test]
    fn a_tag_too_many_takes_nobodys_tracker() {
        let mut trackers = Few::EMPTY;
        for i in 0..4_000 {
            let refused = trackers.of(i % 4, 250 * i).is_none();
            assert_eq!(refused, i % 4 == 3);
        }
        assert_eq!(tags(&trackers), [0, 1, 2]);
    }

    #[test]
    fn a_packet_from_the_future_keeps_no_tracker_and_takes_none() {
        let mut trackers = with_a_silent_tag(0, |trackers, time_ms| {
            if time_ms == 333 * 178 {
                // The last packet of the tag that falls silent states a time an hour ahead.
                assert!(trackers.of(1, time_ms + 3_600_000).is_some());
            }
            if (1_000..333 * 179).contains(&time_ms) {
                assert!(trackers.of(8, time_ms + 3_600_000).is_none());
            }
        });
        assert_eq!(trackers.of(7, 100_000).unwrap().1, Some(1));
    }

    #[test]
    fn a_late_packet_loses_no_tracker_and_takes_none() {
        let mut trackers = with_a_silent_tag(4_000_000, |trackers, time_ms| {
            if (4_001_000..4_000_000 + 333 * 179).contains(&time_ms) {
                assert!(trackers.of(8, time_ms - 3_600_000).is_none());
            }
            // The packets of tag 2 reach us late as well.
            if time_ms > 4_001_000 {
                assert!(trackers.of(2, time_ms - 40_000).is_some());
            }
        });
        assert_eq!(trackers.of(7, 4_100_000).unwrap().1, Some(1));
    }

    proptest! {
        /// Whatever time is stated by one packet in four, nobody loses a tracker who was heard in the last 28 s.
        #[test]
        fn wrong_times_bend_nothing(
            heard in proptest::collection::vec((0..6u32, 0..450u32, any::<u32>()), 1..800)
        ) {
            let mut trackers = Few::EMPTY;
            let mut time_ms = 1u32 << 31;
            let mut last = [None; 6];
            for (number, (tag, after, wrong)) in heard.into_iter().enumerate() {
                // The lower ones are heard more often.
                let tag = tag * (number as u32 % 3) / 2;
                time_ms = time_ms.wrapping_add(after);
                let stated = if number % 4 == 3 { wrong } else { time_ms };
                let evicted = trackers.of(tag, stated).and_then(|(_, evicted)| evicted);
                last[tag as usize] = Some(time_ms);
                if let Some(silence) = evicted.and_then(|tag| last[tag as usize]) {
                    prop_assert!(time_ms - silence > 28_000, "{}", time_ms - silence);
                }
                // A wrong time that is a little ahead is believed for a second.
                let near = trackers.now_ms().wrapping_sub(time_ms) as i32;
                prop_assert!(number == 0 || near.abs() <= 1_900, "{near}");
            }
        }
    }
}
