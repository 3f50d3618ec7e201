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

use core::fmt;
use core::ops::Range;

use super::lengths::{Lengths, Scale, difference, dot};
use super::neighbours::{Grid, Neighbours};
use super::population::{Population, halves, others};
use super::{Acceptance, Refinement, Report, Workspace};
use crate::math::{exp, ln, sqrt};
use crate::model::Likelihood;
use crate::random::{Rng, uniform};

/// The attraction of a mate below which it is left out.
const NEGLIGIBLE: f32 = 1e-3;

/// A swarm of fireflies: each particle is one.
///
/// [`Firefly::standard`] draws each to all brighter ones in turn. Those whose attraction is below 1/1000 are left
/// out, with their share of the flutter, so that the time is proportional to the number within reach, not to
/// that of all. [`Firefly::improved`] draws each to the brightest alone, which itself stays.
///
/// With [`Acceptance::Metropolis`] the flutter is normal with the same deviation, and a firefly is drawn to one that
/// does not depend on where it is itself: any one at random (standard), or the brightest of the other half of the
/// swarm (improved). Half of the times it is driven away by as much instead, or there would be no way back; the move
/// is weighed with the density of that.
///
/// One iteration takes 340 modelled cycles of a Cortex-M4F a firefly (improved; 720 with Metropolis) and a cheap
/// density; the standard form takes up to the square of their number.
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
/// use foxhunt::refine::{Firefly, Lengths, Memory, Refinement};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut x = [0.0; 50];
/// x.fill_with(|| 3.0 * normal(&mut rng));
/// let target = |[x]: &[f32; 1]| -(x - 2.0).abs();
///
/// let swarm = Firefly::improved(Lengths::Relative, 1.0, 0.1)?.iterations(20)?;
/// let mut memory = Memory::<1, 50>::new();
/// swarm.refine(&mut [&mut x], &target, &mut memory.workspace(), &mut rng);
/// assert!((x.iter().sum::<f32>() / 50.0 - 2.0).abs() < 0.5);
/// # Ok::<(), foxhunt::refine::firefly::ConfigurationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Firefly {
    attraction: Attraction,
    lengths: Lengths,
    /// gamma
    absorption: f32,
    /// alpha
    flutter: f32,
    iterations: u16,
    acceptance: Acceptance,
}

/// What draws a firefly.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Attraction {
    /// All that are brighter.
    Standard,
    /// The brightest.
    Improved {
        /// beta_min
        least: f32,
        /// tau
        decay: f32,
    },
}

/// Why a swarm was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigurationError {
    /// `absorption` is negative or not finite.
    Absorption,
    /// `flutter` is not positive and finite.
    Flutter,
    /// `least_attraction` is not within 0 and 1.
    LeastAttraction,
    /// `decay` is not positive and finite.
    Decay,
    /// `iterations` is zero.
    Iterations,
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Absorption => "absorption is negative or not finite",
            Self::Flutter => "flutter is not positive and finite",
            Self::LeastAttraction => "least_attraction is not within 0 and 1",
            Self::Decay => "decay is not positive and finite",
            Self::Iterations => "iterations is zero",
        })
    }
}

impl core::error::Error for ConfigurationError {}

impl Firefly {
    /// Each is drawn to all brighter ones. `absorption` is gamma, per square of the unit of `lengths`; `flutter` is
    /// alpha, the width of the random part, in that unit.
    ///
    /// # Errors
    /// When gamma is negative, alpha is not positive, or one is not finite.
    pub const fn standard(
        lengths: Lengths,
        absorption: f32,
        flutter: f32,
    ) -> Result<Self, ConfigurationError> {
        Self::new(Attraction::Standard, lengths, absorption, flutter)
    }

    /// Each is drawn to the brightest, by at least a fifth of the distance, and with an attraction that decays by
    /// e in five iterations, unless set otherwise. `absorption` and `flutter` are those of [`Firefly::standard`].
    ///
    /// # Errors
    /// When gamma is negative, alpha is not positive, or one is not finite.
    pub const fn improved(
        lengths: Lengths,
        absorption: f32,
        flutter: f32,
    ) -> Result<Self, ConfigurationError> {
        let attraction = Attraction::Improved {
            least: 0.2,
            decay: 5.0,
        };
        Self::new(attraction, lengths, absorption, flutter)
    }

    const fn new(
        attraction: Attraction,
        lengths: Lengths,
        absorption: f32,
        flutter: f32,
    ) -> Result<Self, ConfigurationError> {
        if !(absorption >= 0.0 && absorption <= f32::MAX) {
            return Err(ConfigurationError::Absorption);
        }
        if !(flutter >= f32::MIN_POSITIVE && flutter <= f32::MAX) {
            return Err(ConfigurationError::Flutter);
        }
        Ok(Self {
            attraction,
            lengths,
            absorption,
            flutter,
            iterations: 1,
            acceptance: Acceptance::Greedy,
        })
    }

    /// The share of the distance that an improved firefly is drawn by at least (beta_min); the standard form has none.
    ///
    /// # Errors
    /// Outside 0 to 1.
    pub const fn least_attraction(mut self, share: f32) -> Result<Self, ConfigurationError> {
        if !(share >= 0.0 && share <= 1.0) {
            return Err(ConfigurationError::LeastAttraction);
        }
        if let Attraction::Improved { least, .. } = &mut self.attraction {
            *least = share;
        }
        Ok(self)
    }

    /// Iterations in which the attraction of the improved form decays by e (tau); the standard form has none.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub const fn decay(mut self, iterations: f32) -> Result<Self, ConfigurationError> {
        if !(iterations >= f32::MIN_POSITIVE && iterations <= f32::MAX) {
            return Err(ConfigurationError::Decay);
        }
        if let Attraction::Improved { decay, .. } = &mut self.attraction {
            *decay = iterations;
        }
        Ok(self)
    }

    /// How many times every firefly moves.
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

    /// As published, or with the target invariant.
    pub const fn acceptance(mut self, acceptance: Acceptance) -> Self {
        self.acceptance = acceptance;
        self
    }

    /// The most evaluations of the density that a refinement of so many particles takes.
    pub const fn evaluations(&self, particles: usize) -> usize {
        particles.saturating_mul(1 + self.iterations as usize)
    }

    /// exp(-gamma r^2)
    #[inline(always)]
    fn visibility(&self, distance_squared: f32) -> f32 {
        exp(-self.absorption * distance_squared)
    }

    /// The share of its distance from `goal` by which a firefly is drawn to it.
    #[inline(always)]
    fn pull(&self, iteration: u16, goal: f32, log_density: f32, distance_squared: f32) -> f32 {
        let visibility = self.visibility(distance_squared);
        match self.attraction {
            Attraction::Standard => visibility,
            Attraction::Improved { least, decay } => {
                let dimmer = 1.0 - exp(log_density - goal);
                // The brightest of one half may be dimmer than a firefly of the other.
                let dimmer = if dimmer > 0.0 { dimmer } else { 0.0 };
                exp(f32::from(iteration) / -decay) * dimmer * visibility + least
            }
        }
    }

    /// One iteration of the standard form: every firefly flies to the brighter ones where they were, one after
    /// the other, by the attraction of the distance at the beginning.
    fn fly_to_all<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        scale: &Scale<D>,
        grid: &mut Grid<'_, D>,
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

    /// One iteration of the improved form.
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
            let pull = self.pull(iteration, brightness, log_density, dot(offset, offset));
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
        // That of the uniform flutter: its width over the square root of twelve.
        let deviation = 0.288_675_13 * self.flutter;
        for i in members {
            let goal = match self.attraction {
                Attraction::Improved { .. } => brightest,
                Attraction::Standard => others(population.len(), i, rng).map(|[other]| other),
            };
            let Some(goal) = goal else {
                continue;
            };
            let brightness = population.log_density(goal);
            let pull = |log_density, offset: [f32; D]| {
                self.pull(iteration, brightness, log_density, dot(offset, offset))
            };
            let here = population.state(i);
            let offset = scale.measure(difference(population.state(goal), here));
            // Drawn to the goal or, half of the times, away from it: each is the other's way back.
            let sign = if uniform(rng) < 0.5 { 1.0 } else { -1.0 };
            let there = sign * pull(population.log_density(i), offset);
            let flutter = scale.noise(rng).map(|x| deviation * x);
            let mut flown = flutter;
            for (flown, offset) in flown.iter_mut().zip(offset) {
                *flown += there * offset;
            }
            let trial = population.trial(scale.away(here, 1.0, flown));
            // What the flutter would have to be on the way back.
            let offset = difference(offset, flown);
            let back = -sign * pull(trial.log_density, offset);
            let mut flutter_back = flown.map(|x| -x);
            for (flutter, offset) in flutter_back.iter_mut().zip(offset) {
                *flutter -= back * offset;
            }
            let way_back = 0.5 * (dot(flutter, flutter) - dot(flutter_back, flutter_back))
                / (deviation * deviation);
            population.metropolis(i, &trial, way_back, rng);
        }
    }
}

impl<const D: usize> Refinement<D> for Firefly {
    fn refine<R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        workspace: &mut Workspace<'_, D>,
        rng: &mut R,
    ) -> Report {
        let mut population = Population::new(columns, target, workspace.log_densities);
        let scale = population.scale(self.lengths, 0..population.len());
        for iteration in 0..self.iterations {
            population.report.iterations += 1;
            match (self.acceptance, self.attraction) {
                (Acceptance::Greedy, Attraction::Standard) => {
                    self.fly_to_all(&mut population, &scale, &mut workspace.grid, rng);
                }
                (Acceptance::Greedy, Attraction::Improved { .. }) => {
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
        Self::evaluations(self, particles)
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
        let swarm = Firefly::standard(Lengths::Absolute, 0.5, f32::MIN_POSITIVE).unwrap();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(88);
        let mut memory = Memory::<1, 2>::new();
        for tenth in 1..100 {
            let distance = 0.1 * tenth as f32;
            let mut x = [0.0, distance];
            let workspace = &mut memory.workspace();
            swarm.refine(&mut [&mut x], &brighter_to_the_right, workspace, &mut rng);
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
    fn settings_are_checked() {
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            let swarm = Firefly::standard(Lengths::Absolute, bad, 0.1);
            assert_eq!(swarm, Err(ConfigurationError::Absorption));
        }
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let swarm = Firefly::improved(Lengths::Absolute, 1.0, bad);
            assert_eq!(swarm, Err(ConfigurationError::Flutter));
            let swarm = Firefly::improved(Lengths::Absolute, 1.0, 0.1).unwrap();
            assert_eq!(swarm.decay(bad), Err(ConfigurationError::Decay));
        }
        let swarm = Firefly::improved(Lengths::Relative, 0.0, 0.1).unwrap();
        for bad in [-0.1, 1.1, f32::NAN] {
            let result = swarm.least_attraction(bad);
            assert_eq!(result, Err(ConfigurationError::LeastAttraction));
        }
        assert_eq!(swarm.iterations(0), Err(ConfigurationError::Iterations));
        assert_eq!(swarm.iterations(7).unwrap().evaluations(10), 80);
    }
}
