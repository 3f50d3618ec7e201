//! The tempered point mass filter.

use super::Transition;
use super::grid::{Grid, reach, side};
use super::moments::Moments;
use super::posterior::Posterior;
use crate::filter::UpdateError;
use crate::math::exp;
use crate::model::Likelihood;
use crate::particles::{Particles, read};

/// A filter that carries the posterior of one or two dimensions as `N` points with weights, and leaves nothing to
/// chance.
///
/// Each step works out the posterior density on a transient grid, transitions of all points times likelihood, and
/// keeps `N` points of it: it cuts the grid into parts that hold as much each of the *square root* of the density,
/// and keeps the mass and the mean of each. Between points in proportion to the density, which neglect its tails,
/// and equally spaced ones, the square root is near the best for what a step of noise then smooths.
///
/// What lies between the points is lost, so the noise of the transition must bridge the gaps in every dimension: in a
/// line 50 points are as good as the exact filter where a step moves the state by a tenth of its uncertainty; in the
/// plane 100 points stay within a tenth of a sigma of it where a step is as large as the uncertainty. A state that
/// does not move belongs to another filter.
///
/// Takes 4 N (D + 1) bytes and a few more; the grid has `G` cells, which the caller lends. `N G` transitions for each
/// of about three rounds, at most twelve.
///
/// ```
/// use foxhunt_problems::growth;
/// use foxhunt::proposal::PointMassFilter;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut nature = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut filter = PointMassFilter::<1, 50>::EMPTY;
/// filter.initialise_at([growth::START]);
/// for (dynamics, truth, measurement) in growth::simulate(&mut nature).take(50) {
///     filter.step(&dynamics, &measurement, 1.0, &mut [0.0; 256]).unwrap();
///     let [[variance]] = filter.covariance();
///     assert!((filter.mean()[0] - truth).powi(2) < 25.0 * variance);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct PointMassFilter<const D: usize, const N: usize> {
    points: Particles<D, N>,
    /// Of the masses of the points.
    log_weights: [f32; N],
    /// How many points are used.
    count: usize,
    posterior: Moments<D>,
}

impl<const D: usize, const N: usize> PointMassFilter<D, N> {
    /// No points at all, in bits that are all zero: to be told a state or a prior.
    pub const EMPTY: Self = Self {
        points: Particles::EMPTY,
        log_weights: [0.0; N],
        count: 0,
        posterior: Moments::NONE,
    };

    /// Starts from a state that is known exactly.
    pub fn initialise_at(&mut self, state: [f32; D]) {
        self.posterior = Moments::point(state);
        self.count = 0;
        self.keep(&Moments::point(state), 0.0);
    }

    /// Starts from a prior: its log-density, up to a constant, within the box from `low` to `high`.
    ///
    /// # Errors
    /// When there is no mass in the box; the filter is then as before.
    pub fn initialise<const G: usize>(
        &mut self,
        low: [f32; D],
        high: [f32; D],
        log_density: impl Fn(&[f32; D]) -> f32,
        memory: &mut [f32; G],
    ) -> Result<(), UpdateError> {
        let grid = Grid::fit(low, high, log_density, memory);
        self.take(&grid, memory).map(drop)
    }

    /// Goes `dt` seconds ahead to a measurement, and returns its log-evidence, as
    /// [`crate::filter::ParticleFilter::update`] does. If there is no measurement, pass one that every state explains:
    /// `&|_: &[f32; D]| 0.0`.
    ///
    /// # Errors
    /// When no state that can be reached explains the measurement; the filter is then as before.
    pub fn step<const G: usize>(
        &mut self,
        transition: &impl Transition<D>,
        likelihood: &impl Likelihood<D>,
        dt: f32,
        memory: &mut [f32; G],
    ) -> Result<f32, UpdateError> {
        let columns = self.points.columns();
        let sigmas = transition.noise(dt).sigmas();
        let (mut low, mut high) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
        for i in 0..self.count {
            let reached = reach(transition.mean(&read(&columns, i), dt), sigmas);
            for d in 0..D {
                low[d] = low[d].min(reached.0[d]);
                high[d] = high[d].max(reached.1[d]);
            }
        }
        let posterior = Posterior {
            transition,
            dt,
            columns,
            log_weights: self.log_weights(),
            likelihood,
        };
        let grid = Grid::fit(low, high, |x| posterior.log_likelihood(x), memory);
        self.take(&grid, memory)
    }

    /// Becomes the density on a grid, and returns the logarithm of its mass.
    fn take<const G: usize>(
        &mut self,
        grid: &Grid<D>,
        memory: &[f32; G],
    ) -> Result<f32, UpdateError> {
        let whole = grid.moments(memory);
        let log_mass = whole.log_mass();
        if log_mass.is_nan() || log_mass == f32::NEG_INFINITY {
            return Err(UpdateError::AllWeightsZero);
        }
        self.posterior = whole;

        self.count = 0;
        let largest = memory.iter().fold(f32::NEG_INFINITY, |a, b| a.max(*b));
        let root = |log_density: f32| exp(0.5 * (log_density - largest));

        // A plane is cut into strips of rows, and each strip into parts; a line is one strip of one row.
        let side = const { side::<D, G>() };
        let (rows, strips) = if D == 1 { (1, 1) } else { (side, N.isqrt()) };
        let parts = N / strips;
        let cell = |row: usize, k: usize| memory.get(row * side + k).map_or(0.0, |l| root(*l));
        let of_row = |row: usize| (0..side).map(|k| cell(row, k)).sum::<f32>();
        let mut cut = Cut::new((0..rows).map(of_row).sum(), strips);
        let mut strip = 0..0;
        while strip.end < rows {
            let start = strip.end;
            let index = cut.part(of_row(start));
            let mut next = cut;
            strip = start..start + 1;
            while strip.end < rows && next.part(of_row(strip.end)) == index {
                cut = next;
                strip.end += 1;
            }
            let total = strip.clone().map(of_row).sum();
            let mut cut = Cut::new(total, parts);
            let mut part = 0;
            let mut moments = Moments::NONE;
            for k in 0..side {
                for row in strip.clone() {
                    let index = cut.part(cell(row, k));
                    if index != part {
                        self.keep(&moments, grid.ln_cell() - log_mass);
                        moments = Moments::NONE;
                        part = index;
                    }
                    let place = core::array::from_fn(|d| if d + 1 == D { k } else { row } as u32);
                    let log_density = memory.get(row * side + k).copied();
                    moments.add(
                        &Moments::point(grid.centre(place)),
                        log_density.unwrap_or(f32::NEG_INFINITY),
                    );
                }
            }
            self.keep(&moments, grid.ln_cell() - log_mass);
        }
        Ok(log_mass)
    }

    /// Makes a part the next point, unless it is empty.
    fn keep(&mut self, part: &Moments<D>, log_unit: f32) {
        let log_weight = part.log_mass() + log_unit;
        if let Some(place) = self.log_weights.get_mut(self.count)
            && log_weight > f32::NEG_INFINITY
        {
            *place = log_weight;
            self.points.set(self.count, part.mean());
            self.count += 1;
        }
    }

    /// Mean of the state.
    pub fn mean(&self) -> [f32; D] {
        self.posterior.mean()
    }

    /// Covariance of the state.
    pub fn covariance(&self) -> [[f32; D]; D] {
        self.posterior.covariance()
    }

    /// The points, one column per dimension.
    pub fn columns(&self) -> [&[f32]; D] {
        let columns = self.points.columns();
        columns.map(|column| column.get(..self.count).unwrap_or_default())
    }

    /// The log-weights of the points, which are those of their masses.
    pub fn log_weights(&self) -> &[f32] {
        self.log_weights.get(..self.count).unwrap_or_default()
    }
}

/// Cuts a row of cells into parts of equal sums, as nearly as whole cells can.
#[derive(Clone, Copy)]
struct Cut {
    sum: f32,
    per_unit: f32,
    parts: usize,
}

impl Cut {
    fn new(total: f32, parts: usize) -> Self {
        Self {
            sum: 0.0,
            per_unit: parts as f32 / total,
            parts,
        }
    }

    /// The part to which the next cell belongs: that of its middle.
    fn part(&mut self, cell: f32) -> usize {
        let middle = self.sum + 0.5 * cell;
        self.sum += cell;
        ((middle * self.per_unit) as usize).min(self.parts - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_of_the_part_that_has_its_middle() {
        let mut cut = Cut::new(8.0, 4);
        let cells = [1.0, 1.0, 1.5, 2.0, 0.4, 2.1, 0.2];
        // Their middles: 0.5, 1.5, 2.75, 4.5, 5.7, 6.95, and what rounding has left over.
        assert_eq!(cells.map(|cell| cut.part(cell)), [0, 0, 1, 2, 2, 3, 3]);
    }
}
