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

use core::fmt;
use core::ops::Range;

use super::lengths::{Lengths, Scale, any_direction, difference, direction};
use super::neighbours::{Around, Grid, Mate, Neighbours};
use super::population::{Population, halves, others};
use super::{Acceptance, Refinement, Report, Workspace};
use crate::math::ln;
use crate::model::Likelihood;
use crate::random::{Rng, uniform};

/// A school of fish: each particle is one.
///
/// With [`Acceptance::Metropolis`] a fish must not heed mates because they are near, since it would not be near them
/// on its way back. An iteration is then a step of random length and direction; for a swarm, one along the
/// line through the centre of four mates drawn at random; to follow, one along the line through the best of four:
/// the snooker update of ter Braak and Vrugt (2008). Perception, crowding, tries and threshold have no meaning.
///
/// Neighbours are found by a grid, in time proportional to the number of fish times the number of mates that one
/// sees: 1,300 modelled cycles of a Cortex-M4F for each of 1,000 fish that see a dozen mates. The rest of an
/// iteration takes 600, and a step of the Metropolis form 400 to 600, with a density that costs next to nothing.
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

/// With [`Acceptance::Metropolis`], this many mates have a centre and a best.
const COMPANIONS: usize = 4;

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

    /// Where a fish that sees mates swims: the offset of a place that is good and not crowded.
    #[inline(always)]
    fn company<const D: usize, T: Likelihood<D>>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        fish: &Mate<D>,
        sight: &Sight<D>,
        scale: &Scale<D>,
    ) -> Option<[f32; D]> {
        if sight.mates == 0 {
            return None;
        }
        let required = self.log_crowding + fish.log_density + ln(sight.mates as f32);
        let swarm = if self.behaviour.swarms() {
            let here = population.state(fish.index as usize);
            population
                .trial(scale.away(here, 1.0, sight.centre))
                .log_density
        } else {
            f32::NEG_INFINITY
        };
        let best = sight.best_log_density;
        if self.behaviour.follows()
            && best > required
            && best > swarm
            && let Some(offset) = sight.best
        {
            return Some(offset);
        }
        (swarm > required).then_some(sight.centre)
    }

    /// Searches for prey, and says in which direction to swim.
    #[inline(always)]
    fn prey<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        i: usize,
        scale: &Scale<D>,
        rng: &mut R,
    ) -> [f32; D] {
        let here = population.state(i);
        for _ in 0..self.tries {
            let direction = any_direction(rng);
            let far = self.perception * uniform(rng);
            let trial = population.trial(scale.away(here, far, direction));
            if trial.log_density > population.log_density(i) {
                return direction;
            }
        }
        match self.heading {
            Heading::Random => any_direction(rng),
            Heading::Diagonal => [1.0; D],
        }
    }

    /// One iteration as published: every fish swims by what it saw at the beginning.
    fn swim<const D: usize, T: Likelihood<D>, R: Rng + ?Sized>(
        &self,
        population: &mut Population<'_, '_, D, T>,
        scale: &Scale<D>,
        grid: &mut Grid<'_, D>,
        rng: &mut R,
    ) {
        let go = |population: &mut Population<'_, '_, D, T>, i, company: Option<_>, rng: &mut R| {
            let heading = match company.and_then(direction) {
                Some(heading) => heading,
                None => self.prey(population, i, scale, rng),
            };
            let far = self.step * uniform(rng);
            let trial = population.trial(scale.away(population.state(i), far, heading));
            population.go(i, &trial);
        };
        if self.behaviour == Behaviour::Prey {
            for i in 0..population.len() {
                go(population, i, None, rng);
            }
            return;
        }
        let neighbours = Neighbours::new(population, scale, self.perception, grid);
        for (cell, around) in neighbours.cells() {
            for fish in cell {
                let sight = Sight::of(&neighbours, fish, &around);
                let company = self.company(population, fish, &sight, scale);
                go(population, fish.index as usize, company, rng);
            }
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
            let heading = any_direction(rng);
            let far = self.step * uniform(rng);
            let trial = population.trial(scale.away(population.state(i), far, heading));
            population.metropolis(i, &trial, 0.0, rng);

            let mut companions = [i; COMPANIONS];
            let mut choose = |rng: &mut R| {
                for companion in &mut companions {
                    // One may be chosen twice. A single fish has itself for company, and stays where it is.
                    [*companion] = others(particles, i, rng).unwrap_or([i]);
                }
                companions
            };
            if self.behaviour.swarms() {
                let centre = centre(choose(rng).map(|j| population.state(j)));
                population.snooker(i, centre, &scale, rng);
            }
            if self.behaviour.follows() {
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
    fn refine<R: Rng + ?Sized>(
        &self,
        columns: &mut [&mut [f32]; D],
        target: &impl Likelihood<D>,
        workspace: &mut Workspace<'_, D>,
        rng: &mut R,
    ) -> Report {
        let mut population = Population::new(columns, target, workspace.log_densities);
        let scale = population.scale(self.lengths, 0..population.len());
        let mut highest = population.highest();
        for _ in 0..self.iterations {
            population.report.iterations += 1;
            match self.acceptance {
                Acceptance::Greedy => {
                    self.swim(&mut population, &scale, &mut workspace.grid, rng);
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
        Self::evaluations(self, particles)
    }
}

/// What a fish sees of its mates, itself left out.
struct Sight<const D: usize> {
    mates: u32,
    /// Offset of their centre.
    centre: [f32; D],
    /// Offset of the best of them, if it is better off than the fish.
    best: Option<[f32; D]>,
    best_log_density: f32,
}

impl<const D: usize> Sight<D> {
    #[inline(always)]
    fn of(neighbours: &Neighbours<'_, D>, fish: &Mate<D>, around: &Around<'_, D>) -> Self {
        let mut seen = 0u32;
        let mut sum = [0.0; D];
        let mut best = fish;
        neighbours.within_reach(fish, around, |mate, offset, _| {
            // The fish sees itself, too, without an effect on the sum.
            seen += 1;
            for (sum, offset) in sum.iter_mut().zip(offset) {
                *sum += offset;
            }
            if mate.log_density > best.log_density {
                best = mate;
            }
        });
        let mates = seen.saturating_sub(1);
        let share = 1.0 / mates as f32;
        Self {
            mates,
            centre: sum.map(|x| x * share),
            best: (best.index != fish.index).then(|| difference(best.position, fish.position)),
            best_log_density: best.log_density,
        }
    }
}

fn centre<const D: usize>(states: [[f32; D]; COMPANIONS]) -> [f32; D] {
    let mut centre = [0.0; D];
    for state in states {
        for (centre, x) in centre.iter_mut().zip(state) {
            *centre += x * (1.0 / COMPANIONS as f32);
        }
    }
    centre
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
