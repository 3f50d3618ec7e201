//! Unassigned bearings, and the sources that may be found among them.

use super::config::Config;
use core::f32::consts::TAU;

use heapless::Vec;

use super::density::Density;
use super::evidence::{Candidate, Evidence};
use super::mode::{MODES, Mode, Modes, best, hypotheses, plane, position};
use super::search::search;
use super::term::{PLAIN, Width};
use crate::aoa::core::is_narrow;
use crate::aoa::words::Belief;
use crate::aoa::{
    Advice, Answer, Hypothesis, Mixture, NotObservable, Observation, PushError, Retract, Retracted,
};
use crate::math::ln;
use crate::persist;
use crate::random::Rng;

/// The unassigned bearings, and the modes of their posterior.
///
/// That is of one source and outliers, but each of its modes may be a source of its own: the bearings of all the others
/// are as good as outliers to it. All bits of an empty one are zero.
#[derive(Debug, Clone)]
pub(in crate::aoa) struct Candidates<const B: usize> {
    evidence: Evidence<B, PLAIN>,
    modes: Modes<PLAIN>,
}

persist!(impl[const B: usize] Candidates<B> as "Candidates"(B) { evidence, modes });

impl<const B: usize> Candidates<B> {
    pub(in crate::aoa) const EMPTY: Self = Self {
        evidence: Evidence::EMPTY,
        modes: Modes::new(),
    };

    pub(in crate::aoa) fn clear(&mut self) {
        self.evidence.clear();
        self.modes.clear();
    }

    /// Takes a bearing, and looks for modes.
    #[inline(never)]
    pub(in crate::aoa) fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Config,
        rng: &mut R,
    ) -> Result<(), PushError> {
        let errors = &config.errors;
        self.evidence.bearings.admit(observation)?;
        self.evidence.push(&(*observation).into(), errors);
        if self.evidence.entries().len() > 1 {
            let terms = self.evidence.terms(errors);
            self.modes = search(&self.evidence, &terms, config, &self.modes, rng);
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

    /// Where the modes are that alone would make a fix and are as likely as `log_odds` says to be a source's: those with more
    /// mass first.
    #[inline(never)]
    pub(in crate::aoa) fn found(&self, log_odds: f32, config: &Config) -> Vec<usize, MODES> {
        let terms = self.evidence.terms(&config.errors);
        let density = self.evidence.density(&terms, config);
        let log_volume = self.evidence.region(config).log_volume();
        let is_found = |mode: &Mode<PLAIN>| {
            let range = (self.evidence.bearings).range_squared(position(&mode.mean));
            let variance = plane(&mode.covariance.matrix()).largest_eigenvalue();
            let prior = density.log_prior(&mode.mean) - log_volume;
            is_narrow(variance, range, config.relative_range_sigma)
                && log_odds_of_source(&density, prior, mode, &config.errors.rates) > log_odds
        };
        let mut found = Vec::new();
        let mut above = f32::INFINITY;
        // By falling mass.
        while let Some((place, mode)) = heaviest_below(&self.modes, above) {
            above = mode.log_mass;
            if is_found(mode) {
                let _ = found.push(place);
            }
        }
        found
    }

    /// The bearings of a mode.
    pub(in crate::aoa) fn candidate<'a>(
        &'a self,
        place: usize,
        config: &'a Config,
    ) -> Option<Candidate<'a>> {
        Some(Candidate {
            entries: self.evidence.entries(),
            latest: self.evidence.bearings.latest(),
            source: self.evidence.source,
            mode: self.modes.get(place)?,
            modes: &self.modes,
            errors: &config.errors,
        })
    }

    /// Forgets the bearings of a candidate.
    #[inline(never)]
    pub(in crate::aoa) fn release(&mut self, place: usize, config: &Config) {
        if let Some(mode) = self.modes.get(place).copied() {
            self.evidence.release(&mode, &config.errors);
            let mut places = 0..;
            self.modes.retain(|_| places.next() != Some(place));
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

/// The mode with the most mass below some, and its place.
fn heaviest_below(modes: &Modes<PLAIN>, above: f32) -> Option<(usize, &Mode<PLAIN>)> {
    let below = (modes.iter().enumerate()).filter(|(_, mode)| mode.log_mass < above);
    below.max_by(|(_, a), (_, b)| a.log_mass.total_cmp(&b.log_mass))
}

/// Logarithm of how many times as likely the bearings are if some are those of a source, which is about a mode, as if
/// all of them were outliers.
///
/// This is a Bayes factor: over all places, by Laplace's approximation, and over all rates of the source's bearings. So
/// outliers, however many there are, hardly ever push it above c: with a probability of less than 1/c (Ville's
/// inequality).
fn log_odds_of_source(
    density: &Density<'_, PLAIN>,
    log_prior: f32,
    mode: &Mode<PLAIN>,
    rates: &Mixture,
) -> f32 {
    let width = Width::new(density.scale_sigma, &mode.mean);
    let count = density.places().count() as f32;
    let odds = || (density.places()).map(|place| density.odds(place, &mode.mean, &width));
    let fitted: f32 = odds().map(|odds| odds / (1.0 + odds)).sum();
    // The rate that makes the most of it has more than 1 / (count + 1) of the mass of all rates about it.
    let rate = fitted / (count + 1.0);
    let scale = rates.outlier / (1.0 - rates.outlier);
    let gain: f32 = odds()
        .map(|odds| ln(1.0 - rate + rate * scale * odds))
        .sum();
    gain - ln(1.0 + count)
        + log_prior
        + const { ln(TAU) + ln(0.766) }
        + mode.covariance.half_ln_determinant()
}
