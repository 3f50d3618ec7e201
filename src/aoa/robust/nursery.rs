//! Bearings that no known source explains, and the sources that may be found among them.

use super::density::{Density, Region};
use super::errors::Shares;
use super::evidence::Evidence;
use super::mode::{MODES, Mode, Modes, best};
use super::search::search;
use super::split::Seed;
use super::{Hypothesis, Settings, crossing, hypotheses, plane};
use crate::aoa::Observation;
use crate::aoa::advice::{Advice, Belief};
use crate::aoa::locator::{Answer, NotObservable};
use crate::estimate::largest_variance;
use crate::math::ln;
use crate::random::Rng;

/// The bearings, and the modes of their posterior.
///
/// That is of one source and wild bearings, but each of its modes may be a source of its own: the bearings of all the
/// others are as good as wild to it.
#[derive(Debug, Clone)]
pub(in crate::aoa) struct Nursery<const B: usize> {
    pub(super) evidence: Evidence<B>,
    pub(super) modes: Modes,
}

impl<const B: usize> Nursery<B> {
    /// The most that there may be.
    pub(in crate::aoa) const MODES: usize = MODES;

    pub(in crate::aoa) const fn new() -> Self {
        Self {
            evidence: Evidence::new(1.0),
            modes: Modes::new(),
        }
    }

    pub(in crate::aoa) fn clear(&mut self) {
        self.evidence.clear();
        self.modes.clear();
    }

    /// Takes a bearing, `seconds` after the one before, and looks for modes.
    pub(in crate::aoa) fn push<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        settings: &Settings,
        rng: &mut R,
    ) {
        let errors = &settings.errors;
        self.evidence.push(observation, seconds, None, errors);
        // What is expected of a source that is new does not depend on where the first one was heard.
        self.evidence
            .centre_on(observation.position(), settings.range_m);
        if self.evidence.sights().len() > 1 {
            self.modes = search(&self.evidence, errors, &self.modes, rng);
            // Errors of places count by the range.
            if errors.position_deviation > 0.0
                && let Some(best) = best(&self.modes)
            {
                self.evidence.refresh(errors, &best.mean);
            }
        }
    }

    /// The mode of this rank by mass, if it alone would make a fix and is as likely as `log_odds` says to be a
    /// source's.
    pub(in crate::aoa) fn candidate<'a>(
        &'a self,
        rank: usize,
        log_odds: f32,
        settings: &'a Settings,
    ) -> Option<Seed<'a>> {
        let errors = &settings.errors;
        let mode = self.modes.get(self.place(rank)?)?;
        let limit = settings.common.relative_range_error;
        let range = self.evidence.range_squared(mode.mean[0], mode.mean[1]);
        let deviation = largest_variance(&plane(&mode.covariance.matrix()));
        let density = self.evidence.density(errors);
        (deviation <= limit * limit * range
            && log_odds_of_source(&density, mode, &errors.shares) > log_odds)
            .then(|| self.evidence.seed(mode, &self.modes, errors))
    }

    /// Forgets the bearings of a candidate.
    pub(in crate::aoa) fn release(&mut self, rank: usize, settings: &Settings) {
        let Some(place) = self.place(rank) else {
            return;
        };
        if let Some(mode) = self.modes.get(place).copied() {
            self.evidence.release(&mode, &settings.errors);
            let mut places = 0..;
            self.modes.retain(|_| places.next() != Some(place));
        }
    }

    /// Of the mode of this rank by mass.
    fn place(&self, rank: usize) -> Option<usize> {
        let heavier = |mode: &Mode| {
            let heavier = |other: &&Mode| other.log_mass > mode.log_mass;
            self.modes.iter().filter(heavier).count()
        };
        self.modes.iter().position(|mode| heavier(mode) == rank)
    }

    /// The modes.
    pub(in crate::aoa) fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        hypotheses(&self.modes)
    }

    /// Where to drive to find the first source.
    pub(in crate::aoa) fn advice(
        &self,
        reason: NotObservable,
        settings: &Settings,
    ) -> Option<Advice> {
        let latest = self.evidence.latest()?;
        let belief = if self.modes.is_empty() {
            Belief::of_ray(latest, settings.range_m)
        } else {
            Belief::of_hypotheses(self.hypotheses(), latest.position())
        };
        belief.advice(latest, Answer::NotObservable(reason).missing_angle())
    }

    /// Why there is no fix yet.
    pub(in crate::aoa) fn reason(&self, settings: &Settings) -> NotObservable {
        let have = self.evidence.count();
        if self.evidence.sights().len() < 2 {
            return NotObservable::TooFewBearings { have };
        }
        match crossing(&self.evidence, &self.modes, &settings.errors, settings) {
            Err(reason) => reason,
            Ok(()) => NotObservable::NoIntersection,
        }
    }
}

/// Logarithm of how many times as likely the bearings are if some are those of a source, which is about a mode, as if
/// all of them were wild.
///
/// This is a Bayes factor: over all places, by Laplace's approximation, and over all shares of the source's bearings.
/// So bearings that are wild will, however many they are, hardly ever push it above c: with a probability of less than
/// 1/c (Ville's inequality).
fn log_odds_of_source(density: &Density<'_>, mode: &Mode, shares: &Shares) -> f32 {
    let bias = density.bias_deviation * mode.mean[2];
    let count = density.terms.len() as f32;
    let odds = || {
        density
            .terms
            .iter()
            .map(|term| term.read(&mode.mean, bias).odds)
    };
    let fitted: f32 = odds().map(|odds| odds / (1.0 + odds)).sum();
    // The share that makes the most of it has more than 1 / (count + 1) of the mass of all shares about it.
    let share = fitted / (count + 1.0);
    let scale = shares.wild / (1.0 - shares.wild);
    let gain: f32 = odds()
        .map(|odds| ln(1.0 - share + share * scale * odds))
        .sum();
    let region: &Region = density.region;
    gain - ln(1.0 + count)
        + region.log_density(&mode.mean)
        + ln(2.0 * region.inverse_square)
        + mode.covariance.half_ln_determinant()
}
