//! The bearings that a locator rests on, in a bounded buffer. One of them may stand for several.

use heapless::Vec;

use crate::aoa::triangulation::linearise;
use crate::aoa::{Alternative, Bearing, Observation, PushError, Retract, Retracted};
use crate::math::{atan2, larger, smaller, sqrt, wrap};
use crate::persist;
use crate::snapshot::value;

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

/// One bearing, or the mean of several of one station.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The bearing, with the time of the last reading.
    pub(in crate::aoa) observation: Observation,
    /// The probability, beside others of the same reading, that it is the one if any is.
    pub(in crate::aoa) probability: f32,
    /// Number of readings averaged.
    pub(in crate::aoa) readings: f32,
    /// Number of places whose bearings were averaged: their errors are as good as independent.
    pub(in crate::aoa) worth: f32,
    /// When the first of them was taken.
    pub(in crate::aoa) first_ms: u32,
}

value!(Entry {
    observation,
    probability,
    readings,
    worth,
    first_ms,
});

/// How much of what an entry stands for is to be taken back.
enum Part {
    None,
    Some,
    All,
}

/// How the bearings of a locator compare.
pub(in crate::aoa) trait Comparison {
    /// Where the source is thought to be, if anywhere.
    fn source(&self) -> Option<[f32; 2]>;

    /// The angle from one bearing to the other, of those that are the same but for whole turns.
    fn fold(&self, _a: &Entry, _b: &Entry, angle: f32) -> f32 {
        angle
    }

    /// Whether two bearings are of one place, where an error that they have in common is one.
    fn are_of_one_place(&self, _a: &Entry, _b: &Entry) -> bool {
        false
    }

    /// Whether two bearings may well be of the same direction.
    fn is_similar(&self, _a: &Entry, _b: &Entry) -> bool {
        true
    }

    /// How much would be lost with the one of two that contradict each other that is not kept, from nothing to one.
    fn stake(&self, _a: &Entry, _b: &Entry) -> f32 {
        0.0
    }

    /// Whether `a` is kept rather than `b`, which contradicts it.
    fn prefers(&self, _a: &Entry, _b: &Entry) -> bool {
        true
    }
}

/// Clean bearings, which never contradict each other, on a source that is thought to be here.
impl Comparison for Option<[f32; 2]> {
    fn source(&self) -> Option<[f32; 2]> {
        *self
    }
}

impl From<&Alternative> for Entry {
    fn from(bearing: &Alternative) -> Self {
        Self::new(*bearing.observation(), bearing.probability())
    }
}

impl AsRef<Observation> for Entry {
    fn as_ref(&self) -> &Observation {
        &self.observation
    }
}

impl Entry {
    pub(in crate::aoa) const fn new(observation: Observation, probability: f32) -> Self {
        Self {
            observation,
            probability,
            readings: 1.0,
            worth: 1.0,
            first_ms: observation.time_ms(),
        }
    }

    pub(in crate::aoa) fn position(&self) -> [f32; 2] {
        self.observation.position()
    }

    /// How much of it is to be taken back.
    fn part_of(&self, what: &Retract) -> Part {
        let last = &self.observation;
        let all_if = |whole: bool| if whole { Part::All } else { Part::Some };
        match *what {
            Retract::Bearing { time_ms, station } => {
                let since_first = time_ms.wrapping_sub(self.first_ms) as i32;
                let is_within = last.since_ms(time_ms) >= 0 && since_first >= 0;
                if last.station() != station || !is_within {
                    Part::None
                } else {
                    all_if(last.time_ms() == time_ms && self.first_ms == time_ms)
                }
            }
            Retract::Span { from_ms, until_ms } => {
                let first = |time_ms: u32| time_ms.wrapping_sub(self.first_ms) as i32;
                if last.since_ms(from_ms) < 0 || first(until_ms) < 0 {
                    Part::None
                } else {
                    all_if(first(from_ms) <= 0 && last.since_ms(until_ms) <= 0)
                }
            }
            Retract::Place { position, radius_m } => {
                if square_of_distance(position, self.position()) > radius_m * radius_m {
                    Part::None
                } else {
                    // The mean of several places may be near one where none of them is.
                    all_if(self.worth == 1.0)
                }
            }
        }
    }

    /// How many readings it stands for, in which bearings that exclude each other are one.
    pub(in crate::aoa) fn weight(&self) -> f32 {
        self.probability * self.readings
    }

    /// Whether it may be one of several bearings of a reading, which exclude each other.
    pub(in crate::aoa) fn is_one_of_several(&self) -> bool {
        self.probability < 1.0
    }

    /// Whether both may be of one reading, whose bearings meet where they were taken.
    pub(in crate::aoa) fn excludes(&self, other: &Self) -> bool {
        let both = self.is_one_of_several() && other.is_one_of_several();
        both && self.position() == other.position()
    }

    /// Whether they are, or the last of each: of several sources, those of one stop were heard at different times.
    pub(in crate::aoa) fn excludes_last(&self, other: &Self) -> bool {
        self.excludes(other) && self.observation.time_ms() == other.observation.time_ms()
    }

    /// Bearings of different stations are never merged.
    pub(in crate::aoa) fn is_of_station_of(&self, other: &Self) -> bool {
        self.observation.station() == other.observation.station()
    }

    /// Whether a reading of this station and time is known to be in it.
    pub(in crate::aoa) fn holds(&self, reading: &Observation) -> bool {
        let last = &self.observation;
        last.station() == reading.station()
            && (last.time_ms() == reading.time_ms() || self.first_ms == reading.time_ms())
    }

    /// Seconds between the spans of the readings of two.
    pub(in crate::aoa) fn seconds_from(&self, other: &Self) -> f32 {
        let after = |a: &Self, b: &Self| {
            1e-3 * b.observation.since_ms(a.observation.time_ms()) as f32 - b.span_s()
        };
        let (forth, back) = (after(self, other), after(other, self));
        let gap = larger(forth, back);
        larger(gap, 0.0)
    }

    /// Seconds between the first and the last of the readings.
    pub(in crate::aoa) fn span_s(&self) -> f32 {
        1e-3 * self.observation.since_ms(self.first_ms) as f32
    }

    /// Takes other readings of the same place into the mean, in which every reading counts the same. They tell as much as
    /// one reading, in the mean: how much less their own errors are is for the caller to say, by the number of readings.
    pub(in crate::aoa) fn join(&mut self, other: &Self, comparison: &impl Comparison) {
        let [old, fresh] =
            [&*self, other].map(|entry| entry.readings * entry.observation.information());
        let readings = self.readings + other.readings;
        self.blend(
            other,
            fresh / (old + fresh),
            (old + fresh) / readings,
            comparison,
        );
    }

    /// Takes another in that says the same.
    fn merge(&mut self, other: &Self, comparison: &impl Comparison) {
        if comparison.are_of_one_place(self, other) {
            self.join(other, comparison);
        } else {
            self.average(other, comparison);
        }
    }

    /// Takes another in, each counting by its information.
    pub(in crate::aoa) fn average(&mut self, other: &Self, comparison: &impl Comparison) {
        let [a, b] = [self.observation, other.observation].map(|o| o.information());
        self.blend(other, b / (a + b), a + b, comparison);
        self.worth += other.worth;
    }

    /// Becomes the bearing that is `part` of the way to `other` and worth `information`.
    ///
    /// The error that it has at the source is the average of theirs; far sources see the two under equal angles.
    fn blend(&mut self, other: &Self, part: f32, information: f32, comparison: &impl Comparison) {
        let (a, b) = (&self.observation, &other.observation);
        let mix = |a: f32, b: f32| a + part * (b - a);
        let (from, to) = (a.position(), b.position());
        let position = [mix(from[0], to[0]), mix(from[1], to[1])];
        let [ea, eb] = [self, other].map(|entry| entry.angle(comparison.source()));
        let turn = comparison.fold(self, other, wrap(eb - ea));
        // A mirrored one only of two mirrored ones.
        let error = if comparison.source().is_none() || ea.abs() <= eb.abs() {
            ea + part * turn
        } else {
            eb - (1.0 - part) * turn
        };
        let direction = comparison
            .source()
            .map_or(0.0, |[x, y]| atan2(y - position[1], x - position[0]));
        let sigma = 1.0 / sqrt(information);
        let least = Observation::MIN_SIGMA_RAD;
        let sigma = larger(sigma, least);
        let time_ms = (if b.since_ms(a.time_ms()) > 0 { b } else { a }).time_ms();
        let bearing = Bearing::from_radians(direction + error);
        // What lies between two observations is one.
        if let Ok(mean) = Observation::new(time_ms, position, bearing, sigma) {
            let part = other.readings / (self.readings + other.readings);
            self.probability += part * (other.probability - self.probability);
            self.readings += other.readings;
            if mean.since_ms(other.first_ms) > mean.since_ms(self.first_ms) {
                self.first_ms = other.first_ms;
            }
            self.observation = mean.from_station(a.station()).with_heading(a.heading());
        }
    }

    /// Error of the bearing at the source; the bearing itself if it is not known where that is.
    fn angle(&self, source: Option<[f32; 2]>) -> f32 {
        match source {
            Some(source) => linearise(&self.observation, source).residual,
            None => self.observation.bearing().radians(),
        }
    }

    /// The angle from this bearing to another, as errors at the source if that is known.
    pub(in crate::aoa) fn turn(&self, other: &Self, comparison: &impl Comparison) -> f32 {
        let [a, b] = [self, other].map(|entry| entry.angle(comparison.source()));
        comparison.fold(self, other, wrap(b - a))
    }
}

pub(in crate::aoa) fn square_of_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
