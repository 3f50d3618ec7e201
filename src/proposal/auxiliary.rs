//! The fully adapted auxiliary particle filter.

use super::Transition;
use super::grid::{Grid, reach};
use super::moments::Moments;
use crate::filter::UpdateError;
use crate::math::exp;
use crate::model::Likelihood;
use crate::particles::{Particles, read};
use crate::random::{Rng, uniform};
use crate::weights::{self, Weights};

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
/// Takes 4 N (4 D + 3) bytes and a few more. The grid has `G` cells, which the caller lends: at least 16 in one
/// dimension; in two, `G` is a square, at least 256. Each particle evaluates the model on it about three times a step,
/// at most thirteen times.
///
/// A likelihood with the tails of an outlier needs no gate here.
///
/// ```
/// use foxhunt_problems::gamma;
/// use foxhunt::proposal::AuxiliaryFilter;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
/// let mut filter = AuxiliaryFilter::<1, 10>::EMPTY;
/// filter.initialise(&mut rng, |_| [gamma::START]);
/// for (dynamics, truth, measurement) in gamma::simulate(0.04, 1e-5, &mut nature).take(50) {
///     filter.step(&dynamics, &measurement, 1.0, &mut [0.0; 64], &mut rng).unwrap();
///     assert!((filter.mean()[0] - truth).abs() < 0.1);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct AuxiliaryFilter<const D: usize, const N: usize> {
    particles: Particles<D, N>,
    weights: Weights<N>,
    next: Next<D, N>,
    grids: [Grid<D>; N],
    posterior: Moments<D>,
}

/// The cloud in the making.
#[derive(Debug, Clone)]
struct Next<const D: usize, const N: usize> {
    particles: Particles<D, N>,
    log_weights: [f32; N],
    /// How many particles there are already.
    count: usize,
    /// From where a walk along the weights stands to the next tooth: there is one at every whole number from a random
    /// start, and each becomes a particle.
    tooth: f32,
}

impl<const D: usize, const N: usize> AuxiliaryFilter<D, N> {
    /// All particles at the origin, with equal weights, in bits that are all zero. [`AuxiliaryFilter::initialise`] it.
    pub const EMPTY: Self = Self {
        particles: Particles::EMPTY,
        weights: Weights::EMPTY,
        next: Next {
            particles: Particles::EMPTY,
            log_weights: [0.0; N],
            count: 0,
            tooth: 0.0,
        },
        grids: [Grid::NONE; N],
        posterior: Moments::NONE,
    };

    /// Draws the state of every particle from `draw`, the prior, and makes their weights equal.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        self.particles.initialise(rng, draw);
        self.weights.make_equal();
        self.posterior = Moments::NONE;
        for i in 0..N {
            let state = read(&self.particles.columns(), i);
            self.posterior.add(&Moments::point(state), 0.0);
        }
    }

    /// Goes `dt` seconds ahead to a measurement, and returns its log-evidence, as
    /// [`crate::filter::ParticleFilter::update`] does. If there is no measurement, pass one that every state explains:
    /// `&|_: &[f32; D]| 0.0`.
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
        let log_density = |from: [f32; D], to: &[f32; D]| {
            likelihood.log_likelihood(to) + transition.log_transition(&from, to, dt)
        };
        let posterior = self.look_ahead((transition, dt), &log_density, memory);
        let (_, first_stage) = self.weights.columns_mut();
        let Some(normalised) = weights::normalise(&mut self.next.log_weights, first_stage) else {
            return Err(self.refuse());
        };
        let log_evidence = normalised.shift + normalised.log_sum - self.weights.log_sum();
        self.draw(&log_density, memory, rng);
        self.exchange_log_weights();
        if self.weights.normalise().is_err() {
            self.exchange_log_weights();
            return Err(self.refuse());
        }
        core::mem::swap(&mut self.particles, &mut self.next.particles);
        self.posterior = posterior;
        Ok(log_evidence)
    }

    /// Fits a grid to what each particle may become, and sets the next log-weight to that of all of it together. Returns
    /// the moments of the posterior.
    fn look_ahead<const G: usize>(
        &mut self,
        (transition, dt): (&impl Transition<D>, f32),
        log_density: &impl Fn([f32; D], &[f32; D]) -> f32,
        memory: &mut [f32; G],
    ) -> Moments<D> {
        let sigmas = transition.noise(dt).sigmas();
        let mut posterior = Moments::NONE;
        let columns = self.particles.columns();
        let log_weights = self.weights.log_weights().iter();
        for (i, ((log_weight, next), place)) in log_weights
            .zip(&mut self.next.log_weights)
            .zip(&mut self.grids)
            .enumerate()
        {
            let from = read(&columns, i);
            let (low, high) = reach(transition.mean(&from, dt), sigmas);
            let grid = Grid::fit(low, high, |to| log_density(from, to), memory);
            let local = grid.moments(memory);
            posterior.add(&local, *log_weight);
            *next = log_weight + local.log_mass();
            *place = grid;
        }
        posterior
    }

    /// Draws the next particles, from ancestors that the weights of the first stage choose systematically.
    fn draw<const G: usize, R: Rng + ?Sized>(
        &mut self,
        log_density: &impl Fn([f32; D], &[f32; D]) -> f32,
        memory: &mut [f32; G],
        rng: &mut R,
    ) {
        (self.next.count, self.next.tooth) = (0, uniform(rng));
        let weights = self.weights.weights().iter();
        for (i, (grid, weight)) in self.grids.iter().zip(weights).enumerate() {
            let expected = weight * N as f32;
            if self.next.tooth < expected {
                let copies = (expected - self.next.tooth) as usize + 1;
                let from = read(&self.particles.columns(), i);
                let target = |to: &[f32; D]| log_density(from, to);
                self.next.draw(copies, grid, target, memory, rng);
            }
            self.next.tooth -= expected;
        }
        self.next.fill_up();
    }

    fn exchange_log_weights(&mut self) {
        core::mem::swap(self.weights.log_weights_mut(), &mut self.next.log_weights);
    }

    /// Makes the weights again those of the particles.
    fn refuse(&mut self) -> UpdateError {
        let _ = self.weights.normalise();
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

    /// The states.
    pub fn particles(&self) -> &Particles<D, N> {
        &self.particles
    }

    /// The weights, which sum to one after [`AuxiliaryFilter::initialise`].
    pub fn weights(&self) -> &[f32] {
        self.weights.weights()
    }

    /// Natural log-weights with an arbitrary common offset.
    pub fn log_weights(&self) -> &[f32] {
        self.weights.log_weights()
    }
}

impl<const D: usize, const N: usize> Next<D, N> {
    /// Draws so many successors of one particle, or as many as there is room for: one from each of as many equal parts of
    /// the density on its grid.
    fn draw<const G: usize, R: Rng + ?Sized>(
        &mut self,
        copies: usize,
        grid: &Grid<D>,
        target: impl Fn(&[f32; D]) -> f32,
        memory: &mut [f32; G],
        rng: &mut R,
    ) {
        grid.evaluate(&target, memory);
        let log_sum = grid.moments(memory).log_mass() - grid.ln_cell();
        for copy in 0..copies.min(N - self.count.min(N)) {
            let quantile = (copy as f32 + uniform(rng)) / copies as f32;
            let cells = grid.centres::<G>().zip(&*memory);
            let Some((centre, log_density, rest)) = cell_at(quantile, cells, log_sum) else {
                break;
            };
            let mut part = [rest; D];
            for part in part.iter_mut().skip(1) {
                *part = uniform(rng);
            }
            // The last dimension runs fastest, so the rest of the quantile is its own.
            part.reverse();
            let to = grid.within(centre, part);
            self.place(to, target(&to) - log_density);
        }
    }

    /// Rounding may leave a tooth behind the end: it belongs to the last particle.
    fn fill_up(&mut self) {
        let last = self.count.saturating_sub(1);
        if let Some(state) = self.particles.get(last) {
            let log_weight = self.log_weights.get(last).copied().unwrap_or(0.0);
            while self.count < N {
                self.place(state, log_weight);
            }
        }
    }

    fn place(&mut self, state: [f32; D], log_weight: f32) {
        self.particles.set(self.count, state);
        if let Some(place) = self.log_weights.get_mut(self.count) {
            *place = log_weight;
        }
        self.count += 1;
        self.tooth += 1.0;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    /// Where a quantile falls in three cells, of which the last has nothing.
    fn cell(quantile: f32) -> Option<([f32; 1], f32)> {
        let logs = [0.25_f32.ln(), 0.75_f32.ln(), f32::NEG_INFINITY];
        let cells = [[1.0], [2.0], [3.0]].into_iter().zip(&logs);
        cell_at(quantile, cells, 0.0).map(|(centre, _, fraction)| (centre, fraction))
    }

    #[test]
    fn a_quantile_falls_into_the_cell_that_has_it() {
        let (centre, fraction) = cell(0.125).unwrap();
        assert_eq!(centre, [1.0]);
        assert!((fraction - 0.5).abs() < 1e-6);
        let (centre, fraction) = cell(0.4375).unwrap();
        assert_eq!(centre, [2.0]);
        assert!((fraction - 0.25).abs() < 1e-6);
    }

    #[test]
    fn there_are_as_many_successors_as_there_is_room_for() {
        let mut filter = AuxiliaryFilter::<1, 4>::EMPTY;
        let next = &mut filter.next;
        next.place([7.0], -0.5);
        // Nobody was drawn where two are missing.
        next.place([8.0], -1.5);
        next.fill_up();
        assert_eq!(next.count, 4);
        assert_eq!(next.particles.columns()[0], [7.0, 8.0, 8.0, 8.0]);
        assert_eq!(next.log_weights, [-0.5, -1.5, -1.5, -1.5]);

        let mut memory = [0.0; 16];
        let grid = Grid::fit([0.0], [1.0], |_| 0.0, &mut memory);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        next.count = 2;
        next.draw(5, &grid, |_| 0.0, &mut memory, &mut rng);
        assert_eq!(next.count, 4);
    }

    #[test]
    fn a_quantile_behind_the_end_falls_into_the_last_cell_that_has_anything() {
        assert_eq!(cell(1.01), Some(([2.0], 1.0)));
        assert_eq!(cell_at::<1>(0.5, core::iter::empty(), 0.0), None);
    }
}
