//! The bearings that a locator rests on, of which some are wrong.

use heapless::Vec;

use super::config::Config;
use super::density::{Density, Region};
use super::errors::{Counts, Errors};
use super::mode::{Mode, Modes, best, dot, plane, position};
use super::term::{State, Term, fold_angle};
use crate::aoa::core::{Buffer, Comparison, Crossing, Entry, square_of_distance};
use crate::aoa::{Alternative, NotObservable, Observation};
use crate::math::{ln, sqrt, wrap};
use crate::persist;

/// All bits of an empty one are zero.
#[derive(Debug, Clone)]
pub(super) struct Evidence<const B: usize> {
    pub(super) bearings: Buffer<B>,
    /// Centre of the prior.
    centre: [f32; 2],
    /// Its range; zero for that of the configuration.
    range_m: f32,
    /// Where the source was when the particles last moved; before the first fix, the best hypothesis.
    pub(super) source: Option<[f32; 2]>,
}

persist!(impl[const B: usize] Evidence<B> as "robust::Evidence"(B) {
    bearings, centre, range_m, source
});

/// What a new bearing changed.
pub(super) struct Change {
    /// What it says.
    pub(super) new: Term,
    /// What no longer is said, if it has been joined with a former one.
    pub(super) old: Option<Term>,
    /// It has no alternative that is more likely.
    pub(super) likely: bool,
}

/// What bearings say, in the order of the entries.
pub(super) type Terms<const B: usize> = Vec<Term, B>;

impl<const B: usize> Evidence<B> {
    pub(super) const EMPTY: Self = Self {
        bearings: Buffer::EMPTY,
        centre: [0.0; 2],
        range_m: 0.0,
        source: None,
    };

    pub(super) fn clear(&mut self) {
        self.bearings.clear();
        (self.centre, self.range_m) = ([0.0; 2], 0.0);
        self.source = None;
    }

    pub(super) fn entries(&self) -> &[Entry] {
        self.bearings.entries()
    }

    /// The prior is about here.
    pub(super) fn centre_on(&mut self, centre: [f32; 2], range_m: f32) {
        (self.centre, self.range_m) = (centre, range_m);
    }

    /// Errors of places count by the range of the source, which is here.
    pub(super) fn set_source(&mut self, &[x, y, _]: &State) {
        self.source = Some([x, y]);
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

    /// What the bearings say. Made when it is needed, because it takes as much memory as they do.
    #[inline(never)]
    pub(super) fn terms(&self, errors: &Errors) -> Terms<B> {
        let mut terms = Vec::new();
        for entry in self.entries() {
            let _ = terms.push(self.term(entry, errors));
        }
        terms
    }

    pub(super) fn density<'a>(&self, terms: &'a [Term], config: &Config) -> Density<'a> {
        Density {
            terms,
            region: self.region(config),
            bias_sigma_rad: config.errors.bias_sigma_rad,
        }
    }

    /// Variance of the error of a bearing, with that of its place.
    pub(super) fn variance(&self, entry: &Entry, errors: &Errors) -> f32 {
        errors.variance(&entry.observation, entry.worth, self.source)
    }

    /// What a bearing says, be it in the buffer or not.
    pub(super) fn term(&self, entry: &Entry, errors: &Errors) -> Term {
        Term::of(entry, errors, self.source)
    }

    /// What the bearings are if the source is about one of some modes, for which they have these `terms`.
    #[inline(never)]
    pub(super) fn counts(&self, terms: &[Term], modes: &Modes, errors: &Errors) -> Counts {
        let mut counts = Counts::NONE;
        for mode in modes {
            let bias = errors.bias_sigma_rad * mode.mean[2];
            let covariance = mode.covariance.matrix();
            for (term, entry) in terms.iter().zip(self.entries()) {
                let reading = term.read(&mode.mean, bias);
                let fitted = reading.count(&mut counts.kinds, mode.weight);
                // The portions of bearings that exclude each other sum to one, whichever fits.
                counts.kinds.outlier -= mode.weight * (1.0 - entry.probability);
                if !errors.learns_scale() {
                    continue;
                }
                let worth = if entry.worth < 1.0 { entry.worth } else { 1.0 };
                let [x, y] = term.gradient(&mode.mean);
                let gradient = [x, y, errors.bias_sigma_rad];
                let spread = dot(&gradient, &covariance.map(|row| dot(&row, &gradient)));
                let square = reading.error * reading.error + spread;
                // In the mean, what of the error is that of the place is not the bearing's own.
                let total = self.variance(entry, errors);
                let own = errors.own_variance(&entry.observation) / total;
                let scale = errors.sigma_scale * errors.sigma_scale;
                let expected = scale * (own * square / (worth * total) + 1.0 - own);
                counts.bearings += fitted * worth;
                counts.squares += fitted * worth * expected;
            }
        }
        // The alternative of a bearing that fits may have been forgotten.
        if counts.kinds.outlier < 0.0 {
            counts.kinds.outlier = 0.0;
        }
        counts
    }

    /// Forgets its own bearings, and takes those of a candidate.
    pub(super) fn adopt(&mut self, candidate: &Candidate<'_>, errors: &Errors) {
        let (latest, mean) = (candidate.latest, candidate.mode.mean);
        self.clear();
        self.centre = latest.map_or([0.0; 2], Observation::position);
        self.set_source(&mean);
        let lines = Lines {
            source: Some(mean),
            errors,
        };
        self.bearings.adopt(candidate.entries(), latest, &lines);
    }

    /// Forgets the bearings that a mode explains.
    pub(super) fn release(&mut self, mode: &Mode, errors: &Errors) {
        let source = self.source;
        self.bearings
            .retain(|entry| !explains(mode, entry, source, errors));
    }

    /// Takes a bearing. `source` is where the source is thought to be, if anywhere.
    pub(super) fn push(
        &mut self,
        bearing: &Alternative,
        source: Option<State>,
        errors: &Errors,
    ) -> Change {
        let (observation, probability) = (*bearing.observation(), bearing.probability());
        if self.bearings.entries().is_empty() && self.range_m == 0.0 {
            self.centre = observation.position();
        }
        self.bearings.note(&observation, probability);
        let likely = probability > 0.5;
        let mut new = Entry::new(observation, probability);
        let lines = Lines { source, errors };
        let correlation = errors.correlation;
        if correlation.at_rest > 0.0
            && let Some((place, distance)) = self.nearest_similar(&new, &lines)
            && let Some(entry) = self.bearings.entries_mut().get_mut(place)
        {
            let seconds = entry.seconds_from(observation.time_ms());
            let worth = correlation.worth(correlation.lengths(distance, seconds));
            if distance < 0.25 * correlation.distance_m {
                let before = *entry;
                entry.join(&new, worth, &lines);
                let after = *entry;
                return Change {
                    new: self.term(&after, errors),
                    old: Some(self.term(&before, errors)),
                    likely,
                };
            }
            new.observation = tempered(observation, worth);
            new.worth = worth;
        }
        self.bearings.add(new, &lines);
        Change {
            new: self.term(&new, errors),
            old: None,
            likely,
        }
    }

    /// The nearest bearing of the station that says the same, and how far away it was taken, in metres.
    fn nearest_similar(&self, new: &Entry, lines: &Lines<'_>) -> Option<(usize, f32)> {
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, old) in self.entries().iter().enumerate() {
            let square = square_of_distance(old.position(), new.position());
            if square < least && old.is_of_station_of(new) && lines.is_similar(old, new) {
                least = square;
                best = Some(i);
            }
        }
        best.map(|i| (i, sqrt(least)))
    }

    /// Whether bearings make a fix by their best mode, under the same mixture as all else.
    #[inline(never)]
    pub(super) fn crossing(
        &self,
        terms: &[Term],
        modes: &Modes,
        config: &Config,
    ) -> Result<(), NotObservable> {
        let (at_infinity, information) = self.at_infinity(terms, &config.errors);
        let mut crossing = Crossing {
            gain: 0.0,
            information,
            limit: config.relative_range_sigma,
        };
        let best = best(modes).ok_or_else(|| crossing.reason())?;
        let density = self.density(terms, config);
        crossing.gain = 2.0 * (density.log_density(&best.mean) - at_infinity);
        let variance = plane(&best.covariance.matrix()).largest_eigenvalue();
        let range = self.bearings.range_squared(position(&best.mean));
        crossing.check(variance, range)
    }

    /// The log-likelihood of a source at infinity, in the direction that fits best; and the sum of 1 / sigma^2.
    #[inline(never)]
    fn at_infinity(&self, terms: &[Term], errors: &Errors) -> (f32, f32) {
        /// Directions that are tried, those of some bearings, and means of those that fit: more find the best direction
        /// more often, which keeps parallel bearings from making a fix.
        const STARTS: usize = 16;
        const MEANS: u32 = 4;
        let density = |direction: f32| {
            let (mut sum, mut pull, mut total) = (0.0, 0.0, 1e-9);
            for (o, term) in self.bearings.observations().zip(terms) {
                let reading = term.read_far(o.bearing().radians(), direction);
                sum += ln(1.0 + reading.odds);
                pull += reading.information * reading.error;
                total += reading.information;
            }
            (sum, wrap(direction - pull / total))
        };
        let (mut best, mut next) = (f32::NEG_INFINITY, 0.0);
        let step = self.entries().len().div_ceil(STARTS).max(1);
        for o in self.bearings.observations().step_by(step) {
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
        let information =
            |entry: &Entry| entry.probability / errors.own_variance(&entry.observation);
        (best, self.entries().iter().map(information).sum())
    }
}

/// Bearings that are likely to be one source's, and where it may be: what a track of it starts from.
#[derive(Debug, Clone, Copy)]
pub struct Candidate<'a> {
    pub(super) entries: &'a [Entry],
    pub(super) latest: Option<&'a Observation>,
    /// What the range of errors of places is counted by.
    pub(super) source: Option<[f32; 2]>,
    pub(super) mode: &'a Mode,
    pub(super) modes: &'a Modes,
    pub(super) errors: &'a Errors,
}

impl Candidate<'_> {
    /// The bearings, some of which may stand for several.
    pub fn observations(&self) -> impl Iterator<Item = &Observation> {
        self.entries().map(|entry| &entry.observation)
    }

    /// Where the source may be.
    pub(in crate::aoa) fn position(&self) -> [f32; 2] {
        let [x, y, _] = self.mode.mean;
        [x, y]
    }

    /// The latest bearing by time, whatever source it is of.
    pub(in crate::aoa) fn latest(&self) -> Option<&Observation> {
        self.latest
    }

    /// The bearings as they stand in the buffer.
    pub(in crate::aoa) fn entries(&self) -> impl Iterator<Item = &Entry> {
        let explained = |entry: &&Entry| explains(self.mode, entry, self.source, self.errors);
        self.entries.iter().filter(explained)
    }
}

/// Whether a bearing is likelier direct or mirrored than an outlier if the source is at a mode.
fn explains(mode: &Mode, entry: &Entry, source: Option<[f32; 2]>, errors: &Errors) -> bool {
    Term::of(entry, errors, source)
        .read(&mode.mean, errors.bias_sigma_rad * mode.mean[2])
        .odds
        > 1.0
}

/// Bearings that may be mirrored or outliers: they are compared as lines.
pub(super) struct Lines<'a> {
    pub(super) source: Option<State>,
    pub(super) errors: &'a Errors,
}

impl Comparison for Lines<'_> {
    fn source(&self) -> Option<[f32; 2]> {
        self.source.map(|[x, y, _]| [x, y])
    }

    /// Once it is known where the source is, a mirrored bearing says what a direct one does: they are lines. But of
    /// bearings that have alternatives many point elsewhere, and half of those behind.
    fn fold(&self, a: &Entry, b: &Entry, angle: f32) -> f32 {
        if self.source.is_none() || a.is_one_of_several() || b.is_one_of_several() {
            angle
        } else {
            fold_angle(angle)
        }
    }

    /// Within three sigmas of their difference.
    fn is_similar(&self, a: &Entry, b: &Entry) -> bool {
        let turn = a.turn(b, self);
        let variance =
            |entry: &Entry| (self.errors).variance(&entry.observation, 1.0, self.source());
        turn * turn < 9.0 * (variance(a) + variance(b))
    }

    /// The likelier one; as long as nothing is known of the source, the sharper one.
    fn prefers(&self, a: &Entry, b: &Entry) -> bool {
        let doubt = |entry: &Entry| match &self.source {
            Some(state) => {
                let term = Term::of(entry, self.errors, self.source());
                -term.log_likelihood(state, self.errors.bias_sigma_rad * state[2])
            }
            None => entry.observation.sigma_rad(),
        };
        doubt(a) <= doubt(b)
    }
}

/// A bearing that counts for `worth` of its information.
pub(super) fn tempered(observation: Observation, worth: f32) -> Observation {
    let sigma = observation.sigma_rad() / sqrt(worth);
    let most = Observation::MAX_SIGMA_RAD;
    observation.with_sigma(if sigma < most { sigma } else { most })
}
