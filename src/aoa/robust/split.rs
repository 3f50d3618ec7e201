//! One source's bearings among those of several.

use super::errors::Errors;
use super::merge::Sight;
use super::mode::{Mode, Modes, share};
use super::search::climb_again;
use super::term::Term;
use super::{NOTHING, RobustLocator, Settings};
use crate::aoa::Observation;
use crate::aoa::locator::Answer;
use crate::random::Rng;

/// Bearings that are likely to be one source's, and where it may be: what a track of it starts from.
#[derive(Debug, Clone, Copy)]
pub struct Seed<'a> {
    pub(super) sights: &'a [Sight],
    /// Of the sights, in the same order.
    pub(super) terms: &'a [Term],
    pub(super) mode: &'a Mode,
    pub(super) modes: &'a Modes,
    pub(super) errors: &'a Errors,
    pub(super) latest: Option<&'a Observation>,
}

impl Seed<'_> {
    /// The bearings, some of which may stand for several.
    pub fn observations(&self) -> impl Iterator<Item = &Observation> {
        self.own().map(|sight| &sight.observation)
    }

    pub(super) fn own(&self) -> impl Iterator<Item = &Sight> {
        let sights = self.sights.iter().zip(self.terms);
        sights
            .filter(|(_, term)| explains(self.mode, term, self.errors))
            .map(|(sight, _)| sight)
    }
}

/// Whether a bearing is likelier direct or mirrored than wild if the source is at a mode.
pub(super) fn explains(mode: &Mode, term: &Term, errors: &Errors) -> bool {
    let bias = errors.bias_deviation * mode.mean[2];
    term.read(&mode.mean, bias).odds > 1.0
}

impl<const N: usize, const B: usize> RobustLocator<N, B> {
    /// What it was told.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Forgets everything but the settings, takes the bearings of a seed, and says what is known with them.
    ///
    /// Evaluates up to `5 N B` likelihoods of one bearing, and `50 B` before. A seed of more than `B` bearings takes
    /// `B^2 / 2` comparisons for each beyond.
    pub fn plant<R: Rng + ?Sized>(&mut self, seed: &Seed<'_>, rng: &mut R) -> Answer {
        self.errors = self.settings.errors;
        self.evidence.adopt(seed, &self.errors);
        self.modes = climb_again(&self.evidence.density(&self.errors), seed.modes);
        share(&mut self.modes);
        self.since_search = 0;
        self.withheld = 0.0;
        self.answer = NOTHING;
        let fix = self.crossing().and_then(|()| {
            self.start(rng);
            self.credible_fix(1.0)
        });
        self.answer = match fix {
            Ok(fix) => Answer::Fix(fix),
            Err(reason) => Answer::NotObservable(reason),
        };
        self.answer
    }

    /// Says how many wild bearings it is not given for each that it is, where something else has sorted them out: so that
    /// the shares that it learns are those of all. None unless said.
    pub fn withhold(&mut self, wild: f32) {
        if (0.0..=1e3).contains(&wild) {
            self.withheld = wild;
        }
    }

    /// How many times as likely a bearing is to be direct or mirrored as wild: the mean over the particles. It means
    /// nothing before the first fix.
    pub fn odds(&self, observation: &Observation) -> f32 {
        let term = self.evidence.single(observation, &self.errors);
        let scale = self.errors.bias_deviation;
        let [x, y, bias] = self.columns();
        let states = x.iter().zip(y).zip(bias).zip(self.weights());
        states
            .map(|(((x, y), bias), weight)| weight * term.read(&[*x, *y, *bias], scale * bias).odds)
            .sum()
    }
}
