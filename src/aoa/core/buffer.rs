//! The bearings that a locator rests on, in a bounded buffer. One of them may stand for several.

use heapless::Vec;

use super::entry::{Comparison, Entry, Part, square_of_distance};
use crate::aoa::{Observation, PushError, Retract, Retracted};
use crate::math::smaller;
use crate::persist;

/// A full buffer makes room by averaging the two bearings that say most nearly the same: a long drive thins out where it
/// was far from the source, a stationary vehicle's readings become one, and nothing is forgotten. All bits of an empty one
/// are zero.
///
/// A reading comes in by three calls, in this order: [`admit`](Buffer::admit), which may refuse it, [`note`](Buffer::note)
/// and [`add`](Buffer::add).
#[derive(Debug, Clone)]
pub(in crate::aoa) struct Buffer<const B: usize> {
    entries: Vec<Entry, B>,
    latest: Option<Observation>,
    /// Readings that went in, in which bearings that exclude each other are one.
    count: f32,
}

persist!(impl[const B: usize] Buffer<B> as "Buffer"(B) { entries, latest, count });

impl<const B: usize> Buffer<B> {
    pub(in crate::aoa) const EMPTY: Self = Self {
        entries: Vec::new(),
        latest: None,
        count: 0.0,
    };

    pub(in crate::aoa) fn clear(&mut self) {
        self.entries.clear();
        self.latest = None;
        self.count = 0.0;
    }

    pub(in crate::aoa) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    pub(in crate::aoa) fn entries_mut(&mut self) -> &mut [Entry] {
        &mut self.entries
    }

    pub(in crate::aoa) fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.entries.iter().map(|entry| &entry.observation)
    }

    /// Number of readings that went in.
    pub(in crate::aoa) fn count(&self) -> u32 {
        (self.count + 0.5) as u32
    }

    /// The latest bearing by time.
    pub(in crate::aoa) fn latest(&self) -> Option<&Observation> {
        self.latest.as_ref()
    }

    /// Mean of the squares of the distances of a point from where the bearings were taken.
    #[inline(never)]
    pub(in crate::aoa) fn range_squared(&self, point: [f32; 2]) -> f32 {
        let squares =
            (self.entries.iter()).map(|entry| square_of_distance(point, entry.position()));
        squares.sum::<f32>() / self.entries.len() as f32
    }

    /// Whether a reading can be taken.
    ///
    /// # Errors
    /// Not if one of its station and time is known to be in the buffer, or if it is older than all that are.
    pub(in crate::aoa) fn admit(&self, reading: &Observation) -> Result<(), PushError> {
        let Some(latest) = &self.latest else {
            return Ok(());
        };
        let is_latest =
            (latest.time_ms(), latest.station()) == (reading.time_ms(), reading.station());
        if is_latest || self.entries.iter().any(|entry| entry.holds(reading)) {
            return Err(PushError::Duplicate);
        }
        let late = latest.since_ms(reading.time_ms());
        // Unsigned: the first readings of an entry may be older than a signed difference tells.
        let age = |entry: &Entry| latest.since_ms(entry.first_ms) as u32;
        if late > 0 && !self.entries.iter().any(|entry| age(entry) >= late as u32) {
            return Err(PushError::TooOld);
        }
        Ok(())
    }

    /// Counts a bearing of so many readings, and remembers it if it is the latest.
    pub(in crate::aoa) fn note(&mut self, observation: &Observation, readings: f32) {
        let is_latest = |latest: Observation| observation.since_ms(latest.time_ms()) >= 0;
        if self.latest.is_none_or(is_latest) {
            self.latest = Some(*observation);
        }
        self.count += readings;
    }

    /// Takes the `wanted` bearings of another buffer, and its latest observation. Of more than there is room for, those that
    /// follow each other and say the same become one, the first ones first.
    pub(in crate::aoa) fn adopt<'a>(
        &mut self,
        wanted: impl Iterator<Item = &'a Entry> + Clone,
        latest: Option<&Observation>,
        comparison: &impl Comparison,
    ) {
        self.clear();
        self.latest = latest.copied();
        let mut excess = wanted.clone().count().saturating_sub(B);
        let mut is_alone = false;
        for entry in wanted {
            self.count += entry.readings * entry.probability;
            let last = self.entries.last_mut().filter(|last| {
                excess > 0
                    && is_alone
                    && last.is_of_station_of(entry)
                    && comparison.is_similar(last, entry)
            });
            is_alone = last.is_none();
            if let Some(last) = last {
                last.merge(entry, comparison);
                excess -= 1;
            } else {
                self.add(*entry, comparison);
            }
        }
    }

    /// Forgets all bearings but those to `keep`.
    pub(in crate::aoa) fn retain(&mut self, mut keep: impl FnMut(&Entry) -> bool) {
        let mut gone = 0.0;
        self.entries.retain(|entry| {
            let stays = keep(entry);
            if !stays {
                gone += entry.readings * entry.probability;
            }
            stays
        });
        self.count -= smaller(gone, self.count);
    }

    /// Gives the entry at an index away.
    pub(in crate::aoa) fn take(&mut self, index: usize) -> Option<Entry> {
        let taken = self.entries.get(index).copied();
        let mut indices = 0..;
        self.retain(|_| indices.next() != Some(index));
        taken
    }

    /// Forgets the bearings that are taken back, as far as they can be told from others.
    #[inline(never)]
    pub(in crate::aoa) fn retract(&mut self, what: &Retract) -> Retracted {
        let mut retracted = Retracted::NOTHING;
        for entry in &self.entries {
            let readings = (entry.readings + 0.5) as u32;
            match entry.part_of(what) {
                Part::None => {}
                Part::Some => retracted.merged += readings,
                Part::All => retracted.bearings += readings,
            }
        }
        if retracted.bearings > 0 {
            self.retain(|entry| !matches!(entry.part_of(what), Part::All));
        }
        retracted
    }

    /// Takes a bearing that is not merged with another, unless there is no other room.
    pub(in crate::aoa) fn add(&mut self, new: Entry, comparison: &impl Comparison) {
        if self.entries.push(new).is_ok() {
            return;
        }
        let Some((i, j, similar)) = self.most_similar(comparison) else {
            // Each is of another station: the one that was taken first is forgotten.
            if let Some(oldest) = self.oldest() {
                *oldest = new;
            }
            return;
        };
        let Ok([a, b]) = self.entries.get_disjoint_mut([i, j]) else {
            return;
        };
        // What does not say the same makes no sense as an average.
        if similar {
            a.merge(b, comparison);
        } else if !comparison.prefers(a, b) {
            *a = *b;
        }
        *b = new;
    }

    /// The bearing that was taken first.
    fn oldest(&mut self) -> Option<&mut Entry> {
        let latest = self.latest?;
        let age = |entry: &&mut Entry| latest.since_ms(entry.observation.time_ms());
        self.entries.iter_mut().max_by_key(age)
    }

    /// The pair of one station that was taken from places nearest to each other, in metres, or as seen from the source,
    /// and whether they are similar. Pairs that say the same are preferred, but not at any price: the others would fill the
    /// buffer.
    #[inline(never)]
    fn most_similar(&self, comparison: &impl Comparison) -> Option<(usize, usize, bool)> {
        /// How many times as far, squared, a contradictory pair counts as: room for outliers against precision.
        const PENALTY: f32 = 4.0;
        /// Its least squared distance, so that the penalty holds at one place, too.
        const APART: f32 = 1e-6;
        /// Its least squared distance if the two exclude each other: both are to be kept, for it may be either. As seen
        /// from the source, or in square metres.
        const EXCLUSIVE: f32 = 0.01;
        const EXCLUSIVE_M2: f32 = 1e4;
        let source = comparison.source();
        let exclusive = source.map_or(EXCLUSIVE_M2, |_| EXCLUSIVE);
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, a) in self.entries.iter().enumerate() {
            let range = source.map_or(1.0, |source| square_of_distance(source, a.position()));
            for (j, b) in self.entries.iter().enumerate().skip(i + 1) {
                let difference = square_of_distance(a.position(), b.position()) / range;
                if difference < least && a.is_of_station_of(b) {
                    let similar = comparison.is_similar(a, b);
                    let difference = if similar {
                        difference
                    } else {
                        let both = a.is_one_of_several() && b.is_one_of_several();
                        let stake = if both { 1.0 } else { comparison.stake(a, b) };
                        PENALTY * (difference + APART + stake * exclusive)
                    };
                    if difference < least {
                        least = difference;
                        best = Some((i, j, similar));
                    }
                }
            }
        }
        best
    }
}
