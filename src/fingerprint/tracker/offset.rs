//! The offset of a tag's levels from those of the survey's tag.

use super::Config;
use crate::math::{exp, larger, ln, smaller};
use crate::snapshot::value;

/// Belief about a tag's offset: none, or normally distributed (spike and slab).
///
/// A normal prior alone would make tags without an offset less certain than the survey allows. All particles share one
/// belief: each point of the map has its own evidence for an offset, and the mean of that evidence is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OffsetBelief {
    /// Mean of the offset, in dB, if there is one.
    pub mean_db: f32,
    /// Variance of the mean, in dB^2.
    pub variance: f32,
    /// Log-odds that there is an offset.
    log_odds: f32,
}

value!(OffsetBelief {
    mean_db,
    variance,
    log_odds
});

impl OffsetBelief {
    /// The largest log-odds, a thousand to one: larger ones would take longer to revise when a tag is exchanged.
    const MOST: f32 = 6.9;

    /// No offset is estimated: the variance is zero, and the odds have no effect.
    pub const EMPTY: Self = Self {
        mean_db: 0.0,
        variance: 0.0,
        log_odds: 0.0,
    };

    pub fn prior(config: &Config) -> Self {
        let mut belief = Self::EMPTY;
        let probability = config.offset_probability;
        if probability > 0.0 {
            belief.variance = config.offset_sigma_db * config.offset_sigma_db;
            belief.set_odds(ln(probability / (1.0 - probability)));
        }
        belief
    }

    #[inline(always)]
    pub fn is_estimated(&self) -> bool {
        self.variance > 0.0
    }

    /// The probability that there is an offset.
    pub fn probability(&self) -> f32 {
        sigmoid(self.log_odds)
    }

    /// The same where a scan makes it by so much more probable: a log-likelihood ratio.
    #[inline(always)]
    pub fn probability_given(&self, ratio: f32) -> f32 {
        sigmoid(self.log_odds + ratio)
    }

    /// Lets `dt` seconds pass.
    pub fn drift(&mut self, config: &Config, dt: f32) {
        if self.is_estimated() {
            let most = config.offset_sigma_db * config.offset_sigma_db;
            let variance = self.variance + config.offset_noise_db2_s * dt;
            self.variance = smaller(variance, most);
        }
    }

    /// Learns from the points where the particles are: the weight of each, the probability of an offset given that place, and
    /// the correction of the mean there. `total` is the sum of the weights, `precision` how much the scan adds to the
    /// precision of the offset.
    pub fn learn(
        &mut self,
        precision: f32,
        total: f32,
        opinions: impl Iterator<Item = (f32, [f32; 2])>,
    ) {
        if !self.is_estimated() {
            return;
        }
        let (mut some, mut first, mut second) = (0.0, 0.0, 0.0);
        for (weight, [probability, shift]) in opinions {
            // Most points have no particles.
            if weight > 0.0 {
                let with = weight * probability;
                let of_shift = with * shift;
                some += with;
                first += of_shift;
                second += of_shift * shift;
            }
        }
        let none = total - some;
        // The sums have underflowed: nothing can be learned.
        if !(some > 1e-12 * total && none > -1e-3 * total) {
            return;
        }
        let mean = first / some;
        let spread = second / some - mean * mean;
        self.mean_db += mean;
        self.variance = self.variance / (1.0 + self.variance * precision) + larger(spread, 0.0);
        // Rounding may leave less than none.
        let none = larger(none, 0.0);
        self.set_odds(ln(some / (none + 1e-12 * total)));
    }

    fn set_odds(&mut self, log_odds: f32) {
        self.log_odds = log_odds.clamp(-Self::MOST, Self::MOST);
    }

    /// The logarithms of the probabilities that there is no offset and that there is one; zero if none is estimated.
    pub fn log_probabilities(&self) -> [f32; 2] {
        if !self.is_estimated() {
            return [0.0; 2];
        }
        let probability = self.probability();
        [ln(1.0 - probability), ln(probability)]
    }
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prior() -> OffsetBelief {
        OffsetBelief::prior(&Config::DEFAULT)
    }

    /// Two points of weights 2 and 1, of which one in two and all of the weight has an offset, by 3 and by -1 dB: a mean of 1 dB,
    /// a spread of 4 dB^2, and odds of 2 to 1. A scan of precision 1/64 halves a variance of 64 dB^2.
    #[test]
    fn learns_the_mean_the_spread_and_the_odds_of_what_points_think() {
        let mut belief = prior();
        belief.learn(
            1.0 / 64.0,
            3.0,
            [(2.0, [0.5, 3.0]), (1.0, [1.0, -1.0])].into_iter(),
        );
        assert!((belief.mean_db - 1.0).abs() < 1e-5, "{belief:?}");
        assert!((belief.variance - 36.0).abs() < 1e-4, "{belief:?}");
        assert!(
            (belief.probability() - 2.0 / 3.0).abs() < 1e-5,
            "{belief:?}"
        );
    }

    /// Whatever the weights are relative to.
    #[test]
    fn learns_from_all_sums_but_those_that_have_underflowed_or_add_up_to_too_much() {
        for (total, some, is_learned) in [
            (1e-3, 1e-14, true),
            (1e3, 1e-8, true),
            (1e3, 1e-10, false),
            (1e3, 1000.5, true),
            (1e3, 1001.0, false),
        ] {
            let mut belief = prior();
            belief.learn(0.0, total, [(some, [1.0, 5.0])].into_iter());
            let mean_db = if is_learned { 5.0 } else { 0.0 };
            assert_eq!(belief.mean_db, mean_db, "{total} {some}");
            // A thousand to one at most, also where nothing is left for none.
            let probability = belief.probability();
            assert!((0.001..0.999).contains(&probability), "{probability}");
        }
    }

    #[test]
    fn what_is_not_estimated_is_not_learned() {
        let mut belief = OffsetBelief::EMPTY;
        belief.drift(&Config::DEFAULT, 10.0);
        belief.learn(0.0, 1.0, [(1.0, [0.5, 5.0])].into_iter());
        assert_eq!(belief, OffsetBelief::EMPTY);
        assert_eq!(belief.log_probabilities(), [0.0; 2]);
    }
}
