//! Differential evolution.
//!
//! Storn and Price (1997), as Li, Wang and Wang apply it to the particles of a filter in place of resampling: Journal
//! of Electronics & Information Technology 33(7), 2011. A mutant `F1 X_r1 + F2 (X_r2 - X_r3)` of three other
//! particles gives its genes, the dimensions of the state, to a particle with a probability of Cr each, at least
//! one; the better of the two lives on.
//!
//! Eq. 11 of the paper keeps the one whose objective is *smaller*. With weights as the objective that would be
//! the worse: here the greater density lives on.
//!
//! The form that leaves the target invariant is the differential evolution Markov chain of ter Braak (2006): a
//! particle moves by the difference of two others, which comes with either sign equally often, so the way back is
//! as likely as the way there. The scale of its steps is that of the cloud by itself, correlations included.

use core::ops::Range;

use super::lengths::Lengths;
use super::population::{Population, Report, halves, others};
use super::refinement::{Acceptance, Memory, Refinement};
use crate::ConfigError;
use crate::config::{require, require_positive, require_within};
use crate::math::sqrt;
use crate::math::vector::{difference, plus_scaled};
use crate::model::Likelihood;
use crate::random::{Rng, uniform};

/// Particles that evolve.
///
/// Takes four of them; fewer stay as they are.
///
/// With [`Acceptance::Metropolis`] a particle moves by `gamma (X_r1 - X_r2)`, with gamma 2.38 / sqrt(2 d) for d genes,
/// and a little noise. One step in ten has gamma 1, to jump between modes, and one in ten is a snooker update
/// (ter Braak and Vrugt 2008) along the line through a third particle. The weights F1 and F2 have no meaning.
///
/// One generation takes 270 modelled cycles of a Cortex-M4F a particle of two dimensions (530 with Metropolis) and a
/// cheap density.
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
/// use foxhunt::refine::{DifferentialEvolution, Memory, Refinement};
///
/// // A sample of a normal distribution that is much too wide.
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut x = [0.0; 100];
/// x.fill_with(|| 10.0 * normal(&mut rng));
/// let target = |[x]: &[f32; 1]| -0.5 * x * x;
///
/// const CHAIN: DifferentialEvolution =
///     foxhunt::config!(DifferentialEvolution { generations: 100, ..DifferentialEvolution::METROPOLIS });
/// let mut memory = Memory::<1, 100>::EMPTY;
/// CHAIN.refine(&mut [&mut x], &target, &mut memory, &mut rng);
/// // Now it is neither too wide nor too narrow.
/// let variance = x.iter().map(|x| x * x).sum::<f32>() / 100.0;
/// assert!((variance - 1.0).abs() < 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DifferentialEvolution {
    /// F1: the weight of the particle that a mutant is made of.
    pub base_weight: f32,
    /// F2: the weight of the difference that is added to it.
    pub difference_weight: f32,
    /// Cr: the probability that a gene comes from the mutant.
    pub crossover: f32,
    /// How many times every particle meets a mutant.
    pub generations: u16,
    /// As published, or with the target invariant.
    pub acceptance: Acceptance,
}

/// Sigma of the noise of a Markov chain, as a fraction of that of the particles: it frees the chain from the lattice
/// of differences between the particles that it began with.
const NOISE: f32 = 0.01;

impl DifferentialEvolution {
    /// As published by Li, Wang and Wang: F1 = 1, F2 = 0.9, Cr = 0.6, 20 generations.
    pub const DEFAULT: Self = Self {
        base_weight: 1.0,
        difference_weight: 0.9,
        crossover: 0.6,
        generations: 20,
        acceptance: Acceptance::Greedy,
    };

    /// Evolution that leaves the target invariant. Each particle is offered four places.
    pub const METROPOLIS: Self = Self {
        generations: 4,
        acceptance: Acceptance::Metropolis,
        ..Self::DEFAULT
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_positive!(self: base_weight, difference_weight);
        require_within!(self: crossover 0.0..=1.0);
        require!(self.generations > 0, "generations is zero");
        Ok(())
    }

    /// Which genes come from the mutant: at least one.
    #[inline(always)]
    fn genes<const D: usize, R: Rng + ?Sized>(&self, rng: &mut R) -> [bool; D] {
        let certain = (uniform(rng) * D as f32) as usize;
        let mut genes = [false; D];
        for (d, gene) in genes.iter_mut().enumerate() {
            *gene = (uniform(rng) < self.crossover) | (d == certain);
        }
        genes
    }

    /// One generation as published.
    fn evolve<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        rng: &mut R,
    ) {
        for i in 0..population.len() {
            let Some(parents) = others::<3, R>(population.len(), i, rng) else {
                return;
            };
            let [base, plus, minus] = parents.map(|parent| population.state(parent));
            let mutant = difference(plus, minus).map(|x| self.difference_weight * x);
            let mutant = plus_scaled(mutant, self.base_weight, base);
            let child = inherit(population.state(i), mutant, self.genes(rng));
            let trial = population.trial(child);
            population.improve(i, &trial);
        }
    }

    /// One generation of one half that leaves the target invariant.
    fn wander<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        (members, rest): (Range<usize>, Range<usize>),
        rng: &mut R,
    ) {
        let scale = population.scale(Lengths::Relative, rest);
        for i in members {
            let Some([a, b, anchor]) = others(population.len(), i, rng) else {
                return;
            };
            let kind = uniform(rng);
            if kind < 0.1 {
                population.snooker(i, population.state(anchor), &scale, rng);
                continue;
            }
            let genes: [bool; D] = self.genes(rng);
            let count = genes.iter().filter(|gene| **gene).count();
            let gamma = if kind < 0.2 {
                1.0
            } else {
                2.38 / sqrt(2.0 * count as f32)
            };
            let here = population.state(i);
            let mutant = scale.away(here, NOISE, scale.noise(rng));
            let apart = difference(population.state(a), population.state(b));
            let mutant = plus_scaled(mutant, gamma, apart);
            let trial = population.trial(inherit(here, mutant, genes));
            population.metropolis(i, &trial, 0.0, rng);
        }
    }
}

/// The particle with some genes of the mutant.
#[inline(always)]
fn inherit<const D: usize>(mut particle: [f32; D], mutant: [f32; D], genes: [bool; D]) -> [f32; D] {
    for ((x, mutated), from_mutant) in particle.iter_mut().zip(mutant).zip(genes) {
        if from_mutant {
            *x = mutated;
        }
    }
    particle
}

impl<const D: usize> Refinement<D> for DifferentialEvolution {
    fn refine<const N: usize, R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report {
        let mut population = Population::new(columns, target, &mut memory.log_densities);
        for _ in 0..self.generations {
            population.report.iterations += 1;
            match self.acceptance {
                Acceptance::Greedy => self.evolve(&mut population, rng),
                Acceptance::Metropolis => {
                    for half in halves(population.len()) {
                        self.wander(&mut population, half, rng);
                    }
                }
            }
        }
        population.report
    }

    fn evaluations(&self, particles: usize) -> usize {
        particles.saturating_mul(1 + usize::from(self.generations))
    }

    fn check(&self) -> Result<(), ConfigError> {
        Self::check(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_out_of_range_are_named() {
        type Evolution = DifferentialEvolution;
        let field = |evolution: Evolution| evolution.check().unwrap_err().field();
        let evolution = Evolution::DEFAULT;
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let (base_weight, difference_weight) = (bad, bad);
            let base = Evolution {
                base_weight,
                ..evolution
            };
            assert_eq!(field(base), "base_weight");
            let difference = Evolution {
                difference_weight,
                ..evolution
            };
            assert_eq!(field(difference), "difference_weight");
        }
        for crossover in [-0.1, 1.1, f32::NAN] {
            assert_eq!(
                field(Evolution {
                    crossover,
                    ..evolution
                }),
                "crossover"
            );
        }
        let none = Evolution {
            generations: 0,
            ..evolution
        };
        assert_eq!(field(none), "generations");
        let [none, all] = [0.0, 1.0].map(|crossover| Evolution {
            crossover,
            ..evolution
        });
        for preset in [evolution, Evolution::METROPOLIS, none, all] {
            assert_eq!(preset.check(), Ok(()));
        }
        assert_eq!(Refinement::<1>::evaluations(&evolution, 10), 210);
    }
}
