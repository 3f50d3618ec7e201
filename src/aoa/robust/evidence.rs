//! The bearings that a locator rests on, in a bounded buffer.

use heapless::Vec;

use super::Config;
use super::candidates::Candidate;
use super::density::{Density, Region};
use super::errors::Errors;
use super::merge::{Entry, similar};
use super::mode::{Mode, Modes};
use super::term::{State, Term};
use crate::aoa::{Alternative, Observation, PushError};
use crate::math::{ln, sqrt, wrap};
use crate::persist;

/// All bits of an empty one are zero.
#[derive(Debug, Clone)]
pub(super) struct Evidence<const B: usize> {
    entries: Vec<Entry, B>,
    /// Of the entries, in the same order.
    terms: Vec<Term, B>,
    /// Centre of the prior.
    centre: [f32; 2],
    /// Its range; zero for that of the configuration.
    range_m: f32,
    /// Where the source was thought to be when the terms were made.
    source: Option<State>,
    latest: Option<Observation>,
    /// Bearings that went in, in which those that exclude each other are one.
    count: f32,
}

/// What a new bearing changed.
pub(super) struct Change {
    /// What it says,
    pub(super) new: Term,
    /// and what no longer is said, if it has been joined with a former one.
    pub(super) old: Option<Term>,
    /// It has no alternative that is more likely.
    pub(super) likely: bool,
}

impl<const B: usize> Evidence<B> {
    pub(super) const EMPTY: Self = Self {
        entries: Vec::new(),
        terms: Vec::new(),
        centre: [0.0; 2],
        range_m: 0.0,
        source: None,
        latest: None,
        count: 0.0,
    };

    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.terms.clear();
        (self.centre, self.range_m) = ([0.0; 2], 0.0);
        self.source = None;
        self.latest = None;
        self.count = 0.0;
    }

    pub(super) fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.entries.iter().map(|entry| &entry.observation)
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// How many bearings went in.
    pub(super) fn count(&self) -> u32 {
        (self.count + 0.5) as u32
    }

    /// The latest bearing.
    pub(super) fn latest(&self) -> Option<&Observation> {
        self.latest.as_ref()
    }

    /// The prior is about here.
    pub(super) fn centre_on(&mut self, centre: [f32; 2], range_m: f32) {
        (self.centre, self.range_m) = (centre, range_m);
    }

    /// The prior of the place.
    pub(super) fn region(&self, config: &Config) -> Region {
        let own = self.range_m;
        let range_m = if own > 0.0 { own } else { config.range_m };
        Region {
            centre: self.centre,
            inverse_square: 1.0 / (range_m * range_m),
        }
    }

    /// Whether a reading can be taken.
    pub(super) fn admit(&self, observation: &Observation) -> Result<(), PushError> {
        let Some(latest) = &self.latest else {
            return Ok(());
        };
        let is_latest =
            (latest.time_ms(), latest.station()) == (observation.time_ms(), observation.station());
        if is_latest || self.entries.iter().any(|entry| entry.holds(observation)) {
            return Err(PushError::Duplicate);
        }
        let late = latest.since_ms(observation.time_ms());
        let age = |entry: &Entry| latest.since_ms(entry.first_ms) as u32;
        if late > 0 && !self.entries.iter().any(|entry| age(entry) >= late as u32) {
            return Err(PushError::TooOld);
        }
        Ok(())
    }

    /// Forgets its own bearings, and takes those of another memory.
    pub(super) fn adopt(&mut self, candidate: &Candidate<'_>, errors: &Errors) {
        self.clear();
        self.latest = candidate.latest.copied();
        self.centre = (candidate.latest).map_or([0.0; 2], Observation::position);
        self.source = Some(candidate.mode.mean);
        for entry in candidate.own() {
            self.count += entry.readings * entry.probability;
            let term = self.term(entry, errors);
            self.add(*entry, term, Some(&candidate.mode.mean), errors);
        }
    }

    /// Forgets the bearings that a mode explains.
    pub(super) fn release(&mut self, mode: &Mode, errors: &Errors) {
        let mut left = self.terms.iter().map(|term| !explains(mode, term, errors));
        let mut gone = 0.0;
        self.entries.retain(|entry| {
            let stays = left.next().unwrap_or(true);
            if !stays {
                gone += entry.readings * entry.probability;
            }
            stays
        });
        self.terms.retain(|term| !explains(mode, term, errors));
        self.count -= if gone < self.count { gone } else { self.count };
    }

    /// The bearings in which a mode of all may be looked for.
    pub(super) fn candidate<'a>(
        &'a self,
        mode: &'a Mode,
        modes: &'a Modes,
        errors: &'a Errors,
    ) -> Candidate<'a> {
        Candidate {
            entries: &self.entries,
            terms: &self.terms,
            mode,
            modes,
            errors,
            latest: self.latest(),
        }
    }

    /// Square of the distance of a point from where the latest bearing was taken.
    pub(super) fn range_squared(&self, x: f32, y: f32) -> f32 {
        let latest = self.latest().map_or([0.0; 2], Observation::position);
        square_of_distance([x, y], latest)
    }

    pub(super) fn density(&self, config: &Config) -> Density<'_> {
        Density {
            terms: &self.terms,
            region: self.region(config),
            bias_sigma_rad: config.errors.bias_sigma_rad,
        }
    }

    /// Of the error of a bearing, with that of its place.
    pub(super) fn variance(&self, entry: &Entry, errors: &Errors) -> f32 {
        errors.variance(&entry.observation, entry.worth, self.source.as_ref())
    }

    /// What a bearing says that is not in the buffer.
    pub(super) fn single(&self, observation: &Observation, errors: &Errors) -> Term {
        self.term(&Entry::new(*observation, 1.0), errors)
    }

    fn term(&self, entry: &Entry, errors: &Errors) -> Term {
        Term::new(&entry.observation, errors, self.variance(entry, errors))
            .with_probability(entry.probability)
    }

    /// Takes a bearing. `source` is where the source is thought to be, if anywhere.
    pub(super) fn push(
        &mut self,
        bearing: &Alternative,
        source: Option<&State>,
        errors: &Errors,
    ) -> Change {
        let (observation, probability) = (*bearing.observation(), bearing.probability());
        if self.count == 0.0 {
            self.centre = observation.position();
        }
        // Before a fix, the range is that of the best hypothesis.
        if source.is_some() {
            self.source = source.copied();
        }
        if (self.latest).is_none_or(|latest| observation.since_ms(latest.time_ms()) >= 0) {
            self.latest = Some(observation);
        }
        self.count += probability;
        let likely = probability > 0.5;
        let mut new = Entry::new(observation, probability);
        let correlation = errors.correlation;
        if correlation.at_rest > 0.0
            && let Some((place, distance)) = self.nearest_alike(&new, source, errors)
            && let Some(entry) = self.entries.get_mut(place)
        {
            let seconds = entry.seconds_from(observation.time_ms());
            let worth = correlation.worth(correlation.lengths(distance, seconds));
            if distance < 0.25 * correlation.distance_m {
                entry.join(&new, worth, source);
                let entry = *entry;
                let new = self.term(&entry, errors);
                let old = self.terms.get_mut(place);
                let old = old.map(|term| core::mem::replace(term, new));
                return Change { new, old, likely };
            }
            new.observation = tempered(observation, worth);
        }
        let term = self.term(&new, errors);
        self.add(new, term, source, errors);
        Change {
            new: term,
            old: None,
            likely,
        }
    }

    fn add(&mut self, new: Entry, term: Term, source: Option<&State>, errors: &Errors) {
        if self.entries.push(new).is_ok() {
            let _ = self.terms.push(term);
            return;
        }
        let Some(Pair { i, j, similar }) = self.most_alike(source, errors) else {
            // Each of another station: the one that was taken first is forgotten.
            if let Some(oldest) = self.oldest() {
                self.replace(oldest, new, term);
            }
            return;
        };
        let Some((a, b)) = self.entries.get(i).zip(self.entries.get(j)) else {
            return;
        };
        // What does not say the same makes no sense as an average.
        let mut one = *a;
        if similar {
            one.average(b, source);
        } else if !self.likelier(i, j, source, errors) {
            one = *b;
        }
        self.replace(i, one, self.term(&one, errors));
        self.replace(j, new, term);
    }

    /// The bearing that was taken first.
    fn oldest(&self) -> Option<usize> {
        let latest = self.latest()?;
        let age = |(_, entry): &(usize, &Entry)| latest.since_ms(entry.observation.time_ms());
        let oldest = self.entries.iter().enumerate().max_by_key(age);
        oldest.map(|(place, _)| place)
    }

    fn replace(&mut self, place: usize, entry: Entry, term: Term) {
        if let Some((s, t)) = self.entries.get_mut(place).zip(self.terms.get_mut(place)) {
            (*s, *t) = (entry, term);
        }
    }

    /// The nearest bearing that says the same, and how far away it was taken, in metres.
    fn nearest_alike(
        &self,
        new: &Entry,
        source: Option<&State>,
        errors: &Errors,
    ) -> Option<(usize, f32)> {
        let mut best = None;
        let mut least = f32::INFINITY;
        let place = new.observation.position();
        for (i, old) in self.entries.iter().enumerate() {
            let square = square_of_distance(old.observation.position(), place);
            if square < least && old.is_of_station_of(new) && similar(old, new, source, errors) {
                least = square;
                best = Some(i);
            }
        }
        best.map(|i| (i, sqrt(least)))
    }

    /// Whether bearing `i` is to be kept rather than `j`.
    fn likelier(&self, i: usize, j: usize, source: Option<&State>, errors: &Errors) -> bool {
        let doubt = |i: usize| {
            let (entry, term) = self.entries.get(i).zip(self.terms.get(i))?;
            Some(match source {
                Some(state) => -term.log_likelihood(state, errors.bias_sigma_rad * state[2]),
                None => entry.observation.sigma_rad(),
            })
        };
        doubt(i) <= doubt(j)
    }

    /// The pair that was taken from places nearest to each other, in metres, or as seen from the source; pairs that say
    /// the same are preferred, but not at any price: the others would fill the buffer.
    #[inline(never)]
    fn most_alike(&self, source: Option<&State>, errors: &Errors) -> Option<Pair> {
        /// How many times as far, squared, a pair that disagrees counts as.
        const PENALTY: f32 = 4.0;
        /// Its least squared distance, so that this holds at one place, too;
        const APART: f32 = 1e-6;
        /// and if they exclude each other: both are to be kept, for it may be either. As seen from the source, or in metres.
        const EXCLUSIVE: f32 = 0.01;
        const EXCLUSIVE_M: f32 = 1e4;
        let exclusive = source.map_or(EXCLUSIVE_M, |_| EXCLUSIVE);
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, a) in self.entries.iter().enumerate() {
            let place = a.observation.position();
            let range = source.map_or(1.0, |s| square_of_distance([s[0], s[1]], place));
            for (j, b) in self.entries.iter().enumerate().skip(i + 1) {
                let difference = square_of_distance(place, b.observation.position()) / range;
                if difference < least && a.is_of_station_of(b) {
                    let similar = similar(a, b, source, errors);
                    let difference = if similar {
                        difference
                    } else {
                        let both = a.is_one_of_several() && b.is_one_of_several();
                        PENALTY * (difference + if both { exclusive } else { APART })
                    };
                    if difference < least {
                        least = difference;
                        best = Some(Pair { i, j, similar });
                    }
                }
            }
        }
        best
    }

    /// After the errors have been learned, or where the source is.
    pub(super) fn refresh(&mut self, errors: &Errors, source: &State) {
        self.source = Some(*source);
        for (entry, term) in self.entries.iter().zip(&mut self.terms) {
            let variance = errors.variance(&entry.observation, entry.worth, Some(source));
            *term =
                Term::new(&entry.observation, errors, variance).with_probability(entry.probability);
        }
    }

    /// The log-likelihood of a source at infinity, in the direction that fits best; and the sum of 1 / sigma^2.
    #[inline(never)]
    pub(super) fn at_infinity(&self) -> (f32, f32) {
        /// Directions that are tried: those of so many bearings,
        const STARTS: usize = 16;
        /// and means of those that fit.
        const MEANS: u32 = 4;
        let density = |direction: f32| {
            let (mut sum, mut pull, mut total) = (0.0, 0.0, 1e-9);
            for (o, term) in self.observations().zip(&self.terms) {
                let reading = term.read_far(o.bearing().radians(), direction);
                sum += ln(1.0 + reading.odds);
                pull += reading.information * reading.error;
                total += reading.information;
            }
            (sum, wrap(direction - pull / total))
        };
        let (mut best, mut next) = (f32::NEG_INFINITY, 0.0);
        let step = self.entries.len().div_ceil(STARTS).max(1);
        for o in self.observations().step_by(step) {
            let (sum, mean) = density(o.bearing().radians());
            if sum > best {
                (best, next) = (sum, mean);
            }
        }
        for _ in 0..MEANS {
            let (sum, mean) = density(next);
            if sum > best {
                best = sum;
            }
            next = mean;
        }
        (
            best,
            self.entries
                .iter()
                .map(|entry| entry.probability * entry.observation.information())
                .sum(),
        )
    }
}

// Terms do not follow from the entries: each was made by what was known of the source then.
persist!(impl[const B: usize] Evidence<B> as "robust::Evidence"(B) {
    entries, terms, centre, range_m, source, latest, count
});

/// Whether a bearing is likelier direct or mirrored than an outlier if the source is at a mode.
pub(super) fn explains(mode: &Mode, term: &Term, errors: &Errors) -> bool {
    let bias = errors.bias_sigma_rad * mode.mean[2];
    term.read(&mode.mean, bias).odds > 1.0
}

/// Two places in the buffer.
struct Pair {
    i: usize,
    j: usize,
    similar: bool,
}

/// A bearing that counts for `worth` of its information.
pub(super) fn tempered(observation: Observation, worth: f32) -> Observation {
    let sigma = observation.sigma_rad() / sqrt(worth);
    let most = Observation::MAX_SIGMA_RAD;
    observation.with_sigma(if sigma < most { sigma } else { most })
}

fn square_of_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
