//! What a fish does in an iteration.

use core::ops::Range;

use super::FishSchool;
use crate::ConfigError;
use crate::math::ln;
use crate::math::vector::{difference, direction, plus_scaled};
use crate::model::Likelihood;
use crate::random::{Rng, uniform};
use crate::refine::lengths::{Scale, anywhere};
use crate::refine::neighbours::{Grid, Mate, Neighbours};
use crate::refine::population::{Population, Report, halves, others};
use crate::refine::refinement::{Acceptance, Memory, Refinement};

/// With [`Acceptance::Metropolis`], this many mates have a centre and a best.
const COMPANIONS: usize = 4;

impl FishSchool {
    /// Where a fish that sees mates swims: the offset of a place that is good and not crowded.
    #[inline(always)]
    fn company<const D: usize, T: Likelihood<D>>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        here: [f32; D],
        neighbours: &Neighbours<'_, D>,
        fish: &Mate<D>,
        scale: &Scale<D>,
        log_crowding: f32,
    ) -> Option<[f32; D]> {
        if fish.met == 0 {
            return None;
        }
        let required = log_crowding + fish.log_density + log_of_count(fish.met);
        let mut goal = None;
        if self.swarm {
            let inverse = 1.0 / f32::from(fish.met);
            let centre = fish.offsets.map(|x| x * inverse);
            let trial = population.trial(scale.away(here, 1.0, centre));
            if trial.log_density > required {
                goal = Some((centre, trial.log_density));
            }
        }
        if self.follow {
            let best = neighbours.best(fish);
            if best.log_density > fish.log_density
                && best.log_density > required
                && goal.is_none_or(|(_, swarm)| best.log_density > swarm)
            {
                return Some(difference(best.position, fish.position));
            }
        }
        goal.map(|(offset, _)| offset)
    }

    /// Searches for prey, and says in which direction to swim.
    #[inline(always)]
    fn prey<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        (here, log_density): ([f32; D], f32),
        scale: &Scale<D>,
        rng: &mut R,
    ) -> [f32; D] {
        for _ in 0..self.tries {
            let (direction, part) = anywhere(rng);
            let trial = population.trial(scale.away(here, self.perception * part, direction));
            if trial.log_density > log_density {
                return direction;
            }
        }
        if self.diagonal {
            [1.0; D]
        } else {
            anywhere(rng).0
        }
    }

    /// One iteration as published: every fish swims by what it saw at the beginning.
    fn swim<const D: usize, const N: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        scale: &Scale<D>,
        grid: &mut Grid<D, N>,
        rng: &mut R,
    ) {
        let mut neighbours = None;
        if self.swarm || self.follow {
            let neighbours =
                neighbours.insert(Neighbours::new(population, scale, self.perception, grid));
            neighbours.meet();
        }
        let mates = neighbours.as_ref().map_or([].as_slice(), Neighbours::mates);
        let log_crowding = ln(self.crowding);
        for k in 0..population.len() {
            let fish = mates.get(k);
            let i = fish.map_or(k, |fish| usize::from(fish.index));
            let here = population.state(i);
            let company = match (&neighbours, fish) {
                (Some(neighbours), Some(fish)) => {
                    self.company(population, here, neighbours, fish, scale, log_crowding)
                }
                _ => None,
            };
            let heading = match company.and_then(direction) {
                Some(heading) => heading,
                None => self.prey(population, (here, population.log_density(i)), scale, rng),
            };
            let far = self.step * uniform(rng);
            let trial = population.trial(scale.away(here, far, heading));
            population.go(i, &trial);
        }
    }

    /// One iteration that leaves the target invariant.
    fn wander<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        (members, rest): (Range<usize>, Range<usize>),
        rng: &mut R,
    ) {
        let scale = population.scale(self.lengths, rest);
        let particles = population.len();
        for i in members {
            let (heading, part) = anywhere(rng);
            let here = population.state(i);
            let trial = population.trial(scale.away(here, self.step * part, heading));
            population.metropolis(i, &trial, 0.0, rng);

            let mut companions = [i; COMPANIONS];
            let mut choose = |rng: &mut R| {
                for companion in &mut companions {
                    // One may be chosen twice. A single fish has itself for company, and stays where it is.
                    [*companion] = others(particles, i, rng).unwrap_or([i]);
                }
                companions
            };
            if self.swarm {
                let centre = centre(choose(rng).map(|j| population.state(j)));
                population.snooker(i, centre, &scale, rng);
            }
            if self.follow {
                let [mut best, rest @ ..] = choose(rng);
                for j in rest {
                    if population.log_density(j) > population.log_density(best) {
                        best = j;
                    }
                }
                population.snooker(i, population.state(best), &scale, rng);
            }
        }
    }

    fn has_settled(&self, before: f32, after: f32) -> bool {
        // False for a threshold of zero, and if no fish was or is anywhere.
        (after - before).abs() < self.threshold
    }
}

impl<const D: usize> Refinement<D> for FishSchool {
    fn refine<const N: usize, R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        memory: &mut Memory<D, N>,
        rng: &mut R,
    ) -> Report {
        let mut population = Population::new(columns, target, &mut memory.log_densities);
        let scale = population.scale(self.lengths, 0..population.len());
        let mut highest = population.highest();
        for _ in 0..self.iterations {
            population.report.iterations += 1;
            match self.acceptance {
                Acceptance::Greedy => {
                    self.swim(&mut population, &scale, &mut memory.grid, rng);
                    let before = highest;
                    highest = population.highest();
                    if self.has_settled(before, highest) {
                        break;
                    }
                }
                // To stop by what was found would not leave the target invariant.
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
        let each = match self.acceptance {
            Acceptance::Greedy => usize::from(self.swarm) + usize::from(self.tries) + 1,
            Acceptance::Metropolis => 1 + usize::from(self.swarm) + usize::from(self.follow),
        };
        particles.saturating_mul(1 + usize::from(self.iterations) * each)
    }

    fn check(&self) -> Result<(), ConfigError> {
        Self::check(self)
    }
}

/// The logarithm of a number of mates.
#[inline(always)]
fn log_of_count(mates: u16) -> f32 {
    // Those of most schools, to save the time.
    const USUAL: [f32; 64] = {
        let mut table = [0.0; 64];
        let mut n = 0;
        while n < 64 {
            table[n] = ln(n as f32);
            n += 1;
        }
        table
    };
    match USUAL.get(usize::from(mates)) {
        Some(logarithm) => *logarithm,
        None => ln(f32::from(mates)),
    }
}

fn centre<const D: usize>(states: [[f32; D]; COMPANIONS]) -> [f32; D] {
    let add = |centre, state| plus_scaled(centre, 1.0 / COMPANIONS as f32, state);
    states.into_iter().fold([0.0; D], add)
}
