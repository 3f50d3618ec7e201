//! Fireflies.
//!
//! Yang, "Firefly algorithms for multimodal optimization" (2009), and as Du, Li and Jiang improve them for the
//! particles of a filter: China Measurement & Test 43(11), 2017.
//!
//! A firefly is drawn to a brighter one by beta = exp(-gamma r^2) of the distance r between them, and flutters:
//! `x_i += beta (x_j - x_i) + alpha (rand - 1/2)`. Brightness is the density of the target.
//!
//! The formulas of the improved form are lost in the copy at hand. What stands here is a reconstruction from
//! the text: the attraction is towards the brightest alone, grows with how much brighter it is, decays with the
//! iteration k, and never falls below a least value:
//! `beta = exp(-k / tau) (1 - I_i / I_best) exp(-gamma r^2) + beta_min`.

use core::ops::Range;

use super::lengths::{Lengths, Scale};
use super::neighbours::{Grid, Neighbours};
use super::population::{Population, Report, halves, others};
use super::refinement::{Acceptance, Memory, Refinement};
use crate::ConfigError;
use crate::config::{require, require_positive, require_within};
use crate::math::vector::{difference, plus_scaled, square};
use crate::math::{exp, larger, ln, sqrt};
use crate::model::Likelihood;
use crate::random::{Rng, uniform};

/// The attraction of a mate below which it is left out.
const NEGLIGIBLE: f32 = 1e-3;

/// A swarm of fireflies: each particle is one.
///
/// As published by Yang, each is drawn to all brighter ones in turn. Those whose attraction is below 1/1000 are left
/// out, and their part of the flutter with them, so that the time is proportional to the number within reach, not to
/// that of all. As improved by Du et al., each is drawn to the brightest alone, which itself stays.
///
/// With [`Acceptance::Metropolis`] the flutter is normal with the same sigma, and a firefly is drawn to one that
/// does not depend on where it is itself: any one at random, or the brightest of the other half of the swarm. Half of
/// the times it is driven away by as much instead, or there would be no way back; the move is weighed with the density
/// of that.
///
/// One iteration takes 340 modelled cycles of a Cortex-M4F a firefly (the brightest; 720 with Metropolis) and a cheap
/// density; all brighter ones take up to the square of their number.
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
/// use foxhunt::refine::{Firefly, Memory, Refinement};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut x = [0.0; 50];
/// x.fill_with(|| 3.0 * normal(&mut rng));
/// let target = |[x]: &[f32; 1]| -(x - 2.0).abs();
///
/// const SWARM: Firefly = foxhunt::config!(Firefly { flutter: 0.1, iterations: 20, ..Firefly::DEFAULT });
/// let mut memory = Memory::<1, 50>::EMPTY;
/// SWARM.refine(&mut [&mut x], &target, &mut memory, &mut rng);
/// assert!((x.iter().sum::<f32>() / 50.0 - 2.0).abs() < 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Firefly {
    /// Whether the brightest alone draws a firefly: Du et al. If not, all that are brighter do: Yang.
    pub brightest: bool,
    /// The unit of distances.
    pub lengths: Lengths,
    /// gamma: how the attraction falls with the distance, per square of the unit.
    pub absorption: f32,
    /// alpha: width of the random part of a move, in the unit.
    pub flutter: f32,
    /// beta_min: the fraction of the distance by which the brightest draws at least.
    pub least_attraction: f32,
    /// tau: iterations in which the attraction of the brightest decays by e.
    pub decay_iterations: f32,
    /// How many times every firefly moves.
    pub iterations: u16,
    /// As published, or with the target invariant.
    pub acceptance: Acceptance,
}

impl Firefly {
    /// The improved form of Du et al., with lengths in standard deviations of the cloud. Gamma, alpha and the least
    /// attraction are not printed.
    pub const DEFAULT: Self = Self {
        brightest: true,
        lengths: Lengths::Relative,
        absorption: 1.0,
        flutter: 0.2,
        least_attraction: 0.2,
        decay_iterations: 5.0,
        iterations: 1,
        acceptance: Acceptance::Greedy,
    };

    /// The standard form of Yang.
    pub const STANDARD: Self = Self {
        brightest: false,
        ..Self::DEFAULT
    };

    /// A swarm that leaves the target invariant, with moves that suit clouds in the plane. Each firefly is offered four
    /// places.
    pub const METROPOLIS: Self = Self {
        absorption: 0.1,
        flutter: 4.0,
        iterations: 4,
        acceptance: Acceptance::Metropolis,
        ..Self::DEFAULT
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(
            self.absorption >= 0.0 && self.absorption <= f32::MAX,
            "absorption is negative or not finite"
        );
        require_positive!(self: flutter, decay_iterations);
        require_within!(self: least_attraction 0.0..=1.0);
        require!(self.iterations > 0, "iterations is zero");
        Ok(())
    }

    /// exp(-gamma r^2)
    #[inline(always)]
    fn visibility(&self, distance_squared: f32) -> f32 {
        exp(-self.absorption * distance_squared)
    }

    /// The fraction of its distance from `goal` by which a firefly is drawn to it.
    #[inline(always)]
    fn pull(&self, iteration: u16, goal: f32, log_density: f32, distance_squared: f32) -> f32 {
        let visibility = self.visibility(distance_squared);
        if !self.brightest {
            return visibility;
        }
        let dimmer = 1.0 - exp(log_density - goal);
        // The brightest of one half may be dimmer than a firefly of the other.
        let dimmer = larger(dimmer, 0.0);
        exp(f32::from(iteration) / -self.decay_iterations) * dimmer * visibility
            + self.least_attraction
    }

    /// One iteration as published by Yang: every firefly flies to the brighter ones where they were, one after
    /// the other, by the attraction of the distance at the beginning.
    fn fly_to_all<const D: usize, const N: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        scale: &Scale<D>,
        grid: &mut Grid<D, N>,
        rng: &mut R,
    ) {
        // Infinite when nothing is absorbed.
        let reach = sqrt(-ln(NEGLIGIBLE) / self.absorption);
        let neighbours = Neighbours::new(population, scale, reach, grid);
        for (cell, around) in neighbours.cells() {
            for firefly in cell {
                let mut flown = [0.0; D];
                neighbours.within_reach(firefly, &around, |mate, offset, square| {
                    if mate.log_density > firefly.log_density {
                        let pull = self.visibility(square);
                        for (flown, offset) in flown.iter_mut().zip(offset) {
                            *flown +=
                                pull * (offset - *flown) + self.flutter * (uniform(rng) - 0.5);
                        }
                    }
                });
                if flown != [0.0; D] {
                    let i = usize::from(firefly.index);
                    let trial = population.trial(scale.away(population.state(i), 1.0, flown));
                    population.go(i, &trial);
                }
            }
        }
    }

    /// One iteration as improved by Du et al.
    fn fly_to_brightest<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        scale: &Scale<D>,
        iteration: u16,
        rng: &mut R,
    ) {
        let Some(brightest) = population.best(0..population.len()) else {
            return;
        };
        let goal = population.state(brightest);
        let brightness = population.log_density(brightest);
        for i in (0..population.len()).filter(|i| *i != brightest) {
            let here = population.state(i);
            let offset = scale.measure(difference(goal, here));
            let log_density = population.log_density(i);
            let pull = self.pull(iteration, brightness, log_density, square(offset));
            let flown = offset.map(|x| pull * x + self.flutter * (uniform(rng) - 0.5));
            let trial = population.trial(scale.away(here, 1.0, flown));
            population.go(i, &trial);
        }
    }

    /// One iteration that leaves the target invariant.
    fn wander<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        (members, rest): (Range<usize>, Range<usize>),
        iteration: u16,
        rng: &mut R,
    ) {
        let scale = population.scale(self.lengths, rest.clone());
        let brightest = population.best(rest);
        // That of a uniform flutter of this width: over the square root of twelve.
        let sigma = 0.288_675_13 * self.flutter;
        for i in members {
            let goal = if self.brightest {
                brightest
            } else {
                others(population.len(), i, rng).map(|[other]| other)
            };
            let Some(goal) = goal else {
                continue;
            };
            let brightness = population.log_density(goal);
            let pull = |log_density, offset: [f32; D]| {
                self.pull(iteration, brightness, log_density, square(offset))
            };
            let here = population.state(i);
            let offset = scale.measure(difference(population.state(goal), here));
            // Drawn to the goal or, half of the times, away from it: each is the other's way back.
            let sign = if uniform(rng) < 0.5 { 1.0 } else { -1.0 };
            let there = sign * pull(population.log_density(i), offset);
            let flutter = scale.noise(rng).map(|x| sigma * x);
            let flown = plus_scaled(flutter, there, offset);
            let trial = population.trial(scale.away(here, 1.0, flown));
            // What the flutter would have to be on the way back.
            let offset = difference(offset, flown);
            let back = -sign * pull(trial.log_density, offset);
            let flutter_back = plus_scaled(flown.map(|x| -x), -back, offset);
            let way_back = 0.5 * (square(flutter) - square(flutter_back)) / (sigma * sigma);
            population.metropolis(i, &trial, way_back, rng);
        }
    }
}

impl<const D: usize> Refinement<D> for Firefly {
    fn refine<const N: usize, R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report {
        let mut population = Population::new(columns, target, &mut memory.log_densities);
        let scale = population.scale(self.lengths, 0..population.len());
        for iteration in 0..self.iterations {
            population.report.iterations += 1;
            match (self.acceptance, self.brightest) {
                (Acceptance::Greedy, false) => {
                    self.fly_to_all(&mut population, &scale, &mut memory.grid, rng);
                }
                (Acceptance::Greedy, true) => {
                    self.fly_to_brightest(&mut population, &scale, iteration, rng);
                }
                (Acceptance::Metropolis, _) => {
                    for half in halves(population.len()) {
                        self.wander(&mut population, half, iteration, rng);
                    }
                }
            }
        }
        population.report
    }

    fn evaluations(&self, particles: usize) -> usize {
        particles.saturating_mul(1 + usize::from(self.iterations))
    }

    fn check(&self) -> Result<(), ConfigError> {
        Self::check(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use crate::refine::Memory;

    #[test]
    fn only_a_negligible_attraction_is_left_out() {
        let brighter_to_the_right = |[x]: &[f32; 1]| *x;
        let swarm = Firefly {
            lengths: Lengths::Absolute,
            absorption: 0.5,
            flutter: f32::MIN_POSITIVE,
            ..Firefly::STANDARD
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(88);
        let mut memory = Memory::<1, 2>::EMPTY;
        for tenth in 1..100 {
            let distance = 0.1 * tenth as f32;
            let mut x = [0.0, distance];
            swarm.refine(&mut [&mut x], &brighter_to_the_right, &mut memory, &mut rng);
            let pull = exp(-0.5 * distance * distance);
            let expected = if pull < NEGLIGIBLE {
                0.0
            } else {
                pull * distance
            };
            assert!((x[0] - expected).abs() < 1e-6, "{distance}: {x:?}");
            assert_eq!(x[1], distance);
        }
    }

    #[test]
    fn fields_out_of_range_are_named() {
        let field = |swarm: Firefly| swarm.check().unwrap_err().field();
        let swarm = Firefly::DEFAULT;
        for absorption in [-1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(
                field(Firefly {
                    absorption,
                    ..swarm
                }),
                "absorption"
            );
        }
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let (flutter, decay_iterations) = (bad, bad);
            assert_eq!(field(Firefly { flutter, ..swarm }), "flutter");
            let decaying = Firefly {
                decay_iterations,
                ..swarm
            };
            assert_eq!(field(decaying), "decay_iterations");
        }
        for least_attraction in [-0.1, 1.1, f32::NAN] {
            let least = Firefly {
                least_attraction,
                ..swarm
            };
            assert_eq!(field(least), "least_attraction");
        }
        assert_eq!(
            field(Firefly {
                iterations: 0,
                ..swarm
            }),
            "iterations"
        );
        for preset in [swarm, Firefly::STANDARD, Firefly::METROPOLIS] {
            assert_eq!(preset.check(), Ok(()));
        }
        let seven = Firefly {
            iterations: 7,
            ..swarm
        };
        assert_eq!(Refinement::<1>::evaluations(&seven, 10), 80);
    }
}
