//! The locator of a manoeuvring source as one of several.

use super::{Manoeuvring, seconds};
use crate::aoa::robust::{self, Candidate, Errors};
use crate::aoa::track::{Stationary, Track};
use crate::aoa::{Answer, Locate, Observation};
use crate::random::Rng;

impl<L: Stationary, const K: usize, const N: usize> Track for Manoeuvring<L, K, N> {
    fn beliefs(config: &Self::Config) -> robust::Config {
        L::beliefs(&config.stationary)
    }

    fn errors(&self, config: &Self::Config) -> Errors {
        L::beliefs(&config.stationary).errors.with(&self.learned)
    }

    fn latest(&self) -> Option<&Observation> {
        if K > 0 && self.cloud.is_alive() {
            self.recent.back()
        } else {
            self.stationary.latest()
        }
    }

    fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Self::Config,
        rng: &mut R,
    ) -> Answer {
        self.reset();
        (self.stationary).initiate(candidate, &config.stationary, rng);
        self.bearings = candidate.observations().count() as u32;
        self.answer = self.conclude(config);
        self.answer
    }

    fn odds(&self, observation: &Observation, config: &Self::Config) -> f32 {
        let stationary = if self.may_be_stationary() {
            (1.0 - self.moved) * self.stationary.odds(observation, &config.stationary)
        } else {
            0.0
        };
        let elapsed_ms = self
            .latest()
            .map_or(0, |latest| observation.since_ms(latest.time_ms()));
        let elapsed = seconds(elapsed_ms.max(0));
        let errors = self.errors_beside_biases(config);
        stationary + self.moved * self.cloud.odds(observation, &errors, elapsed)
    }

    fn set_outliers_removed(&mut self, per_bearing: f32) {
        self.stationary.set_outliers_removed(per_bearing);
    }
}
