//! The artificial fish school.
//!
//! Li, Shao and Qian, "An optimizing method based on autonomous animats: fish-swarm algorithm" (2002), as Du,
//! Zhao, Jiang and Yu apply it to the particles of a filter that locates a transmitter: Telecommunication
//! Engineering 56(12), 2016, eq. 8, 9 and 12 to 15.
//!
//! A fish swims to the centre of the mates that it sees, or to the best of them, if the place is good and not
//! crowded; otherwise it searches for prey: it looks at a few places within its perception, and swims towards the
//! first that is better than its own, or anywhere if there is none.
//!
//! # What the print gets wrong
//!
//! * The random step is `X + r s` with r from 0 to 1, which drifts along the diagonal, always the same way. A step
//!   needs a direction; [`Heading::Diagonal`] shows what comes of it otherwise.
//! * The crowding test compares likelihoods, which underflow. Here it is `ln Y_c - ln n > ln delta + ln Y_i`.
//! * A perception of 1 m and a step of 0.3 m do nothing to a cloud of 20 m: see [`Lengths::Relative`].

mod swim;

use core::fmt;

use super::Acceptance;
use super::lengths::Lengths;
use crate::math::ln;

/// A school of fish: each particle is one.
///
/// With [`Acceptance::Metropolis`] a fish must not heed mates because they are near, since it would not be near them
/// on its way back. An iteration is then a step of random length and direction; for a swarm, one along the
/// line through the centre of four mates drawn at random; to follow, one along the line through the best of four:
/// the snooker update of ter Braak and Vrugt (2008). Perception, crowding, tries and threshold have no meaning.
///
/// Neighbours are found by a grid, in time proportional to the number of fish times the number of mates that one
/// sees: 700 modelled cycles of a Cortex-M4F for each of 1,000 fish that see a dozen mates. The rest of an iteration
/// takes 600, and a step of the Metropolis form 500, with a density that costs next to nothing.
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
/// use foxhunt::refine::{FishSchool, Lengths, Memory, Refinement};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let (mut x, mut y) = ([0.0; 200], [0.0; 200]);
/// x.fill_with(|| 3.0 * normal(&mut rng));
/// y.fill_with(|| 3.0 * normal(&mut rng));
/// let target = |[x, y]: &[f32; 2]| -(x - 5.0).powi(2) - (y - 5.0).powi(2);
///
/// let school = FishSchool::new(Lengths::Relative, 0.5, 0.3)?.iterations(30)?;
/// let mut memory = Memory::<2, 200>::new();
/// let report = school.refine(&mut [&mut x, &mut y], &target, &mut memory.workspace(), &mut rng);
/// assert!(report.evaluations <= school.evaluations(200));
/// // The school has found its prey.
/// assert!((x.iter().sum::<f32>() / 200.0 - 5.0).abs() < 0.5);
/// # Ok::<(), foxhunt::refine::fish::ConfigurationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FishSchool {
    lengths: Lengths,
    perception: f32,
    step: f32,
    /// ln delta
    log_crowding: f32,
    tries: u16,
    iterations: u16,
    threshold: f32,
    behaviour: Behaviour,
    heading: Heading,
    acceptance: Acceptance,
}

/// What a fish does when it sees mates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Behaviour {
    /// It searches for prey on its own.
    Prey,
    /// It swims to the centre of its mates: Du et al.
    #[default]
    Swarm,
    /// It follows the best of its mates.
    Follow,
    /// Whichever leads to the better place: Li et al.
    SwarmAndFollow,
}

impl Behaviour {
    const fn swarms(self) -> bool {
        matches!(self, Self::Swarm | Self::SwarmAndFollow)
    }

    const fn follows(self) -> bool {
        matches!(self, Self::Follow | Self::SwarmAndFollow)
    }
}

/// Where a random step goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heading {
    /// In any direction.
    #[default]
    Random,
    /// Forward in every dimension, as printed by Du et al.: the cloud drifts away. For demonstration only;
    /// [`Acceptance::Metropolis`] does not know it.
    Diagonal,
}

/// Why a school was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigurationError {
    /// `perception` is not positive and finite.
    Perception,
    /// `step` is not positive and finite.
    Step,
    /// `crowding` is not positive and finite.
    Crowding,
    /// `tries` is zero.
    Tries,
    /// `iterations` is zero.
    Iterations,
    /// `threshold` is negative or not finite.
    Threshold,
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Perception => "perception is not positive and finite",
            Self::Step => "step is not positive and finite",
            Self::Crowding => "crowding is not positive and finite",
            Self::Tries => "tries is zero",
            Self::Iterations => "iterations is zero",
            Self::Threshold => "threshold is negative or not finite",
        })
    }
}

impl core::error::Error for ConfigurationError {}

impl FishSchool {
    /// A school that sees as far as `perception` and swims up to `step` at a time, both in the unit of `lengths`.
    ///
    /// The rest is as published, where it is: a crowding factor of 0.618, 50 tries, one iteration.
    ///
    /// # Errors
    /// When a length is not positive and finite.
    pub const fn new(
        lengths: Lengths,
        perception: f32,
        step: f32,
    ) -> Result<Self, ConfigurationError> {
        if !is_length(perception) {
            return Err(ConfigurationError::Perception);
        }
        if !is_length(step) {
            return Err(ConfigurationError::Step);
        }
        Ok(Self {
            lengths,
            perception,
            step,
            log_crowding: ln(0.618),
            tries: 50,
            iterations: 1,
            threshold: 0.0,
            behaviour: Behaviour::Swarm,
            heading: Heading::Random,
            acceptance: Acceptance::Greedy,
        })
    }

    /// How much of its own density a fish asks of a place, times the number of mates that it shares it with: the smaller,
    /// the denser the school.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub const fn crowding(mut self, factor: f32) -> Result<Self, ConfigurationError> {
        if !is_length(factor) {
            return Err(ConfigurationError::Crowding);
        }
        self.log_crowding = ln(factor);
        Ok(self)
    }

    /// How many places a fish looks at before it takes a random step.
    ///
    /// # Errors
    /// For none.
    pub const fn tries(mut self, tries: u16) -> Result<Self, ConfigurationError> {
        if tries == 0 {
            return Err(ConfigurationError::Tries);
        }
        self.tries = tries;
        Ok(self)
    }

    /// How many times every fish moves.
    ///
    /// # Errors
    /// For none.
    pub const fn iterations(mut self, iterations: u16) -> Result<Self, ConfigurationError> {
        if iterations == 0 {
            return Err(ConfigurationError::Iterations);
        }
        self.iterations = iterations;
        Ok(self)
    }

    /// The school rests when the log-density of the best fish changes by less than this in an iteration: zero, never,
    /// unless set.
    ///
    /// # Errors
    /// When it is negative or not finite.
    pub const fn threshold(mut self, change: f32) -> Result<Self, ConfigurationError> {
        if !(change >= 0.0 && change <= f32::MAX) {
            return Err(ConfigurationError::Threshold);
        }
        self.threshold = change;
        Ok(self)
    }

    /// What a fish does when it sees mates.
    pub const fn behaviour(mut self, behaviour: Behaviour) -> Self {
        self.behaviour = behaviour;
        self
    }

    /// Where a random step goes.
    pub const fn heading(mut self, heading: Heading) -> Self {
        self.heading = heading;
        self
    }

    /// As published, or with the target invariant.
    pub const fn acceptance(mut self, acceptance: Acceptance) -> Self {
        self.acceptance = acceptance;
        self
    }

    /// The most evaluations of the density that a refinement of so many particles takes.
    pub const fn evaluations(&self, particles: usize) -> usize {
        let (swarm, follow) = (self.behaviour.swarms(), self.behaviour.follows());
        let each = match self.acceptance {
            Acceptance::Greedy => swarm as usize + self.tries as usize + 1,
            Acceptance::Metropolis => 1 + swarm as usize + follow as usize,
        };
        particles.saturating_mul(1 + self.iterations as usize * each)
    }
}

/// Positive, finite, and not so small that its inverse is infinite.
const fn is_length(x: f32) -> bool {
    x >= f32::MIN_POSITIVE && x <= f32::MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOT_LENGTHS: [f32; 5] = [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45];

    #[test]
    fn lengths_are_positive_and_finite() {
        for bad in NOT_LENGTHS {
            let school = |perception, step| FishSchool::new(Lengths::Absolute, perception, step);
            assert_eq!(school(bad, 1.0), Err(ConfigurationError::Perception));
            assert_eq!(school(1.0, bad), Err(ConfigurationError::Step));
        }
    }

    #[test]
    fn settings_are_checked() {
        const SCHOOL: Result<FishSchool, ConfigurationError> =
            FishSchool::new(Lengths::Relative, 0.5, 0.3);
        let school = SCHOOL.unwrap();
        for bad in NOT_LENGTHS {
            assert_eq!(school.crowding(bad), Err(ConfigurationError::Crowding));
        }
        assert_eq!(school.tries(0), Err(ConfigurationError::Tries));
        assert_eq!(school.iterations(0), Err(ConfigurationError::Iterations));
        for bad in [-0.1, f32::NAN, f32::INFINITY] {
            assert_eq!(school.threshold(bad), Err(ConfigurationError::Threshold));
        }
        assert_eq!(school.evaluations(10), 10 * (1 + 1 + 50 + 1));
        assert_eq!(school.evaluations(usize::MAX), usize::MAX);
    }
}
