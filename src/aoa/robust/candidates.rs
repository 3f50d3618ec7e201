//! Unassigned bearings, and the sources that may be found among them.

use super::config::Config;
use super::errors::Errors;
use super::evidence::{Candidate, Evidence};
use super::joint::Joint;
use super::mode::{MODES, Mode, Modes, best, hypotheses, plane, position};
use super::search::search;
use super::shared::Shared;
use super::term::{PLAIN, Term, Width, without_scale};
use crate::aoa::core::{Entry, is_narrow};
use crate::aoa::track::{OffBy, odds_by_moments, off_by_moments};
use crate::aoa::words::Belief;
use crate::aoa::{
    Advice, Alternative, Answer, Hypothesis, NotObservable, Observation, PushError, Retract,
    Retracted,
};
use crate::math::{exp, ln};
use crate::persist;
use crate::random::Rng;

/// The unassigned bearings, and the modes of their posterior.
///
/// That is of one source and outliers, but each of its modes may be a source of its own: the bearings of all the others
/// are as good as outliers to it. All bits of an empty one are zero.
#[derive(Debug, Clone)]
pub(in crate::aoa) struct Candidates<const B: usize> {
    evidence: Evidence<B, PLAIN>,
    /// Those that are likely to be sources come first.
    modes: Modes<PLAIN>,
    /// How many these are.
    found: u32,
    /// Logarithms of the Bayes factors of the modes, each beside those that are likely to be sources.
    gains: [f32; MODES],
}

persist!(impl[const B: usize] Candidates<B> as "Candidates"(B) { evidence, modes, found, gains });

impl<const B: usize> Candidates<B> {
    pub(in crate::aoa) const EMPTY: Self = Self {
        evidence: Evidence::EMPTY,
        modes: Modes::new(),
        found: 0,
        gains: [0.0; MODES],
    };

    pub(in crate::aoa) fn clear(&mut self) {
        self.evidence.clear();
        self.modes.clear();
        self.found = 0;
        self.evidence.shared = Shared::NOTHING;
    }

    /// Takes the bearings of a reading, and looks for modes beside the sources that are tracked, of which the bearings say this of the errors;
    /// and for those among them that alone would make a fix, and are as likely as `log_odds` says to be a source's beside the
    /// others.
    #[inline(never)]
    pub(in crate::aoa) fn push<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        shared: &Shared,
        log_odds: f32,
        config: &Config,
        rng: &mut R,
    ) -> Result<(), PushError> {
        let errors = &config.errors;
        let first = alternatives.first().ok_or(PushError::Empty)?;
        self.evidence.bearings.admit(first.observation())?;
        self.evidence.shared = *shared;
        for alternative in alternatives {
            self.evidence.push(alternative.into(), errors, true);
        }
        if self.evidence.entries().len() > 1 {
            let mut terms = self.evidence.terms_of_several(errors);
            self.modes = search(&self.evidence, &terms, config, &self.modes, rng);
            self.find(&mut terms, log_odds, config);
            if let Some(best) = best(&self.modes) {
                self.evidence.set_source(&best.mean, errors.scale_sigma);
            }
        }
        Ok(())
    }

    /// Takes bearings back. The modes are looked for again with the next bearing.
    pub(in crate::aoa) fn retract(&mut self, what: &Retract) -> Retracted {
        self.evidence.bearings.retract(what)
    }

    /// Finds the modes that are likely to be sources.
    #[inline(never)]
    fn find(&mut self, terms: &mut [Term<PLAIN>], log_odds: f32, config: &Config) {
        let mut joint = Joint::<B>::new(terms);
        let density = self.evidence.density(terms, config);
        let log_volume = self.evidence.region(config).log_volume();
        for (place, mode) in self.modes.iter().enumerate() {
            let range = (self.evidence.bearings).range_squared(position(&mode.mean));
            let variance = plane(&mode.covariance.matrix()).largest_eigenvalue();
            if is_narrow(variance, range, config.relative_range_sigma) {
                joint.add(place, &density, mode, log_volume, &config.errors.rates);
            }
        }
        let (found, gains) = joint.found(log_odds);
        self.found = found.iter().filter(|found| **found).count() as u32;
        // The likeliest first.
        let mut gains = gains.map(Some);
        let mut modes = Modes::new();
        while let Some((place, gain)) = take_largest(&mut gains) {
            if let Some(mode) = self.modes.get(place) {
                if let Some(sorted) = self.gains.get_mut(modes.len()) {
                    *sorted = gain;
                }
                let _ = modes.push(*mode);
            }
        }
        self.modes = modes;
    }

    /// The mode of this rank by the probability that it is a source.
    pub(in crate::aoa) fn ranked(&self, rank: usize) -> Option<Hypothesis> {
        let (mode, gain) = self.modes.iter().zip(&self.gains).nth(rank)?;
        Some(Hypothesis {
            position: position(&mode.mean),
            covariance: plane(&mode.covariance.matrix()),
            probability: probability(*gain),
        })
    }

    /// Logarithm of the Bayes factor of one of those that are likely to be sources.
    pub(in crate::aoa) fn log_factor(&self, rank: usize) -> f32 {
        self.gains.get(rank).copied().unwrap_or(0.0)
    }

    /// How many are likely to be sources.
    pub(in crate::aoa) fn found(&self) -> usize {
        self.found as usize
    }

    /// Where the likeliest one is thought to be.
    pub(in crate::aoa) fn source(&self) -> Option<[f32; 2]> {
        self.evidence.source
    }

    fn sources(&self) -> &[Mode<PLAIN>] {
        self.modes.get(..self.found()).unwrap_or_default()
    }

    /// The largest odds that a bearing is that of one of them, rather than an outlier.
    pub(in crate::aoa) fn odds(&self, observation: &Observation, config: &Config) -> f32 {
        let mut most = 0.0;
        for mode in self.sources() {
            let errors = errors_at(mode, &config.errors);
            let moments = without_scale(&mode.mean, &mode.covariance.matrix());
            let odds = odds_by_moments(observation, &errors, &moments);
            if odds > most {
                most = odds;
            }
        }
        most
    }

    /// The bearings of one of those.
    pub(in crate::aoa) fn candidate<'a>(
        &'a self,
        rank: usize,
        config: &'a Config,
    ) -> Option<Candidate<'a>> {
        Some(Candidate {
            entries: self.evidence.entries(),
            latest: self.evidence.bearings.latest(),
            source: self.evidence.source,
            modes: &self.modes,
            found: self.first(rank)?,
            errors: &config.errors,
            shared: &self.evidence.shared,
        })
    }

    /// Those that are likely to be sources, this one first.
    fn first(&self, rank: usize) -> Option<Modes<PLAIN>> {
        let mut first = Modes::new();
        let _ = first.push(*self.sources().get(rank)?);
        for (place, mode) in self.sources().iter().enumerate() {
            if place != rank {
                let _ = first.push(*mode);
            }
        }
        Some(first)
    }

    /// Forgets the bearings of one of those.
    #[inline(never)]
    pub(in crate::aoa) fn release(&mut self, rank: usize, config: &Config) {
        if let Some(first) = self.first(rank) {
            self.evidence.release(&first, &config.errors);
            let mut places = 0..;
            self.modes.retain(|_| places.next() != Some(rank));
            self.found -= 1;
            let places = self.gains.into_iter().enumerate();
            let mut kept = places.filter(|(place, _)| *place != rank);
            self.gains =
                core::array::from_fn(|_| kept.next().map_or(f32::NEG_INFINITY, |one| one.1));
        }
    }

    /// The modes.
    pub(in crate::aoa) fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        hypotheses(&self.modes)
    }

    /// Where to drive to find the first source.
    pub(in crate::aoa) fn advice(&self, reason: NotObservable, config: &Config) -> Option<Advice> {
        let latest = self.evidence.bearings.latest()?;
        let belief = Belief::of_hypotheses(self.hypotheses(), latest, config.range_m);
        belief.advice(latest, Answer::NotObservable(reason).missing_angle())
    }

    /// The bearings.
    pub(in crate::aoa) fn entries(&self) -> &[Entry] {
        self.evidence.entries()
    }

    /// Takes the bearing at an index away.
    pub(in crate::aoa) fn take(&mut self, index: usize) -> Option<Entry> {
        self.evidence.bearings.take(index)
    }

    /// One of them, to be changed.
    pub(in crate::aoa) fn entry_mut(&mut self, index: usize) -> Option<&mut Entry> {
        self.evidence.bearings.entries_mut().get_mut(index)
    }

    /// The mode that explains a bearing best, of those that would make a fix, and how far off it is of that. `None` if
    /// it is likelier an outlier.
    #[inline(never)]
    pub(in crate::aoa) fn explained(
        &self,
        entry: &Entry,
        config: &Config,
    ) -> Option<(usize, OffBy)> {
        let (mut best, mut most) = (None, 0.5);
        for (rank, (mode, gain)) in self.modes.iter().zip(&self.gains).enumerate() {
            if *gain == f32::NEG_INFINITY {
                continue;
            }
            let moments = without_scale(&mode.mean, &mode.covariance.matrix());
            let off_by = off_by_moments(entry, &errors_at(mode, &config.errors), &moments);
            if off_by.probability > most {
                (best, most) = (Some((rank, off_by)), off_by.probability);
            }
        }
        best
    }

    /// Why there is no fix yet.
    #[inline(never)]
    pub(in crate::aoa) fn reason(&self, config: &Config) -> NotObservable {
        let have = self.evidence.bearings.count();
        if self.evidence.entries().len() < 2 {
            return NotObservable::TooFewBearings { have };
        }
        let terms = self.evidence.terms(&config.errors);
        match self.evidence.crossing(&terms, &self.modes, config) {
            Err(reason) => reason,
            Ok(()) => NotObservable::SeveralPlaces {
                have: self.modes.len() as u32,
            },
        }
    }
}

/// The errors with the scale of a mode.
fn errors_at(mode: &Mode<PLAIN>, errors: &Errors) -> Errors {
    let scale = Width::new(errors.scale_sigma, &mode.mean).scale();
    Errors {
        sigma_scale: scale * errors.sigma_scale,
        ..*errors
    }
}

/// Logarithm of the odds of one more source before any bearing.
const BEFORE: f32 = ln(0.1);

/// The probability of one more source, from the logarithm of the Bayes factor of it.
pub(in crate::aoa) fn probability(log_factor: f32) -> f32 {
    of_log_odds(log_factor + BEFORE)
}

/// A probability from the logarithm of its odds.
#[inline(never)]
pub(in crate::aoa) fn of_log_odds(log_odds: f32) -> f32 {
    1.0 / (1.0 + exp(-log_odds))
}

/// The largest of some numbers, which is taken away, and its place.
fn take_largest(numbers: &mut [Option<f32>]) -> Option<(usize, f32)> {
    let known = |(place, number): (usize, &Option<f32>)| Some((place, (*number)?));
    let all = numbers.iter().enumerate().filter_map(known);
    let (place, largest) = all.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    *numbers.get_mut(place)? = None;
    Some((place, largest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    #[test]
    fn odds_are_probabilities() {
        for (odds, probability) in [(1.0_f32, 0.5), (4.0, 0.8), (0.25, 0.2)] {
            assert!((of_log_odds(odds.ln()) - probability).abs() < 1e-6);
        }
    }

    const SOURCES: [[f32; 2]; 2] = [[400.0, 900.0], [1_500.0, 700.0]];

    /// The bearings, in turn, on two sources.
    fn two_sources() -> Candidates<64> {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(6);
        let mut candidates = Candidates::<64>::EMPTY;
        for step in 0..40_u16 {
            let east = 50.0 * f32::from(step);
            let [x, y] = SOURCES[usize::from(step % 2)];
            let bearing = Bearing::from_radians(y.atan2(x - east));
            let reading = Observation::new(1_000 * u32::from(step), [east, 0.0], bearing, 0.03);
            let reading = [reading.unwrap().into()];
            let (shared, config) = (Shared::NOTHING, Config::DEFAULT);
            let taken = candidates.push(&reading, &shared, 0.0, &config, &mut rng);
            assert_eq!(taken, Ok(()));
        }
        candidates
    }

    #[test]
    fn odds_are_those_of_the_likeliest_source() {
        let candidates = two_sources();
        let odds = |[x, y]: [f32; 2], sigma_scale: f32| {
            let bearing = Bearing::from_radians(y.atan2(x - 900.0));
            let seen = Observation::new(40_000, [900.0, 0.0], bearing, 0.03).unwrap();
            let mut config = Config::DEFAULT;
            config.errors.sigma_scale = sigma_scale;
            candidates.odds(&seen, &config)
        };
        assert_eq!(candidates.found(), 1);
        // The wider the errors, the lower the density at their middle.
        let [sharp, blunt] = [1.0, 4.0].map(|scale| odds(SOURCES[0], scale));
        assert!(
            3.0 * blunt < sharp && sharp < 4.5 * blunt,
            "{sharp} {blunt}"
        );
        assert!(odds(SOURCES[1], 1.0) < 0.1);
        assert!(odds([900.0, -500.0], 1.0) < 0.1);
    }

    #[test]
    fn there_is_advice_before_the_first_source() {
        let candidates = two_sources();
        let reason = candidates.reason(&Config::DEFAULT);
        assert!(candidates.advice(reason, &Config::DEFAULT).is_some());
    }

    #[test]
    fn what_was_released_is_no_candidate_any_more() {
        let mut candidates = two_sources();
        let found = candidates.found();
        assert!(found > 0);
        let [first, second] = [0, 1].map(|rank| candidates.ranked(rank).unwrap());
        candidates.release(0, &Config::DEFAULT);
        assert_eq!(candidates.found(), found - 1);
        assert_eq!(candidates.ranked(0), Some(second));
        assert_ne!(first.position, second.position);
    }
}
