//! The fully adapted auxiliary particle filter.

use super::Transition;
use super::grid::{Grid, reach};
use super::moments::Moments;
use crate::filter::UpdateError;
use crate::math::{exp, ln};
use crate::model::Likelihood;
use crate::particles::{Particles, read};
use crate::random::{Rng, uniform};
use crate::weights;

/// A particle filter of `N` particles with a state of one or two dimensions that knows how well each particle will
/// explain the measurement before it moves, and moves it accordingly.
///
/// Pitt and Shephard, "Filtering via simulation: auxiliary particle filters" (1999), fully adapted: what their
/// section 3 has in closed form for some models, transition times likelihood of each particle, is worked out on a
/// small grid here. Ancestors are chosen systematically; the successors of one are drawn from equal parts of its
/// density. The grid's coarseness does not bias the particles: each is weighed by the density where it is over that at
/// the centre of its cell.
/// The estimate is the mean over the grids of all particles, taken before any of them is drawn.
///
/// Takes 4 N (4 D + 3) bytes and a few more. The grid has `G` cells, which the caller lends; each particle evaluates
/// the model on it about three times a step, at most thirteen times.
///
/// ```
/// use foxhunt::problems::gamma;
/// use foxhunt::proposal::AuxiliaryFilter;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
/// let mut filter = AuxiliaryFilter::<1, 10>::new();
/// filter.initialise(&mut rng, |_| [gamma::START]);
/// for (dynamics, truth, measurement) in gamma::simulate(0.04, 1e-5, &mut nature).take(50) {
///     filter.step(&dynamics, &measurement, 1.0, &mut [0.0; 64], &mut rng).unwrap();
///     assert!((filter.mean()[0] - truth).abs() < 0.1);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct AuxiliaryFilter<const D: usize, const N: usize> {
    particles: Particles<D, N>,
    /// Where the next cloud is made.
    next: Particles<D, N>,
    weights: [f32; N],
    log_sum: f32,
    grids: [Grid<D>; N],
    posterior: Moments<D>,
}

impl<const D: usize, const N: usize> AuxiliaryFilter<D, N> {
    /// All particles at the origin, with equal weights.
    pub const fn new() -> Self {
        Self {
            particles: Particles::new(),
            next: Particles::new(),
            weights: [1.0 / N as f32; N],
            log_sum: ln(N as f32),
            grids: [Grid::NONE; N],
            posterior: Moments::NONE,
        }
    }

    /// Draws the state of every particle from `draw`, the prior, and makes their weights equal.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        self.particles.initialise(rng, draw);
        self.weights = [1.0 / N as f32; N];
        self.log_sum = ln(N as f32);
        self.posterior = Moments::NONE;
        for i in 0..N {
            let state = read(&self.particles.columns(), i);
            self.posterior.add(&Moments::point(state), 0.0);
        }
    }

    /// Goes `dt` seconds ahead to a measurement, and returns its log-evidence, as
    /// [`crate::filter::ParticleFilter::update`] does.
    ///
    /// # Errors
    /// When no particle can reach a state that explains the measurement; the filter is then as before.
    pub fn step<const G: usize, R: Rng + ?Sized>(
        &mut self,
        transition: &impl Transition<D>,
        likelihood: &impl Likelihood<D>,
        dt: f32,
        memory: &mut [f32; G],
        rng: &mut R,
    ) -> Result<f32, UpdateError> {
        let target = |from: [f32; D]| {
            move |to: &[f32; D]| {
                likelihood.log_likelihood(to) + transition.log_transition(&from, to, dt)
            }
        };
        let deviations = transition.noise(dt).deviations();
        let mut posterior = Moments::NONE;
        let columns = self.particles.columns();
        let first_stage = self.particles.log_weights().iter();
        for (i, ((log_weight, next), place)) in first_stage
            .zip(self.next.log_weights_mut())
            .zip(&mut self.grids)
            .enumerate()
        {
            let from = read(&columns, i);
            let (low, high) = reach(transition.mean(&from, dt), deviations);
            let grid = Grid::fit(low, high, target(from), memory);
            let local = grid.moments(memory);
            posterior.add(&local, *log_weight);
            *next = log_weight + local.log_mass();
            *place = grid;
        }
        let Some(first_stage) = weights::normalise(self.next.log_weights_mut(), &mut self.weights)
        else {
            return Err(self.refuse());
        };

        let mut comb = Comb {
            tooth: uniform(rng),
            slot: 0,
        };
        for (i, (grid, weight)) in self.grids.iter().zip(&self.weights).enumerate() {
            let share = weight * N as f32;
            if comb.tooth < share {
                let target = target(read(&columns, i));
                grid.evaluate(target, memory);
                let log_sum = grid.moments(memory).log_mass() - grid.ln_cell();
                let cells = || grid.centres::<G>().zip(&*memory);
                // One from each of as many equal parts of the local density as there are copies.
                let copies = (share - comb.tooth) as usize + 1;
                for copy in 0..copies.min(N - comb.slot.min(N)) {
                    let quantile = (copy as f32 + uniform(rng)) / copies as f32;
                    let Some((centre, log_density, rest)) = cell_at(quantile, cells(), log_sum)
                    else {
                        break;
                    };
                    let mut part = [rest; D];
                    for part in part.iter_mut().skip(1) {
                        *part = uniform(rng);
                    }
                    // The last dimension runs fastest, so the rest of the quantile is its own.
                    part.reverse();
                    let to = grid.within(centre, part);
                    comb.place(&mut self.next, to, target(&to) - log_density);
                }
            }
            comb.tooth -= share;
        }
        // Rounding may leave a tooth behind the end: it belongs to the last particle.
        let last = comb.slot.saturating_sub(1);
        if let Some(state) = self.next.get(last) {
            let log_weight = self.next.log_weights().get(last).copied().unwrap_or(0.0);
            while comb.slot < N {
                comb.place(&mut self.next, state, log_weight);
            }
        }

        let Some(second_stage) = weights::normalise(self.next.log_weights_mut(), &mut self.weights)
        else {
            return Err(self.refuse());
        };
        core::mem::swap(&mut self.particles, &mut self.next);
        let log_evidence = first_stage.shift + first_stage.log_sum - self.log_sum;
        self.log_sum = second_stage.log_sum;
        self.posterior = posterior;
        Ok(log_evidence)
    }

    /// Makes the weights again those of the particles.
    fn refuse(&mut self) -> UpdateError {
        weights::normalise(self.particles.log_weights_mut(), &mut self.weights);
        UpdateError::AllWeightsZero
    }

    /// Mean of the state.
    pub fn mean(&self) -> [f32; D] {
        self.posterior.mean()
    }

    /// Covariance of the state.
    pub fn covariance(&self) -> [[f32; D]; D] {
        self.posterior.covariance()
    }

    /// The states and log-weights.
    pub fn particles(&self) -> &Particles<D, N> {
        &self.particles
    }

    /// The weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }
}

/// The cell in which the `quantile` of a density falls, given the logarithm of its sum over all cells: its centre,
/// its log-density, and how far into the cell.
fn cell_at<'a, const D: usize>(
    quantile: f32,
    cells: impl Iterator<Item = ([f32; D], &'a f32)>,
    log_sum: f32,
) -> Option<([f32; D], f32, f32)> {
    let mut rest = quantile;
    let mut last = None;
    for (centre, log_density) in cells {
        let mass = exp(log_density - log_sum);
        if rest < mass {
            return Some((centre, *log_density, rest / mass));
        }
        rest -= mass;
        if mass > 0.0 {
            last = Some((centre, *log_density, 1.0));
        }
    }
    // Rounding may leave the quantile behind the end.
    last
}

/// A walk along the weights with a tooth at every whole number from a random start, each of which becomes a particle.
struct Comb {
    /// From where the walk stands to the next tooth.
    tooth: f32,
    /// The particle that it becomes.
    slot: usize,
}

impl Comb {
    fn place<const D: usize, const N: usize>(
        &mut self,
        cloud: &mut Particles<D, N>,
        state: [f32; D],
        log_weight: f32,
    ) {
        cloud.set(self.slot, state);
        if let Some(place) = cloud.log_weights_mut().get_mut(self.slot) {
            *place = log_weight;
        }
        self.slot += 1;
        self.tooth += 1.0;
    }
}

impl<const D: usize, const N: usize> Default for AuxiliaryFilter<D, N> {
    fn default() -> Self {
        Self::new()
    }
}
