//! A source that may move, of several.

use super::Pursuit;
use super::phases::Phase;
use crate::aoa::Observation;
use crate::aoa::locator::Answer;
use crate::aoa::robust::{self, Seed};
use crate::aoa::sources::Track;
use crate::random::Rng;

impl<const N: usize, const B: usize> Track for Pursuit<N, B> {
    fn settings(&self) -> &robust::Settings {
        self.locator.settings()
    }

    fn plant<R: Rng + ?Sized>(&mut self, seed: &Seed<'_>, rng: &mut R) -> Answer {
        self.reset();
        self.locator.plant(seed, rng);
        self.bearings = seed.observations().count() as u32;
        self.answer = self.conclude();
        self.answer
    }

    fn withhold(&mut self, wild: f32) {
        self.locator.withhold(wild);
    }

    fn odds(&self, observation: &Observation, seconds: f32) -> f32 {
        if self.phase == Phase::Parked && !self.cloud.is_alive() {
            return self.locator.odds(observation);
        }
        let parked = if self.may_be_parked() {
            self.parked * self.locator.odds(observation)
        } else {
            0.0
        };
        let moved = self.cloud.odds(observation, &self.errors, seconds);
        parked + (1.0 - self.parked) * moved
    }
}
