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
//!   needs a direction; [`FishSchool::diagonal`] shows what comes of it otherwise.
//! * The crowding test compares likelihoods, which underflow. Here it is `ln Y_c - ln n > ln delta + ln Y_i`.
//! * A perception of 1 m and a step of 0.3 m do nothing to a cloud of 20 m: see [`Lengths::Relative`].

mod swim;

use super::lengths::Lengths;
use super::refinement::Acceptance;
use crate::ConfigError;
use crate::config::{require, require_positive};

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
/// use foxhunt::refine::{FishSchool, Memory, Refinement};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let (mut x, mut y) = ([0.0; 200], [0.0; 200]);
/// x.fill_with(|| 3.0 * normal(&mut rng));
/// y.fill_with(|| 3.0 * normal(&mut rng));
/// let target = |[x, y]: &[f32; 2]| -(x - 5.0).powi(2) - (y - 5.0).powi(2);
///
/// const SCHOOL: FishSchool = foxhunt::config!(FishSchool { perception: 0.5, iterations: 30, ..FishSchool::DEFAULT });
/// let mut memory = Memory::<2, 200>::EMPTY;
/// let report = SCHOOL.refine(&mut [&mut x, &mut y], &target, &mut memory, &mut rng);
/// assert!(report.evaluations <= Refinement::<2>::evaluations(&SCHOOL, 200));
/// // The school has found its prey.
/// assert!((x.iter().sum::<f32>() / 200.0 - 5.0).abs() < 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FishSchool {
    /// The unit of `perception` and `step`.
    pub lengths: Lengths,
    /// How far a fish sees.
    pub perception: f32,
    /// How far a fish swims at most in an iteration.
    pub step: f32,
    /// The density that a fish asks of a place where mates are: the product with their number, relative to its
    /// own density. The smaller, the denser the school.
    pub crowding: f32,
    /// How many places a fish looks at before it takes a random step.
    pub tries: u16,
    /// How many times every fish moves.
    pub iterations: u16,
    /// The school stops when the log-density of its best fish changes by less than this in an iteration; never if zero.
    pub threshold: f32,
    /// Whether a fish swims to the centre of the mates that it sees: Du et al.
    pub swarm: bool,
    /// Whether it swims to the best of them; if it also swarms, whichever leads to the better place: Li et al. A fish that
    /// does neither searches for prey on its own.
    pub follow: bool,
    /// Whether a random step goes forward in every dimension, as printed by Du et al., instead of in any direction: the
    /// cloud drifts away. For demonstration only; [`Acceptance::Metropolis`] does not know it.
    pub diagonal: bool,
    /// As published, or with the target invariant.
    pub acceptance: Acceptance,
}

impl FishSchool {
    /// The numbers of Du et al., with lengths in standard deviations of the cloud.
    pub const DEFAULT: Self = Self {
        lengths: Lengths::Relative,
        perception: 1.0,
        step: 0.3,
        crowding: 0.618,
        tries: 50,
        iterations: 1,
        threshold: 0.0,
        swarm: true,
        follow: false,
        diagonal: false,
        acceptance: Acceptance::Greedy,
    };

    /// As published by Du et al.: a perception of 1 m and a step of 0.3 m.
    pub const PUBLISHED: Self = Self {
        lengths: Lengths::Absolute,
        ..Self::DEFAULT
    };

    /// A school that leaves the target invariant, with steps that suit clouds in the plane. Each fish is offered four
    /// places, which is enough to move copies apart.
    pub const METROPOLIS: Self = Self {
        step: 3.0,
        iterations: 2,
        acceptance: Acceptance::Metropolis,
        ..Self::DEFAULT
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_positive!(self: perception, step, crowding);
        require!(self.tries > 0, "tries is zero");
        require!(self.iterations > 0, "iterations is zero");
        require!(
            self.threshold >= 0.0 && self.threshold <= f32::MAX,
            "threshold is negative or not finite"
        );
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refine::Refinement;

    #[test]
    fn fields_out_of_range_are_named() {
        let field = |school: FishSchool| school.check().unwrap_err().field();
        let school = FishSchool::DEFAULT;
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45] {
            let (perception, step, crowding) = (bad, bad, bad);
            assert_eq!(
                field(FishSchool {
                    perception,
                    ..school
                }),
                "perception"
            );
            assert_eq!(field(FishSchool { step, ..school }), "step");
            assert_eq!(field(FishSchool { crowding, ..school }), "crowding");
        }
        assert_eq!(field(FishSchool { tries: 0, ..school }), "tries");
        let none = FishSchool {
            iterations: 0,
            ..school
        };
        assert_eq!(field(none), "iterations");
        for threshold in [-0.1, f32::NAN, f32::INFINITY] {
            assert_eq!(
                field(FishSchool {
                    threshold,
                    ..school
                }),
                "threshold"
            );
        }
        for preset in [school, FishSchool::PUBLISHED, FishSchool::METROPOLIS] {
            assert_eq!(preset.check(), Ok(()));
        }
        let evaluations = |particles| Refinement::<1>::evaluations(&school, particles);
        assert_eq!(evaluations(10), 10 * (1 + 1 + 50 + 1));
        assert_eq!(evaluations(usize::MAX), usize::MAX);
    }
}
