//! The bearings that a locator rests on, of which some are wrong.

use heapless::Vec;

use super::biases::Known;
use super::config::Config;
use super::density::{Density, Region, Space};
use super::errors::{Correlation, Errors};
use super::mode::{MODES, Mode, Modes, best, plane, position};
use super::shared::Shared;
use super::term::{PLAIN, State, Term, Width, fold_angle};
use crate::aoa::core::{Buffer, Comparison, Crossing, Entry, square_of_distance};
use crate::aoa::{Mixture, NotObservable, Observation};
use crate::math::{larger, smaller, sqrt};
use crate::persist;

/// Gain of the best mode over infinity from which on particles are started, whose cloud then says how far away the source may
/// be: less starts them in vain, more withholds fixes that are narrow enough.
const ENOUGH: f32 = 0.5;

/// Bearings from which on it is a contradiction if most of them do not fit: of fewer, most cross somewhere by chance.
const MANY: usize = 8;

/// All bits of an empty one are zero.
#[derive(Debug, Clone)]
pub(super) struct Evidence<const B: usize, const D: usize> {
    pub(super) bearings: Buffer<B>,
    pub(super) known: Known<D>,
    /// Centre of the prior, if it has a range of its own.
    centre: [f32; 2],
    /// That range; zero where there is none.
    range_m: f32,
    /// Where the source was when the particles last moved; before the first fix, the best hypothesis.
    pub(super) source: Option<[f32; 2]>,
    /// The scale of the errors then, as a multiple of what was expected. Known with the source.
    scale: f32,
    /// Rates of direct, mirrored and outlier bearings of each station, where they are learned; otherwise zero.
    station_rates: [[f32; 3]; D],
    /// What the bearings of other sources say.
    pub(super) shared: Shared,
}

persist!(impl[const B: usize, const D: usize] Evidence<B, D> as "robust::Evidence"(B, D) {
    bearings, known, centre, range_m, source, scale, station_rates, shared
});

/// What a new bearing changed.
pub(super) struct Change<const D: usize> {
    /// What it says.
    pub(super) new: Term<D>,
    /// What no longer is said, if it has been joined with a former one.
    pub(super) old: Option<Term<D>>,
    /// It has no alternative that is more likely.
    pub(super) likely: bool,
}

/// What bearings say, in the order of the entries.
pub(super) type Terms<const D: usize, const B: usize> = Vec<Term<D>, B>;

impl<const B: usize, const D: usize> Evidence<B, D> {
    pub(super) const EMPTY: Self = Self {
        bearings: Buffer::EMPTY,
        known: Known::NOTHING,
        centre: [0.0; 2],
        range_m: 0.0,
        source: None,
        scale: 0.0,
        station_rates: [[0.0; 3]; D],
        shared: Shared::NOTHING,
    };

    /// Forgets everything but what is known of biases and stations.
    pub(super) fn clear(&mut self) {
        self.bearings.clear();
        (self.centre, self.range_m) = ([0.0; 2], 0.0);
        self.source = None;
    }

    pub(super) fn entries(&self) -> &[Entry] {
        self.bearings.entries()
    }

    /// The prior is about here, and flat within the range.
    pub(super) fn centre_on(&mut self, centre: [f32; 2], range_m: f32) {
        (self.centre, self.range_m) = (centre, range_m);
    }

    /// The source is thought to be here, and errors of this scale.
    pub(super) fn set_source(&mut self, state: &State<D>, scale_sigma: f32) {
        self.source = Some(position(state));
        self.scale = Width::new(scale_sigma, state).scale();
    }

    /// The scale of the errors that is thought to be, as a multiple of what was expected.
    pub(super) fn scale(&self) -> f32 {
        self.source.map_or(1.0, |_| self.scale)
    }

    /// The prior of the place: about the places of the bearings, and flat among them.
    #[inline(never)]
    pub(super) fn region(&self, config: &Config) -> Region {
        if self.range_m > 0.0 {
            return Region::new(self.centre, [self.range_m; 2]);
        }
        let (centre, half) = self.bounds();
        let Config {
            nearest_m, range_m, ..
        } = *config;
        let near = larger(half, nearest_m);
        Region::new(centre, [smaller(near, range_m), range_m])
    }

    pub(super) fn density<'a>(&self, terms: &'a [Term<D>], config: &Config) -> Density<'a, D> {
        Density {
            terms,
            space: Space::Plane(self.region(config)),
            scale_sigma: config.errors.scale_sigma,
            shared: self.shared,
        }
    }

    /// The rates of the bearings of a station.
    #[inline(never)]
    pub(super) fn rates(&self, station: u8, errors: &Errors) -> Mixture {
        match self.station_rates.get(usize::from(station)) {
            Some(&[direct, mirrored, outlier]) if outlier > 0.0 => Mixture {
                direct,
                mirrored,
                outlier,
            },
            _ => errors.rates,
        }
    }

    pub(super) const fn forget_station_rates(&mut self) {
        self.station_rates = [[0.0; 3]; D];
    }

    /// Learns the rates of each station, about those of all.
    #[inline(never)]
    pub(super) fn learn_station_rates(
        &mut self,
        density: &Density<'_, D>,
        modes: &Modes<D>,
        all: &Errors,
    ) {
        for (station, rates) in (0..).zip(&mut self.station_rates) {
            let mut counts = Mixture::ZERO;
            for mode in modes {
                density.count(&mode.mean, mode.weight, Some(station), &mut counts);
            }
            let learned = all.learned_rates(&counts);
            *rates = [learned.direct, learned.mirrored, learned.outlier];
        }
    }

    #[inline(never)]
    pub(super) fn lines(&self, errors: &Errors, of_several: bool) -> Lines {
        let errors = Errors {
            sigma_scale: self.scale() * errors.sigma_scale,
            ..*errors
        };
        Lines {
            source: self.source,
            extent_m: self.source.map_or_else(|| 2.0 * self.bounds().1, |_| 0.0),
            errors,
            of_several,
        }
    }

    /// Forgets the readings that the first of some modes explains best.
    pub(super) fn release(&mut self, modes: &[Mode<D>], errors: &Errors) {
        let source = self.source;
        let mut own = [false; B];
        for (own, entry) in own.iter_mut().zip(self.entries()) {
            *own = explains_reading(modes, entry, self.entries(), source, errors);
        }
        let mut own = own.into_iter();
        (self.bearings).retain(|_| own.next() != Some(true));
    }

    /// Takes a bearing, that of several sources or of one, which is thought to be where it was last [set](Self::set_source).
    #[inline(never)]
    pub(super) fn push(&mut self, new: Entry, errors: &Errors, of_several: bool) -> Change<D> {
        (self.bearings).note(&new.observation, new.weight());
        let likely = new.probability > 0.5;
        let lines = self.lines(errors, of_several);
        if let Some(place) = self.entry_to_join(&new, &lines)
            && let Some(before) = self.entries().get(place).copied()
        {
            let mut after = before;
            after.join(&new, &lines);
            if let Some(entry) = self.bearings.entries_mut().get_mut(place) {
                *entry = after;
            }
            let [new, old] = [after, before].map(|entry| self.term_of(&entry, errors, Some(place)));
            return Change {
                new,
                old: Some(old),
                likely,
            };
        }
        let term = self.term_of(&new, errors, None);
        self.bearings.add(new, &lines);
        Change {
            new: term,
            old: None,
            likely,
        }
    }

    /// Whether bearings make a fix by their best mode, under the same mixture as all else.
    #[inline(never)]
    pub(super) fn crossing(
        &self,
        terms: &[Term<D>],
        modes: &Modes<D>,
        config: &Config,
    ) -> Result<(), NotObservable> {
        let density = self.density(terms, config);
        let mut crossing = Crossing {
            gain: 0.0,
            information: terms.iter().map(Term::precision).sum(),
            limit: config.relative_range_sigma,
            enough: ENOUGH,
        };
        let best = best(modes).ok_or_else(|| crossing.reason())?;
        crossing.information = density.information(&best.mean);
        let far = self.best_at_infinity(&density);
        crossing.gain = 2.0 * (density.log_likelihood(&best.mean) - far);
        let variance = plane(&best.covariance.matrix()).largest_eigenvalue();
        let range = self.bearings.range_squared(position(&best.mean));
        crossing.check(variance, range).map_err(|reason| {
            let mut counts = Mixture::ZERO;
            density.count(&best.mean, 1.0, None, &mut counts);
            let outliers = counts.outlier / counts.total();
            if outliers > 0.5 && self.entries().len() >= MANY {
                NotObservable::Contradiction { outliers }
            } else {
                reason
            }
        })
    }

    /// The log-likelihood of a source at infinity, in the direction, with the scale and the biases that fit best.
    #[inline(never)]
    fn best_at_infinity(&self, density: &Density<'_, D>) -> f32 {
        /// Directions that are tried, those of some bearings, and steps of the climb from the best: more find the best
        /// direction more often, which keeps parallel bearings from making a fix.
        const STARTS: usize = 16;
        const STEPS: u32 = 6;
        let density = density.at_infinity();
        let (mut best, mut start) = (f32::NEG_INFINITY, [0.0; D]);
        let step = self.entries().len().div_ceil(STARTS).max(1);
        for observation in self.bearings.observations().step_by(step) {
            let mut state = [0.0; D];
            state[0] = observation.bearing().radians();
            let sum = density.log_likelihood(&state);
            if sum > best {
                (best, start) = (sum, state);
            }
        }
        match Mode::climb(&density, start, STEPS) {
            Some(mode) => density.log_likelihood(&mode.mean),
            None => best,
        }
    }
}

impl<const B: usize> Evidence<B, PLAIN> {
    /// Forgets its own bearings, and takes those of a candidate.
    pub(super) fn adopt(&mut self, candidate: &Candidate<'_>, errors: &Errors) {
        let (latest, mean) = (candidate.latest, candidate.mean());
        self.clear();
        self.shared = *candidate.shared;
        self.set_source(&mean, errors.scale_sigma);
        let lines = self.lines(errors, false);
        self.bearings.adopt(candidate.entries(), latest, &lines);
    }
}

/// Bearings that are likely to be one source's, and where it may be: what a track of it starts from.
#[derive(Debug, Clone)]
pub struct Candidate<'a> {
    pub(super) entries: &'a [Entry],
    pub(super) latest: Option<&'a Observation>,
    /// What the range of errors of places is counted by.
    pub(super) source: Option<[f32; 2]>,
    pub(super) modes: &'a Modes<PLAIN>,
    /// The modes that are sources, first that of this one.
    pub(super) found: Vec<Mode<PLAIN>, MODES>,
    pub(super) errors: &'a Errors,
    pub(super) shared: &'a Shared,
}

impl Candidate<'_> {
    /// The bearings, some of which may stand for several.
    pub fn observations(&self) -> impl Iterator<Item = &Observation> {
        self.entries().map(|entry| &entry.observation)
    }

    /// How many readings these stand for.
    pub(in crate::aoa) fn readings(&self) -> f32 {
        self.entries().map(Entry::weight).sum()
    }

    /// Where the source may be.
    pub(in crate::aoa) fn position(&self) -> [f32; 2] {
        position(&self.mean())
    }

    pub(super) fn mean(&self) -> State<PLAIN> {
        self.found.first().map_or([0.0; PLAIN], |mode| mode.mean)
    }

    /// The latest bearing by time, whatever source it is of.
    pub(in crate::aoa) fn latest(&self) -> Option<&Observation> {
        self.latest
    }

    /// The bearings as they stand in the buffer.
    pub(in crate::aoa) fn entries(&self) -> impl Iterator<Item = &Entry> + Clone {
        let explained = |entry: &&Entry| {
            explains_reading(&self.found, entry, self.entries, self.source, self.errors)
        };
        self.entries.iter().filter(explained)
    }
}

/// Whether the first of some modes explains a bearing best, or one that the bearing excludes.
#[inline(never)]
fn explains_reading<const D: usize>(
    modes: &[Mode<D>],
    entry: &Entry,
    all: &[Entry],
    source: Option<[f32; 2]>,
    errors: &Errors,
) -> bool {
    let is_own = |entry: &Entry| explains(modes, entry, source, errors);
    let mut excluded = all.iter().filter(|other| other.excludes_last(entry));
    is_own(entry) || excluded.any(is_own)
}

/// Whether a bearing is likelier direct or mirrored of a source at the first of some modes than an outlier, or of a source at
/// another one.
fn explains<const D: usize>(
    modes: &[Mode<D>],
    entry: &Entry,
    source: Option<[f32; 2]>,
    errors: &Errors,
) -> bool {
    let variance = errors.sigma_scale * errors.sigma_scale * errors.own_variance(entry);
    let variance = variance + errors.variance_of_place(&entry.observation, source);
    let features = (errors.biases).features(&entry.observation, errors.bias_sigma_rad, source);
    let term = Term::new(&entry.observation, &errors.rates, variance)
        .with_biases(features, 0.0)
        .with_probability(entry.probability);
    let mut odds = modes.iter().map(|mode| {
        let width = Width::new(errors.scale_sigma, &mode.mean);
        term.read(&term.line(&mode.mean), &width).odds
    });
    let own = odds.next().unwrap_or(0.0);
    own > 1.0 && odds.all(|other| other <= own)
}

/// Bearings that may be mirrored or outliers: they are compared as lines.
pub(super) struct Lines {
    pub(super) source: Option<[f32; 2]>,
    /// How far apart the places of the bearings are, as long as there is no source.
    pub(super) extent_m: f32,
    /// With the scale that is thought to be.
    pub(super) errors: Errors,
    /// They may be of several sources.
    pub(super) of_several: bool,
}

impl Lines {
    /// Over how many metres the correlation of a bearing's error falls.
    #[inline(never)]
    pub(super) fn length_m(&self, entry: &Entry) -> f32 {
        let range = match self.source {
            Some(source) => sqrt(square_of_distance(source, entry.position())),
            None => self.extent_m,
        };
        self.errors.correlation.length_m(range)
    }

    /// Whether an angle between two bearings is within three sigmas of their difference, if their errors have this
    /// covariance in square stated sigmas.
    pub(super) fn is_within(&self, pair: [&Entry; 2], turn: f32, covariance: f32) -> bool {
        let errors = &self.errors;
        let [a, b] = pair.map(|entry| errors.variance(&entry.observation, self.source));
        let scale = errors.sigma_scale * errors.sigma_scale;
        turn * turn < 9.0 * (a + b - 2.0 * scale * covariance)
    }
}

impl Comparison for Lines {
    fn source(&self) -> Option<[f32; 2]> {
        self.source
    }

    /// Once it is known where the source is, a mirrored bearing says what a direct one does: they are lines. But the
    /// bearings of two sources may be opposite, and of those that have alternatives many point elsewhere, half of them behind.
    fn fold(&self, a: &Entry, b: &Entry, angle: f32) -> f32 {
        let one_each = !a.is_one_of_several() && !b.is_one_of_several();
        if self.source.is_none() || self.of_several || !one_each {
            angle
        } else {
            fold_angle(angle)
        }
    }

    fn are_of_one_place(&self, a: &Entry, b: &Entry) -> bool {
        let apart = square_of_distance(a.position(), b.position());
        self.errors.are_correlated() && Correlation::is_one_place(apart, self.length_m(a))
    }

    fn is_similar(&self, a: &Entry, b: &Entry) -> bool {
        self.is_within([a, b], a.turn(b, self), 0.0)
    }

    /// Of several sources, the readings beyond the first: one alone may well be an outlier.
    fn stake(&self, a: &Entry, b: &Entry) -> f32 {
        if !self.of_several {
            return 0.0;
        }
        let (more, less) = if a.readings > b.readings {
            (a.readings, b.readings)
        } else {
            (b.readings, a.readings)
        };
        (less - 1.0) / more
    }

    /// The likelier one. Of several sources, that with more readings; as long as nothing is known of a single one, the sharper
    /// one.
    fn prefers(&self, a: &Entry, b: &Entry) -> bool {
        if self.of_several {
            return a.readings >= b.readings;
        }
        let doubt = |entry: &Entry| match self.source {
            Some([x, y]) => {
                let variance = self.errors.variance(&entry.observation, self.source);
                let term = Term::<PLAIN>::new(&entry.observation, &self.errors.rates, variance);
                -term
                    .with_probability(entry.probability)
                    .log_likelihood(&[x, y, 0.0, 0.0])
            }
            None => entry.observation.sigma_rad(),
        };
        doubt(a) <= doubt(b)
    }
}
