//! One of the bearings of a reading that exclude each other.

use super::correction::Correction;
use super::observation::{Observation, ObservationError};

/// One of several bearings of one reading that exclude each other, like the peaks of a [spectrum](crate::aoa::spectrum).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Alternative {
    observation: Observation,
    probability: f32,
    correction: Correction,
}

impl Alternative {
    /// A bearing, and the probability that it is the right one if one of the reading's bearings is. The probabilities of
    /// all alternatives of a reading add up to one.
    ///
    /// # Errors
    /// When the `probability` is outside 0 to 1.
    pub const fn new(observation: Observation, probability: f32) -> Result<Self, ObservationError> {
        if !(probability >= 0.0 && probability <= 1.0) {
            return Err(ObservationError::Probability);
        }
        Ok(Self {
            observation,
            probability,
            correction: Correction::NONE,
        })
    }

    /// The bearing.
    pub const fn observation(&self) -> &Observation {
        &self.observation
    }

    /// The same, if the bearing is that.
    pub(in crate::aoa) const fn with_observation(&self, observation: Observation) -> Self {
        Self {
            observation,
            ..*self
        }
    }

    /// The same, if the reading may be of none of its bearings: one of them is right with this probability.
    pub(in crate::aoa) const fn if_any(&self, probability: f32) -> Self {
        Self {
            probability: self.probability * probability,
            ..*self
        }
    }

    /// The same, corrected by what is known of its error.
    pub(in crate::aoa) fn corrected(&self, by: &Correction) -> Self {
        let mut correction = self.correction;
        let observation = correction.replace(by, &self.observation);
        Self {
            observation,
            correction,
            ..*self
        }
    }

    /// By what it was corrected.
    pub(in crate::aoa) const fn correction(&self) -> Correction {
        self.correction
    }

    /// The most probable of some bearings; of several that are as probable the last.
    pub(in crate::aoa) fn most_probable(alternatives: &[Self]) -> Option<&Observation> {
        let best = alternatives.iter().reduce(Self::likelier)?;
        Some(&best.observation)
    }

    // A call, so that the loop is not unrolled.
    #[inline(never)]
    fn likelier<'a>(&'a self, other: &'a Self) -> &'a Self {
        if other.probability >= self.probability {
            other
        } else {
            self
        }
    }

    /// Its probability.
    pub const fn probability(&self) -> f32 {
        self.probability
    }
}

impl From<Observation> for Alternative {
    /// The only bearing of its reading.
    fn from(observation: Observation) -> Self {
        Self {
            observation,
            probability: 1.0,
            correction: Correction::NONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;

    #[test]
    fn the_most_probable_one_is_the_last_of_those_that_are_as_probable() {
        let new = |x| Observation::new(0, [x, 0.0], Bearing::from_radians(0.0), 0.1).unwrap();
        let sure = new(0.0);
        let all = [(0.2, 0.0), (0.5, 1.0), (0.1, 2.0), (0.5, 3.0)]
            .map(|(probability, x)| Alternative::new(new(x), probability).unwrap());
        let place = |all: &[Alternative]| Alternative::most_probable(all).map(|one| one.position());
        assert_eq!(place(&all), Some([3.0, 0.0]));
        assert_eq!(place(&all[..3]), Some([1.0, 0.0]));
        assert_eq!(place(&[]), None);
        for probability in [0.0, 1.0] {
            assert!(Alternative::new(sure, probability).is_ok());
        }
        for probability in [-0.1, 1.1, f32::NAN] {
            let refused = Alternative::new(sure, probability);
            assert_eq!(refused, Err(ObservationError::Probability));
        }
    }
}
