//! What locators have in common.

use super::advice::Advice;
use super::locator::{Answer, Fix, Locator, Moves};
use super::robust::{Bias, Hypothesis, RobustLocator, Shares};
use super::{Alternative, Observation};
use crate::random::Rng;

/// What takes bearings and says where sources are.
///
/// A [`Locator`] and a [`RobustLocator`] know of one source that stays where it is. What one of them does not estimate is
/// `None` here, at no cost.
pub trait Locate {
    /// Whether it knows more of a source than where it is, of more sources than one, or of the errors of bearings.
    const DETAILS: bool = true;

    /// Takes one bearing, `seconds` after the one before, and says what is known with it.
    fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        rng: &mut R,
    ) -> Answer;

    /// Takes a reading that is one of several bearings, which exclude each other, `seconds` after the one before. Unless a
    /// locator knows better, it is the likeliest for certain.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        let likeliest = (alternatives.iter()).max_by(|a, b| a.share().total_cmp(&b.share()));
        match likeliest {
            Some(one) => self.push_after(*one.observation(), seconds, rng),
            None => self.answer(),
        }
    }

    /// What is known of the source; of the best known, where there are several.
    fn answer(&self) -> Answer;

    /// Forgets everything but the settings.
    fn reset(&mut self);

    /// The sources that have a fix, the best known first; `None` beyond the last.
    fn source(&self, index: usize) -> Option<Source> {
        match self.answer() {
            Answer::Fix(fix) if index == 0 => Some(Source {
                identity: 0,
                fix,
                motion: None,
            }),
            _ => None,
        }
    }

    /// The places where the source may be, in no particular order; `None` beyond the last.
    fn hypothesis(&self, _index: usize) -> Option<Hypothesis> {
        None
    }

    /// What all bearings are off by alike.
    fn bias(&self) -> Option<Bias> {
        None
    }

    /// The shares of direct, mirrored and wild bearings.
    fn shares(&self) -> Option<Shares> {
        None
    }

    /// Where to drive, so that the next bearings tell most.
    fn advice(&self) -> Option<Advice> {
        None
    }

    /// The probabilities that a bearing is direct, mirrored or wild, by what is known of the sources; `None` without a fix,
    /// or where every bearing is taken for direct.
    fn classify(&self, _observation: &Observation) -> Option<Shares> {
        None
    }

    /// The particles of the source with this index.
    fn cloud(&self, _index: usize) -> Option<Cloud<'_>> {
        None
    }
}

/// Seconds since the bearing before; none, where what was given is no such time.
pub(super) fn elapsed(seconds: f32) -> f32 {
    if (0.0..=1e9).contains(&seconds) {
        seconds
    } else {
        0.0
    }
}

/// Particles that stand for where a source may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cloud<'a> {
    /// Their places, in metres.
    pub east: &'a [f32],
    /// In metres, too.
    pub north: &'a [f32],
    /// Their weights, which sum to one.
    pub weights: &'a [f32],
}

impl<'a> Cloud<'a> {
    /// That of the first source, where a locator has a fix.
    fn of(
        answer: Answer,
        index: usize,
        [east, north]: [&'a [f32]; 2],
        weights: &'a [f32],
    ) -> Option<Self> {
        (index == 0 && matches!(answer, Answer::Fix(_))).then_some(Self {
            east,
            north,
            weights,
        })
    }
}

/// One of the sources on a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Source {
    /// A number that it keeps for as long as it is tracked, and that no other had unless 65,536 have been given since.
    pub identity: u16,
    /// Where it is.
    pub fix: Fix,
    /// How it moves; `None` from a locator for sources that do not.
    pub motion: Option<Motion>,
}

/// How a source moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motion {
    /// Probability that it moves now, rather than being parked.
    pub moving: f32,
    /// Posterior mean of its velocity if it moves, in metres a second east and north.
    pub velocity: [f32; 2],
    /// Standard deviation of either of these, in metres a second.
    pub deviation: f32,
}

impl<const N: usize, const B: usize, M: Moves<N>> Locate for Locator<N, B, M> {
    const DETAILS: bool = false;

    fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        _seconds: f32,
        rng: &mut R,
    ) -> Answer {
        self.push(observation, rng)
    }

    fn answer(&self) -> Answer {
        self.answer()
    }

    fn reset(&mut self) {
        self.reset();
    }

    // No advice, though it has some: it is for the smallest firmware, which that would make a tenth larger.

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        Cloud::of(self.answer(), index, self.columns(), self.weights())
    }
}

impl<const N: usize, const B: usize> Locate for RobustLocator<N, B> {
    fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        self.push_after(observation, seconds, rng)
    }

    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        self.push_alternatives(alternatives, seconds, rng)
    }

    fn answer(&self) -> Answer {
        self.answer()
    }

    fn reset(&mut self) {
        self.reset();
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        self.hypotheses().nth(index)
    }

    fn bias(&self) -> Option<Bias> {
        self.bias()
    }

    fn shares(&self) -> Option<Shares> {
        Some(self.shares())
    }

    fn advice(&self) -> Option<Advice> {
        self.advice()
    }

    fn classify(&self, observation: &Observation) -> Option<Shares> {
        self.classify(observation)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        let [east, north, _] = self.columns();
        Cloud::of(self.answer(), index, [east, north], self.weights())
    }
}
