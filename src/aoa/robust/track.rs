//! The robust locator as one that others build on.

use super::config::Config;
use super::errors::{Errors, Learned};
use super::evidence::Candidate;
use super::mode::weigh;
use super::search::climb_again;
use super::shared::Shared;
use super::term::{PLAIN, State, without_scale};
use super::{AT_LEAST_EVERY, Robust};
use crate::aoa::core::Entry;
use crate::aoa::track::{OffBy, Stationary, Track, odds_by_moments, off_by_moments};
use crate::aoa::{Answer, Locate, Observation, PushError};
use crate::random::Rng;

impl<const N: usize, const B: usize> Track for Robust<N, B, PLAIN> {
    const RECLAIMS: bool = true;

    fn beliefs(config: &Config) -> Config {
        *config
    }

    fn errors(&self, config: &Config) -> Errors {
        self.believed(config).errors
    }

    fn latest(&self) -> Option<&Observation> {
        self.evidence.bearings.latest()
    }

    /// Evaluates up to `5 N B` likelihoods of one bearing, and `50 B` before. A candidate of more than `B` bearings takes
    /// `B^2 / 2` comparisons for each beyond.
    fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Config,
        rng: &mut R,
    ) -> Answer {
        self.reset();
        self.evidence.adopt(candidate, &config.errors);
        let terms = self.evidence.terms(&config.errors);
        self.modes = climb_again(&self.evidence.density(&terms, config), candidate.modes);
        weigh(&mut self.modes);
        let crosses = self.evidence.crossing(&terms, &self.modes, config);
        let fix = crosses.and_then(|()| {
            self.start(&terms, config, rng);
            self.credible_fix(1.0, config)
        });
        self.answer = fix.into();
        self.answer
    }

    fn odds(&self, observation: &Observation, config: &Config) -> f32 {
        odds_by_moments(
            observation,
            &self.errors(config),
            &Stationary::moments(self),
        )
    }

    fn entries(&self) -> &[Entry] {
        self.evidence.entries()
    }

    fn entry_mut(&mut self, index: usize) -> Option<&mut Entry> {
        self.since_search = AT_LEAST_EVERY;
        self.evidence.bearings.entries_mut().get_mut(index)
    }

    fn take(&mut self, index: usize) -> Option<Entry> {
        self.since_search = AT_LEAST_EVERY;
        self.evidence.bearings.take(index)
    }

    fn off_by(&self, entry: &Entry, config: &Config) -> OffBy {
        let errors = config.errors.with(&self.learned);
        off_by_moments(entry, &errors, &Stationary::moments(self))
    }

    fn shared(&self) -> Shared {
        match self.answer {
            Answer::Fix(_) => {
                let (mean, covariance) = &self.moments;
                Shared::of(mean, covariance, &self.evidence.shared)
            }
            Answer::NotObservable(_) => Shared::NOTHING,
        }
    }

    /// Weighs the particles by what is new.
    fn assume(&mut self, others: &Shared, next: &Observation) -> Result<(), PushError> {
        self.evidence.bearings.admit(next)?;
        let before = self.evidence.shared;
        self.evidence.shared = *others;
        if self.answer.fix().is_some() {
            let gain =
                |state: &State<PLAIN>| others.log_likelihood(state) - before.log_likelihood(state);
            // The likelihood is finite, so the update cannot fail.
            let _ = self.filter.update(&gain);
        }
        Ok(())
    }

    /// Weighs the particles, which the next bearing moves.
    fn reclaim(&mut self, earlier: &Entry, config: &Config) {
        let believed = self.believed(config);
        let change = (self.evidence).push(*earlier, &believed.errors, false);
        self.weigh(&change, believed.errors.scale_sigma);
        self.answer = self.credible_fix(2.0, config).into();
    }

    fn inherit(&mut self, earlier: &Entry, config: &Config) {
        if self.evidence.entries().len() < B {
            let errors = self.errors(config);
            self.evidence.push(*earlier, &errors, false);
            self.since_search = AT_LEAST_EVERY;
        }
    }

    fn set_outliers_removed(&mut self, per_bearing: f32) {
        if (0.0..=1e3).contains(&per_bearing) {
            self.outliers_removed = per_bearing;
        }
    }
}

impl<const N: usize, const B: usize> Stationary for Robust<N, B, PLAIN> {
    fn moments(&self) -> ([f32; 3], [[f32; 3]; 3]) {
        without_scale(&self.moments.0, &self.moments.1)
    }

    fn learned(&self) -> Learned {
        self.learned
    }

    fn restart(&mut self, learned: &Learned) {
        self.reset();
        self.learned = *learned;
    }

    fn centre_prior(&mut self, centre: [f32; 2], range_m: f32) {
        self.evidence.centre_on(centre, range_m);
    }

    fn recall(&mut self, observation: &Observation, config: &Config) {
        let errors = self.errors(config);
        (self.evidence).push(Entry::new(*observation, 1.0), &errors, false);
    }
}
