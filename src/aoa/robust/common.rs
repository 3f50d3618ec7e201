//! What bearings have in common with each other: errors, and places.

use heapless::Vec;

use super::errors::{Correlation, Errors};
use super::evidence::{Evidence, Lines, Terms};
use super::term::Term;
use crate::aoa::Observation;
use crate::aoa::core::{Entry, square_of_distance};
use crate::math::{larger, smaller, sqrt};

/// What an entry has in common with all that are in the buffer.
#[derive(Clone, Copy)]
struct InCommon {
    /// Sum of the covariances of its error with theirs, in square stated sigmas.
    covariance: f32,
    /// The first entry of the same place.
    first: u16,
}

/// How two entries compare.
struct Pair {
    /// Zero where they do not say the same.
    covariance: f32,
    /// The angle from the one to the other.
    turn: f32,
    is_of_one_place: bool,
}

impl<const B: usize, const D: usize> Evidence<B, D> {
    /// What the bearings say, those of one place after each other. Made when it is needed, because it takes as much memory
    /// as they do.
    ///
    /// Bearings that have an error in common count together for as much as they tell if each counts for its own part of the
    /// sum of its covariances: n that have all of it in common for one, and those of an autoregression for what one more
    /// tells on its own. Those of one place that do not say the same exclude each other: not more than one of them points at the
    /// source, whatever the scale of the errors is.
    pub(super) fn terms(&self, errors: &Errors) -> Terms<D, B> {
        self.terms_of(errors, false)
    }

    /// The same, if those of one place may be of several sources.
    pub(super) fn terms_of_several(&self, errors: &Errors) -> Terms<D, B> {
        self.terms_of(errors, true)
    }

    #[inline(never)]
    fn terms_of(&self, errors: &Errors, several: bool) -> Terms<D, B> {
        let all = self.in_common(errors, several);
        let mut terms = Terms::new();
        for (i, one) in all.iter().enumerate() {
            if usize::from(one.first) != i {
                continue;
            }
            let of_place = || {
                let rest = self.entries().iter().zip(&all).skip(i);
                rest.filter(|(_, other)| usize::from(other.first) == i)
            };
            let weights = of_place().map(|(entry, _)| entry.weight());
            let readings = if several { 0.0 } else { weights.sum() };
            let counts = of_place().map(|(entry, _)| entry.readings);
            let most = counts.fold(0.0, |a: f32, b| larger(b, a));
            for (entry, other) in of_place() {
                let term = self.term(entry, errors, other.covariance, readings);
                let _ = terms.push(term.with_fraction(entry.readings / most));
            }
            if let Some(last) = terms.last_mut() {
                last.ends_place();
            }
        }
        terms
    }

    #[inline(never)]
    fn in_common(&self, errors: &Errors, of_several: bool) -> Vec<InCommon, B> {
        let lines = self.lines(errors, of_several);
        let mut all = Vec::new();
        for (entry, first) in self.entries().iter().zip(0..) {
            let covariance = errors.own_variance(entry);
            let _ = all.push(InCommon { covariance, first });
        }
        for (i, a) in self.entries().iter().enumerate() {
            let Some((one, others)) = all.get_mut(i..).and_then(<[_]>::split_first_mut) else {
                break;
            };
            let length_m = lines.length_m(a);
            for (b, other) in self.entries().iter().skip(i + 1).zip(others) {
                let Some(pair) = lines.pair([a, b], length_m) else {
                    continue;
                };
                one.covariance += b.probability * pair.covariance;
                other.covariance += a.probability * pair.covariance;
                if pair.is_of_one_place && usize::from(other.first) > i {
                    other.first = one.first;
                }
            }
        }
        all
    }

    /// What an entry says, be it that in the buffer at some index or none of them.
    #[inline(never)]
    pub(super) fn term_of(&self, entry: &Entry, errors: &Errors, index: Option<usize>) -> Term<D> {
        let (mut covariance, mut readings) = (errors.own_variance(entry), entry.weight());
        for (i, other, pair) in self.near(entry, &self.lines(errors, false)) {
            if index != Some(i) {
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
        let readings = larger(readings, entry.readings);
        let own = errors.own_variance(entry);
        // As it is at the scale that is thought to be.
        let place = errors.variance_of_place(&entry.observation, self.source) / entry.worth;
        let scale = 1.0 / self.scale();
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

    /// The entry of the place that says what a new bearing says, if there is one.
    #[inline(never)]
    pub(super) fn entry_to_join(&self, new: &Entry, lines: &Lines) -> Option<usize> {
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, _, pair) in self.near(new, lines) {
            let turn = pair.turn.abs();
            if pair.is_of_one_place && pair.covariance > 0.0 && turn < least {
                least = turn;
                best = Some(i);
            }
        }
        best
    }

    /// The entries that may have something in common with one, and where they are.
    fn near<'a>(
        &'a self,
        one: &'a Entry,
        lines: &'a Lines,
    ) -> impl Iterator<Item = (usize, &'a Entry, Pair)> {
        let length_m = lines.length_m(one);
        let all = self.entries().iter().enumerate();
        all.filter_map(move |(i, other)| Some((i, other, lines.pair([one, other], length_m)?)))
    }

    /// The middle of the box round the places of the bearings, and half of its diagonal.
    #[inline(never)]
    pub(super) fn bounds(&self) -> ([f32; 2], f32) {
        let mut low = [f32::INFINITY; 2];
        let mut high = [f32::NEG_INFINITY; 2];
        for entry in self.entries() {
            for ((low, high), x) in low.iter_mut().zip(&mut high).zip(entry.position()) {
                *low = smaller(x, *low);
                *high = larger(x, *high);
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
    /// How two entries compare, if they are near enough to have something in common; the correlation of the first one's error
    /// falls over a length.
    #[inline(never)]
    fn pair(&self, [a, b]: [&Entry; 2], length_m: f32) -> Option<Pair> {
        /// Lengths after which nothing is left that would matter.
        const FAR: f32 = 4.0;
        let square = square_of_distance(a.position(), b.position());
        if square > FAR * FAR * length_m * length_m || !a.is_of_station_of(b) {
            return None;
        }
        let turn = a.turn(b, self);
        if !self.errors.are_correlated() {
            return Some(Pair {
                covariance: 0.0,
                turn,
                is_of_one_place: a.excludes(b),
            });
        }
        let time = a.seconds_from(b) / self.errors.correlation.time_s;
        let covariance = (self.errors).covariance([a, b], sqrt(square) / length_m, time);
        // Readings of one of several sources stay together even if they have less in common than is believed: each
        // apart, they fill the buffer, and none is worth enough to find the source.
        let believed = if self.of_several { 0.0 } else { covariance };
        let is_similar = self.is_within([a, b], turn, believed);
        Some(Pair {
            covariance: if is_similar { covariance } else { 0.0 },
            turn,
            is_of_one_place: Correlation::is_one_place(square, length_m),
        })
    }
}
