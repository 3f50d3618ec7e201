//! What bearings have in common with each other: errors, and places.

use heapless::Vec;

use super::errors::Errors;
use super::evidence::{Evidence, Lines, Terms};
use super::term::Term;
use crate::aoa::Observation;
use crate::aoa::core::{Comparison, Entry, square_of_distance};
use crate::math::{sqrt, wrap};

/// Fraction of the length over which correlation falls within which two places are one.
const SAME_PLACE: f32 = 0.25;

/// What an entry has in common with all that are in the buffer.
#[derive(Clone, Copy)]
struct Part {
    /// Sum of the covariances of its error with theirs, in square stated sigmas.
    covariance: f32,
    /// The first entry of the same place.
    first: u16,
}

/// How two entries compare.
struct Pair {
    covariance: f32,
    is_of_one_place: bool,
}

impl Pair {
    const APART: Self = Self {
        covariance: 0.0,
        is_of_one_place: false,
    };
}

/// All that is needed to compare an entry with others.
struct Compared<'a> {
    entry: &'a Entry,
    /// Error at the source, or the bearing.
    angle: f32,
    /// Over how many metres the correlation of its error falls.
    length_m: f32,
}

impl<const B: usize, const D: usize> Evidence<B, D> {
    /// What the bearings say, those of one place after each other. Made when it is needed, because it takes as much memory
    /// as they do.
    ///
    /// Bearings that have an error in common count together for as much as they tell if each counts for its own part of the sum of
    /// its covariances: n that have all of it in common for one, and those of an autoregression for what one more tells on
    /// its own. Those of one place that do not say the same exclude each other: not more than one of them points at the
    /// source, whatever the scale of the errors is.
    #[inline(never)]
    pub(super) fn terms(&self, errors: &Errors) -> Terms<D, B> {
        let parts = self.parts(errors);
        let mut terms = Terms::new();
        for (i, part) in parts.iter().enumerate() {
            if usize::from(part.first) != i {
                continue;
            }
            let of_place = || {
                let all = self.entries().iter().zip(&parts).skip(i);
                all.filter(|(_, other)| usize::from(other.first) == i)
            };
            let readings: f32 = of_place().map(|(entry, _)| entry.weight()).sum();
            for (entry, part) in of_place() {
                let _ = terms.push(self.term(entry, errors, part.covariance, readings));
            }
            if let Some(last) = terms.last_mut() {
                last.ends_place();
            }
        }
        terms
    }

    #[inline(never)]
    fn parts(&self, errors: &Errors) -> Vec<Part, B> {
        let (lines, extent) = (self.lines(errors), self.extent_m());
        let mut parts = Vec::new();
        let mut compared = Vec::<Compared<'_>, B>::new();
        for (entry, first) in self.entries().iter().zip(0..) {
            let covariance = errors.own_variance(entry);
            let _ = parts.push(Part { covariance, first });
            let _ = compared.push(self.compared(entry, errors, extent));
        }
        for (i, a) in compared.iter().enumerate() {
            let Some((part, others)) = parts.get_mut(i..).and_then(<[_]>::split_first_mut) else {
                break;
            };
            for (b, other) in compared.iter().skip(i + 1).zip(others) {
                let pair = lines.pair(a, b);
                part.covariance += b.entry.probability * pair.covariance;
                other.covariance += a.entry.probability * pair.covariance;
                if pair.is_of_one_place && usize::from(other.first) > i {
                    other.first = part.first;
                }
            }
        }
        parts
    }

    #[inline(never)]
    fn compared<'a>(&self, entry: &'a Entry, errors: &Errors, extent_m: f32) -> Compared<'a> {
        Compared {
            entry,
            angle: entry.angle(self.source),
            length_m: self.length_m(entry.position(), errors, extent_m),
        }
    }

    /// What an entry says, be it that in the buffer at some index or none of them.
    #[inline(never)]
    pub(super) fn term_of(&self, entry: &Entry, errors: &Errors, index: Option<usize>) -> Term<D> {
        let lines = self.lines(errors);
        let extent = self.extent_m();
        let one = self.compared(entry, errors, extent);
        let (mut covariance, mut readings) = (errors.own_variance(entry), entry.weight());
        for (i, other) in self.entries().iter().enumerate() {
            if index != Some(i) {
                let pair = lines.pair(&one, &self.compared(other, errors, extent));
                covariance += other.probability * pair.covariance;
                readings += if pair.is_of_one_place {
                    other.weight()
                } else {
                    0.0
                };
            }
        }
        self.term(entry, errors, covariance, readings)
    }

    /// What a bearing says that is not in the buffer, on its own.
    pub(super) fn new_term(&self, observation: &Observation, errors: &Errors) -> Term<D> {
        let entry = Entry::new(*observation, 1.0);
        self.term(&entry, errors, errors.own_variance(&entry), 1.0)
    }

    /// What an entry says, of which the covariances with all entries have this sum, in square stated sigmas, beside others
    /// of its place: so many readings in all.
    #[inline(never)]
    fn term(&self, entry: &Entry, errors: &Errors, covariance: f32, readings: f32) -> Term<D> {
        // Of alternatives some may have been forgotten.
        let readings = if readings > entry.readings {
            readings
        } else {
            entry.readings
        };
        let own = errors.own_variance(entry);
        // As it is at the scale that is thought to be.
        let scale = errors.sigma_scale / self.scaled(errors).sigma_scale;
        let place = errors.variance_of_place(&entry.observation, self.source) / entry.worth;
        let place = scale * scale * place;
        let variance = errors.sigma_scale * errors.sigma_scale * own + place;
        let (features, known) =
            (self.known).features(&entry.observation, errors.biases(), self.source);
        let rates = self.rates(entry.observation.station(), errors);
        Term::new(&entry.observation, &rates, variance)
            .with_biases(features, known)
            .with_probability(entry.weight() / readings)
            .with_worth(own / covariance)
    }

    /// Over how many metres the correlation of errors falls, of bearings from a place, of which the places have an extent.
    pub(super) fn length_m(&self, from: [f32; 2], errors: &Errors, extent_m: f32) -> f32 {
        let range = match self.source {
            Some(source) => sqrt(square_of_distance(source, from)),
            None => extent_m,
        };
        errors.correlation.length_m(range)
    }

    /// The entry of the place that says what a new bearing says, if there is one.
    #[inline(never)]
    pub(super) fn entry_to_join(&self, new: &Entry, errors: &Errors) -> Option<usize> {
        if !errors.are_correlated() {
            return None;
        }
        let lines = self.lines(errors);
        let extent = self.extent_m();
        let one = self.compared(new, errors, extent);
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, old) in self.entries().iter().enumerate() {
            let other = self.compared(old, errors, extent);
            let pair = lines.pair(&one, &other);
            let turn = lines.fold(old, new, wrap(one.angle - other.angle)).abs();
            if pair.is_of_one_place && pair.covariance > 0.0 && turn < least {
                least = turn;
                best = Some(i);
            }
        }
        best
    }

    /// How far apart the places of the bearings are.
    pub(super) fn extent_m(&self) -> f32 {
        2.0 * self.bounds().1
    }

    /// The middle of the box round the places of the bearings, and half of its diagonal.
    #[inline(never)]
    pub(super) fn bounds(&self) -> ([f32; 2], f32) {
        let mut low = [f32::INFINITY; 2];
        let mut high = [f32::NEG_INFINITY; 2];
        for entry in self.entries() {
            for ((low, high), x) in low.iter_mut().zip(&mut high).zip(entry.position()) {
                *low = if x < *low { x } else { *low };
                *high = if x > *high { x } else { *high };
            }
        }
        if low[0] > high[0] {
            return ([0.0; 2], 0.0);
        }
        let centre = [0, 1].map(|d| 0.5 * (low[d] + high[d]));
        (centre, sqrt(square_of_distance(low, centre)))
    }
}

impl Lines {
    /// How two entries compare.
    #[inline(never)]
    fn pair(&self, a: &Compared<'_>, b: &Compared<'_>) -> Pair {
        /// Lengths after which nothing is left that would matter.
        const FAR: f32 = 4.0;
        let (one, other, length) = (a.entry, b.entry, a.length_m);
        let square = square_of_distance(one.position(), other.position());
        if square > FAR * FAR * length * length || !one.is_of_station_of(other) {
            return Pair::APART;
        }
        if !self.errors.are_correlated() {
            return Pair {
                covariance: 0.0,
                is_of_one_place: one.excludes(other),
            };
        }
        let time = one.seconds_from(other) / self.errors.correlation.time_s;
        let covariance = (self.errors).covariance([one, other], sqrt(square) / length, time);
        let turn = self.fold(one, other, wrap(b.angle - a.angle));
        let is_similar = self.is_within([one, other], turn, covariance);
        Pair {
            covariance: if is_similar { covariance } else { 0.0 },
            is_of_one_place: square < SAME_PLACE * SAME_PLACE * length * length,
        }
    }
}
