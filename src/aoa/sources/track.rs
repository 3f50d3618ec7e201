//! What follows one source of several.

use crate::aoa::robust::{self, RobustLocator, Seed};
use crate::aoa::{Locate, Observation, locator::Answer};
use crate::random::Rng;

/// A locator that can start from some of the bearings of a channel, and says which of the next it explains.
pub trait Track: Locate {
    /// What is believed of the bearings, before any.
    fn settings(&self) -> &robust::Settings;

    /// Forgets everything but the settings, and starts from the bearings of what may be a source. It has been found
    /// if that makes a fix.
    fn plant<R: Rng + ?Sized>(&mut self, seed: &Seed<'_>, rng: &mut R) -> Answer;

    /// How many bearings no source explains for each that it is given, which are wild ones to it.
    fn withhold(&mut self, wild: f32);

    /// How many times as likely a bearing is to be of this source as to be wild, if it is the next one and taken
    /// `seconds` after the last. Asked for of tracks that have had a fix only.
    fn odds(&self, observation: &Observation, seconds: f32) -> f32;
}

impl<const N: usize, const B: usize> Track for RobustLocator<N, B> {
    fn settings(&self) -> &robust::Settings {
        self.settings()
    }

    fn plant<R: Rng + ?Sized>(&mut self, seed: &Seed<'_>, rng: &mut R) -> Answer {
        self.plant(seed, rng)
    }

    fn withhold(&mut self, wild: f32) {
        self.withhold(wild);
    }

    fn odds(&self, observation: &Observation, _seconds: f32) -> f32 {
        self.odds(observation)
    }
}
