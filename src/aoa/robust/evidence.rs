//! The bearings that a locator rests on, in a bounded buffer.

use heapless::Vec;

use super::density::{Density, Region};
use super::errors::Errors;
use super::merge::{Sight, agree};
use super::mode::{Mode, Modes};
use super::split::{Seed, explains};
use super::term::{State, Term};
use crate::aoa::{Alternative, Observation};
use crate::math::{ln, sqrt, wrap};
use crate::snapshot::{Error, Persist, Reader, Value, Writer, list, shape};

#[derive(Debug, Clone)]
pub(super) struct Evidence<const B: usize> {
    sights: Vec<Sight, B>,
    /// Of the sights, in the same order.
    terms: Vec<Term, B>,
    region: Region,
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
    pub(super) const fn new(range_m: f32) -> Self {
        Self {
            sights: Vec::new(),
            terms: Vec::new(),
            region: Region {
                centre: [0.0; 2],
                inverse_square: 1.0 / (range_m * range_m),
            },
            source: None,
            latest: None,
            count: 0.0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.sights.clear();
        self.terms.clear();
        self.source = None;
        self.latest = None;
        self.count = 0.0;
    }

    pub(super) fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.sights.iter().map(|sight| &sight.observation)
    }

    pub(super) fn sights(&self) -> &[Sight] {
        &self.sights
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
    pub(super) fn centre_on(&mut self, [x, y]: [f32; 2], range_m: f32) {
        self.region = Region {
            centre: [x, y],
            inverse_square: 1.0 / (range_m * range_m),
        };
    }

    /// Forgets its own bearings, and takes those of another memory.
    pub(super) fn adopt(&mut self, seed: &Seed<'_>, errors: &Errors) {
        self.clear();
        self.latest = seed.latest.copied();
        self.region.centre = (seed.latest).map_or([0.0; 2], Observation::position);
        self.source = Some(seed.mode.mean);
        for sight in seed.own() {
            self.count += sight.readings() * sight.share;
            let term = self.term(sight, errors);
            self.add(*sight, term, Some(&seed.mode.mean), errors);
        }
    }

    /// Forgets the bearings that a mode explains.
    pub(super) fn release(&mut self, mode: &Mode, errors: &Errors) {
        let mut left = self.terms.iter().map(|term| !explains(mode, term, errors));
        let mut gone = 0.0;
        self.sights.retain(|sight| {
            let stays = left.next().unwrap_or(true);
            if !stays {
                gone += sight.readings() * sight.share;
            }
            stays
        });
        self.terms.retain(|term| !explains(mode, term, errors));
        self.count -= if gone < self.count { gone } else { self.count };
    }

    /// The bearings in which a mode of all may be looked for.
    pub(super) fn seed<'a>(
        &'a self,
        mode: &'a Mode,
        modes: &'a Modes,
        errors: &'a Errors,
    ) -> Seed<'a> {
        Seed {
            sights: &self.sights,
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

    pub(super) fn density(&self, errors: &Errors) -> Density<'_> {
        Density {
            terms: &self.terms,
            region: &self.region,
            bias_deviation: errors.bias_deviation,
        }
    }

    /// Of the error of a bearing, with that of its place.
    pub(super) fn variance(&self, sight: &Sight, errors: &Errors) -> f32 {
        errors.variance(&sight.observation, sight.worth, self.source.as_ref())
    }

    /// What a bearing says that is not in the buffer.
    pub(super) fn single(&self, observation: &Observation, errors: &Errors) -> Term {
        self.term(&Sight::new(*observation, 1.0), errors)
    }

    fn term(&self, sight: &Sight, errors: &Errors) -> Term {
        Term::new(&sight.observation, errors, self.variance(sight, errors)).with_share(sight.share)
    }

    /// Takes a bearing, `seconds` after the one before. `source` is where the source is thought to be, if anywhere.
    pub(super) fn push(
        &mut self,
        bearing: impl Into<Alternative>,
        seconds: f32,
        source: Option<&State>,
        errors: &Errors,
    ) -> Change {
        let bearing = bearing.into();
        let (observation, share) = (*bearing.observation(), bearing.share());
        if self.count == 0.0 {
            self.region.centre = observation.position();
        }
        // Before a fix, the range is that of the best hypothesis.
        if source.is_some() {
            self.source = source.copied();
        }
        self.latest = Some(observation);
        self.count += share;
        let likely = share > 0.5;
        for sight in &mut self.sights {
            sight.age_s += seconds;
        }
        let mut new = Sight::new(observation, share);
        let correlation = errors.correlation;
        if correlation.at_rest > 0.0
            && let Some((place, distance)) = self.nearest_alike(&new, source, errors)
            && let Some(sight) = self.sights.get_mut(place)
        {
            let worth = correlation.worth(correlation.lengths(distance, sight.age_s));
            if distance < 0.25 * correlation.distance_m {
                sight.join(&new, worth, source);
                let sight = *sight;
                let new = self.term(&sight, errors);
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

    fn add(&mut self, new: Sight, term: Term, source: Option<&State>, errors: &Errors) {
        if self.sights.push(new).is_ok() {
            let _ = self.terms.push(term);
            return;
        }
        let Some(Pair { i, j, agree }) = self.most_alike(source, errors) else {
            return;
        };
        let Some((a, b)) = self.sights.get(i).zip(self.sights.get(j)) else {
            return;
        };
        // What does not say the same makes no sense as an average.
        let mut one = *a;
        if agree {
            one.average(b, source);
        } else if !self.likelier(i, j, source, errors) {
            one = *b;
        }
        self.replace(i, one, self.term(&one, errors));
        self.replace(j, new, term);
    }

    fn replace(&mut self, place: usize, sight: Sight, term: Term) {
        if let Some((s, t)) = self.sights.get_mut(place).zip(self.terms.get_mut(place)) {
            (*s, *t) = (sight, term);
        }
    }

    /// The nearest bearing that says the same, and how far away it was taken, in metres.
    fn nearest_alike(
        &self,
        new: &Sight,
        source: Option<&State>,
        errors: &Errors,
    ) -> Option<(usize, f32)> {
        let mut best = None;
        let mut least = f32::INFINITY;
        let place = new.observation.position();
        for (i, old) in self.sights.iter().enumerate() {
            let square = square_of_distance(old.observation.position(), place);
            if square < least && agree(old, new, source, errors) {
                least = square;
                best = Some(i);
            }
        }
        best.map(|i| (i, sqrt(least)))
    }

    /// Whether bearing `i` is to be kept rather than `j`.
    fn likelier(&self, i: usize, j: usize, source: Option<&State>, errors: &Errors) -> bool {
        let doubt = |i: usize| {
            let (sight, term) = self.sights.get(i).zip(self.terms.get(i))?;
            Some(match source {
                Some(state) => -term.log_likelihood(state, errors.bias_deviation * state[2]),
                None => sight.observation.deviation(),
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
        for (i, a) in self.sights.iter().enumerate() {
            let place = a.observation.position();
            let range = source.map_or(1.0, |s| square_of_distance([s[0], s[1]], place));
            for (j, b) in self.sights.iter().enumerate().skip(i + 1) {
                let difference = square_of_distance(place, b.observation.position()) / range;
                if difference < least {
                    let agree = agree(a, b, source, errors);
                    let difference = if agree {
                        difference
                    } else {
                        let both = a.is_one_of_several() && b.is_one_of_several();
                        PENALTY * (difference + if both { exclusive } else { APART })
                    };
                    if difference < least {
                        least = difference;
                        best = Some(Pair { i, j, agree });
                    }
                }
            }
        }
        best
    }

    /// After the errors have been learned, or where the source is.
    pub(super) fn refresh(&mut self, errors: &Errors, source: &State) {
        self.source = Some(*source);
        for (sight, term) in self.sights.iter().zip(&mut self.terms) {
            let variance = errors.variance(&sight.observation, sight.worth, Some(source));
            *term = Term::new(&sight.observation, errors, variance).with_share(sight.share);
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
        let step = self.sights.len().div_ceil(STARTS).max(1);
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
            self.sights
                .iter()
                .map(|sight| sight.share * sight.observation.information())
                .sum(),
        )
    }
}

/// Terms do not follow from the sights: each was made by what was known of the source then.
impl<const B: usize> Persist for Evidence<B> {
    const SHAPE: u32 = shape("robust::Evidence", &[B as u32]);
    const BYTES: usize = list::bytes::<Sight>(B) + list::bytes::<Term>(B) + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            sights,
            terms,
            region,
            source,
            latest,
            count,
        } = self;
        list::save(sights, to);
        list::save(terms, to);
        Rest::write(&((*region, *count), (*source, *latest)), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        list::check::<Sight>(B, from)?;
        list::check::<Term>(B, from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        list::load(&mut self.sights, from)?;
        list::load(&mut self.terms, from)?;
        ((self.region, self.count), (self.source, self.latest)) = Rest::read(from)?;
        Ok(())
    }
}

/// In a snapshot, what is behind the lists.
type Rest = ((Region, f32), (Option<State>, Option<Observation>));

/// Two places in the buffer.
struct Pair {
    i: usize,
    j: usize,
    agree: bool,
}

/// A bearing that counts for `worth` of its information.
pub(super) fn tempered(observation: Observation, worth: f32) -> Observation {
    let deviation = observation.deviation() / sqrt(worth);
    let most = Observation::MAX_DEVIATION_RAD;
    let deviation = if deviation < most { deviation } else { most };
    Observation::new(observation.position(), observation.bearing(), deviation)
        .unwrap_or(observation)
}

fn square_of_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
