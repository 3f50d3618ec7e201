//! The locator for clean bearings as one that others build on.

use super::{Clean, Config, Moves, RANGE_M};
use crate::aoa::core::Entry;
use crate::aoa::robust::{self, Candidate, Correlation, Errors, Learned};
use crate::aoa::track::{Stationary, Track, odds_by_moments};
use crate::aoa::{Answer, Locate, Mixture, Observation};
use crate::random::Rng;

/// What is believed of bearings that may be those of other sources: a higher rate loses a source sooner, a lower one gives
/// it more bearings of others.
const ERRORS: Errors = Errors {
    rates: Mixture::new(0.0, 0.02),
    prior_bearings: f32::INFINITY,
    scale_sigma: 0.0,
    bias_sigma_rad: 0.0,
    correlation: Correlation::NONE,
    ..Errors::DEFAULT
};

impl<const N: usize, const B: usize, M: Moves<N>> Track for Clean<N, B, M> {
    fn beliefs(config: &Config<M>) -> robust::Config {
        robust::Config {
            errors: ERRORS,
            range_m: RANGE_M,
            relative_range_sigma: config.relative_range_sigma,
            ..robust::Config::DEFAULT
        }
    }

    fn errors(&self, _: &Config<M>) -> Errors {
        ERRORS
    }

    fn latest(&self) -> Option<&Observation> {
        self.bearings.latest()
    }

    /// Evaluates up to `10 N B` likelihoods of one bearing. A candidate of more than `B` bearings takes `B^2 / 2`
    /// comparisons for each beyond.
    fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Config<M>,
        rng: &mut R,
    ) -> Answer {
        self.reset();
        let source = Some(candidate.position());
        self.bearings
            .adopt(candidate.entries(), candidate.latest(), &source);
        self.answer = self.first_answer(config, rng);
        self.answer
    }

    fn odds(&self, observation: &Observation, _: &Config<M>) -> f32 {
        odds_by_moments(observation, &ERRORS, &self.moments())
    }

    fn entries(&self) -> &[Entry] {
        self.bearings.entries()
    }
}

impl<const N: usize, const B: usize, M: Moves<N>> Stationary for Clean<N, B, M> {
    fn moments(&self) -> ([f32; 3], [[f32; 3]; 3]) {
        let [x, y] = self.filter.mean();
        let [[xx, xy], [yx, yy]] = self.filter.covariance();
        ([x, y, 0.0], [[xx, xy, 0.0], [yx, yy, 0.0], [0.0; 3]])
    }

    fn restart(&mut self, _: &Learned) {
        self.reset();
    }

    fn recall(&mut self, observation: &Observation, _: &Config<M>) {
        self.bearings.note(observation, 1.0);
        let new = Entry::new(*observation, 1.0);
        self.bearings.add(new, &None);
    }
}
