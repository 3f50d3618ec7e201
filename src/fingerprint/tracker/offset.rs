//! By how much a tag differs from the one of the survey.

use super::settings::Offset;
use crate::math::{exp, ln};

/// Either it has no offset at all, or one that is normal about a mean: spike and slab.
///
/// A normal prior alone would cost a tag without an offset the certainty that the survey gives it. The belief is one for
/// all particles: each point of the map has its own evidence for it, and it is their mean that is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OffsetBelief {
    /// In dB, if there is one.
    pub mean_db: f32,
    /// Of the mean, in dB^2.
    pub variance: f32,
    /// Log-odds for there being one; minus infinity when that is out of the question.
    log_odds: f32,
    /// Log-probabilities that there is none and that there is one.
    pub log_none: f32,
    pub log_some: f32,
}

impl OffsetBelief {
    /// Evidence never makes it surer than a thousand to one: a tag may be changed.
    const MOST: f32 = 6.9;

    /// Knows nothing yet, and with the first update what the settings say.
    pub const fn new() -> Self {
        Self {
            mean_db: 0.0,
            variance: 0.0,
            log_odds: f32::NEG_INFINITY,
            log_none: 0.0,
            log_some: f32::NEG_INFINITY,
        }
    }

    pub fn prior(offset: &Offset) -> Self {
        let mut belief = Self::new();
        if offset.probability > 0.0 {
            belief.variance = offset.deviation_db * offset.deviation_db;
            belief.set_odds(ln(offset.probability / (1.0 - offset.probability)));
        }
        belief
    }

    #[inline(always)]
    pub fn is_estimated(&self) -> bool {
        self.variance > 0.0
    }

    /// The probability that there is one.
    pub fn probability(&self) -> f32 {
        sigmoid(self.log_odds)
    }

    /// The same where a scan makes it by so much more probable: a log-likelihood ratio.
    #[inline(always)]
    pub fn probability_given(&self, ratio: f32) -> f32 {
        sigmoid(self.log_odds + ratio)
    }

    /// Lets `dt` seconds pass.
    pub fn drift(&mut self, offset: &Offset, dt: f32) {
        if self.is_estimated() {
            let most = offset.deviation_db * offset.deviation_db;
            let variance = self.variance + offset.drift * dt;
            self.variance = if variance < most { variance } else { most };
        }
    }

    /// Learns from what the particles say: weight, probability of an offset, and what to add to its mean.
    /// `precision` is what the scan adds to its precision.
    pub fn learn(&mut self, precision: f32, opinions: impl Iterator<Item = (f32, [f32; 2])>) {
        if !self.is_estimated() {
            return;
        }
        let (mut none, mut some, mut first, mut second) = (0.0, 0.0, 0.0, 0.0);
        for (weight, [probability, shift]) in opinions {
            let with = weight * probability;
            none += weight - with;
            some += with;
            first += with * shift;
            second += with * shift * shift;
        }
        // Particles so light that nothing is left of them say nothing.
        if !(some > 1e-12 && none >= 0.0) {
            return;
        }
        let mean = first / some;
        let spread = second / some - mean * mean;
        self.mean_db += mean;
        self.variance = self.variance / (1.0 + self.variance * precision)
            + if spread > 0.0 { spread } else { 0.0 };
        self.set_odds(ln(some / (none + 1e-12)));
    }

    fn set_odds(&mut self, log_odds: f32) {
        self.log_odds = log_odds.clamp(-Self::MOST, Self::MOST);
        let probability = self.probability();
        self.log_some = ln(probability);
        self.log_none = ln(1.0 - probability);
    }
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}
