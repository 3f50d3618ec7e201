//! The particles of the tag that is being updated, unpacked: columns in steps of the lattice.

use super::comparison::Comparison;
use super::field::Field;
use super::floor::Floor;
use super::motion::{Noise, Step};
use super::stored::{Grain, Stored};
use crate::estimate::Symmetric2;
use crate::fingerprint::Lattice;
use crate::math::exp_of_weight;
use crate::random::{Rng, uniform};

/// Places in steps from the first point of the lattice, velocities in steps a second, and weights up to a common factor.
/// On a map of one row or one column only the first of two columns is in use, for places along it.
#[derive(Debug, Clone)]
pub(super) struct Cloud<const N: usize, F> {
    pub places: [[f32; N]; 2],
    pub velocities: [[f32; N]; 2],
    pub floors: [F; N],
    /// The first points of the cells of the lattice that the places are in, counted through all floors; more than any point
    /// beyond the map.
    pub cells: [u16; N],
    /// Log-likelihoods at first.
    pub weights: [f32; N],
}

/// Sums over the weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    pub weights: f32,
    pub squares: f32,
}

/// Mean and covariance, in steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    pub place: [f32; 2],
    pub velocity: [f32; 2],
    pub covariance: Symmetric2,
}

/// Particles of which the evidence is taken: fewer are work saved, and noise.
const SAMPLE: usize = 10;

/// Log-likelihoods of some of the particles.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// Of those that are on the map.
    log_likelihoods: heapless::Vec<f32, SAMPLE>,
    count: u8,
}

impl Sample {
    pub const EMPTY: Self = Self {
        log_likelihoods: heapless::Vec::new(),
        count: 0,
    };

    /// The mean likelihood, relative to `top`.
    #[inline(never)]
    pub fn mean(&self, top: f32) -> f32 {
        let mut sum = 0.0;
        for log_likelihood in &self.log_likelihoods {
            sum += exp_of_weight(log_likelihood - top);
        }
        sum / f32::from(self.count.max(1))
    }
}

/// The cell of a place beyond the map: no point has this number, except the last of the largest map, where no cell begins.
const BEYOND: u16 = u16::MAX;

/// The coordinate of the last of so many points.
fn last_of(points: usize) -> f32 {
    points.saturating_sub(1) as f32
}

/// The whole part of a place, but at the last point the one before.
#[inline(always)]
fn floor_below(place: f32, last: f32) -> u32 {
    if place < last {
        place as u32
    } else {
        (last as u32).saturating_sub(1)
    }
}

/// Whether a place is on the map.
fn is_on([x, y]: [f32; 2], lattice: &Lattice) -> bool {
    let is_within = |steps: f32, points: usize| steps >= 0.0 && steps <= last_of(points);
    if lattice.is_plane() {
        is_within(x, lattice.columns()) && is_within(y, lattice.rows())
    } else {
        is_within(x, lattice.points())
    }
}

impl<const N: usize, F: Floor> Cloud<N, F> {
    /// Zero in all bits.
    pub const EMPTY: Self = Self {
        places: [[0.0; N]; 2],
        velocities: [[0.0; N]; 2],
        floors: [F::LOWEST; N],
        cells: [0; N],
        weights: [0.0; N],
    };

    /// Unpacks particles, moved along an axis, and returns the mean of the squares of their moves.
    #[inline(always)]
    pub fn advance<const AXIS: usize, S: Stored<Floor = F>>(
        &mut self,
        particles: &[S; N],
        grain: &Grain,
        step: &Step,
        mut noise: Noise,
    ) -> f32 {
        let mut squares = 0.0;
        let places = &mut self.places[AXIS & 1];
        let velocities = &mut self.velocities[AXIS & 1];
        let columns = places.iter_mut().zip(velocities);
        for (particle, (place, velocity)) in particles.iter().zip(columns) {
            let from = particle.place::<AXIS>(grain);
            let state = (from, particle.velocity::<AXIS>(grain));
            (*place, *velocity) = step.take(state, noise.next());
            squares += (*place - from) * (*place - from);
        }
        squares * (1.0 / N as f32)
    }

    /// Unpacks the floors of particles.
    #[inline(always)]
    pub fn take_floors<S: Stored<Floor = F>>(&mut self, particles: &[S; N]) {
        for (floor, particle) in self.floors.iter_mut().zip(particles) {
            *floor = particle.floor();
        }
    }

    /// Unpacks particles as they are, with equal weights.
    pub fn unpack<S: Stored<Floor = F>>(&mut self, particles: &[S; N], grain: &Grain) {
        self.take_floors(particles);
        let [x, y] = self.places.each_mut();
        let [vx, vy] = self.velocities.each_mut();
        let columns = x.iter_mut().zip(y).zip(vx.iter_mut().zip(vy));
        for (particle, ((x, y), (vx, vy))) in particles.iter().zip(columns) {
            (*x, *vx) = (particle.place::<0>(grain), particle.velocity::<0>(grain));
            (*y, *vy) = (particle.place::<1>(grain), particle.velocity::<1>(grain));
        }
        self.weights = [1.0; N];
    }

    /// Finds the cells of the places.
    #[inline(never)]
    pub fn find_cells(&mut self, lattice: &Lattice) {
        let [x, y] = &self.places;
        let points = lattice.points() as u32;
        if lattice.is_plane() {
            let [most_x, most_y] = [lattice.columns(), lattice.rows()].map(last_of);
            let columns = lattice.columns() as u32;
            let cells = self.cells.iter_mut().zip(&self.floors);
            for ((cell, floor), (x, y)) in cells.zip(x.iter().zip(y)) {
                let is_within = *x >= 0.0 && *x <= most_x && *y >= 0.0 && *y <= most_y;
                let first = floor_below(*y, most_y) * columns + floor_below(*x, most_x);
                let first = first + u32::from(floor.number()) * points;
                *cell = if is_within { first as u16 } else { BEYOND };
            }
        } else {
            let most = last_of(lattice.points());
            for ((cell, floor), x) in self.cells.iter_mut().zip(&self.floors).zip(x) {
                let is_within = *x >= 0.0 && *x <= most;
                let first = floor_below(*x, most) + u32::from(floor.number()) * points;
                *cell = if is_within { first as u16 } else { BEYOND };
            }
        }
    }

    /// Sets the log-likelihoods to those of the places, of tags that moved by their velocity for `age_s` seconds; the points
    /// were looked up for a velocity of `mean`.
    #[inline(never)]
    pub fn look_up<const P: usize>(
        &mut self,
        field: &Field<P>,
        lattice: &Lattice,
        age_s: f32,
        mean: [f32; 2],
    ) {
        let ([x, y], [vx, vy]) = (&self.places, &self.velocities);
        let weights = self.weights.iter_mut().zip(&self.cells);
        if lattice.is_plane() {
            let [most_x, most_y] = [lattice.columns(), lattice.rows()].map(last_of);
            let columns = x.iter().zip(y).zip(vx.iter().zip(vy));
            for ((weight, cell), ((x, y), (vx, vy))) in weights.zip(columns) {
                let fractions = [
                    x - floor_below(*x, most_x) as f32,
                    y - floor_below(*y, most_y) as f32,
                ];
                let further = [age_s * (vx - mean[0]), age_s * (vy - mean[1])];
                *weight = field.in_plane(*cell, lattice.columns(), fractions, further);
            }
        } else {
            let most = last_of(lattice.points());
            for ((weight, cell), (x, vx)) in weights.zip(x.iter().zip(vx)) {
                let fraction = x - floor_below(*x, most) as f32;
                *weight = field.on_line(*cell, fraction, age_s * (vx - mean[0]));
            }
        }
    }

    /// Compares some of the particles of a floor, others at every time, with a scan by which nothing is remembered: each as the
    /// point that is nearest to it.
    #[inline(never)]
    pub fn sample<const B: usize>(
        &self,
        floor: F,
        scan: &Comparison<'_, B>,
        lattice: &Lattice,
        time: u32,
        sample: &mut Sample,
    ) {
        let stride = N / SAMPLE + 1;
        let first = (time as usize).checked_rem(stride).unwrap_or(0);
        let [x, y] = &self.places;
        let places = x.iter().zip(y).zip(&self.floors);
        let places = places.skip(first).step_by(stride);
        sample.count = 0;
        for ((x, y), of) in places {
            sample.count += 1;
            if *of == floor && is_on([*x, *y], lattice) {
                let point = lattice.nearest_to_steps([*x, *y]);
                // There is room for all.
                let _ = (sample.log_likelihoods).push(scan.anew_at(point).log_likelihood);
            }
        }
    }

    /// Makes places beyond the map impossible.
    pub fn exclude_beyond(&mut self, lattice: &Lattice) {
        let [x, y] = &self.places;
        for (weight, (x, y)) in self.weights.iter_mut().zip(x.iter().zip(y)) {
            if !is_on([*x, *y], lattice) {
                *weight = f32::NEG_INFINITY;
            }
        }
    }

    /// Makes places impossible, by their floors and the points nearest to them.
    pub fn exclude(&mut self, lattice: &Lattice, is_possible: impl Fn(F, usize) -> bool) {
        let [x, y] = &self.places;
        let places = x.iter().zip(y).zip(&self.floors);
        for (weight, ((x, y), floor)) in self.weights.iter_mut().zip(places) {
            if !is_possible(*floor, lattice.nearest_to_steps([*x, *y])) {
                *weight = f32::NEG_INFINITY;
            }
        }
    }

    /// Computes the weights from log-likelihoods: relative to the largest, which gets 1. None if there is none.
    #[inline(never)]
    pub fn weigh(&mut self) -> Option<Sums> {
        let mut top = f32::NEG_INFINITY;
        for log_likelihood in &self.weights {
            if *log_likelihood > top {
                top = *log_likelihood;
            }
        }
        if !top.is_finite() {
            return None;
        }
        let (mut weights, mut squares) = ([0.0f32; 2], [0.0f32; 2]);
        let (blocks, rest) = self.weights.as_chunks_mut::<2>();
        for block in blocks {
            for lane in 0..2 {
                let weight = exp_of_weight(block[lane] - top);
                block[lane] = weight;
                weights[lane] += weight;
                squares[lane] += weight * weight;
            }
        }
        for weight in rest {
            *weight = exp_of_weight(*weight - top);
            weights[0] += *weight;
            squares[0] += *weight * *weight;
        }
        Some(Sums {
            weights: weights[0] + weights[1],
            squares: squares[0] + squares[1],
        })
    }

    /// The likeliest of so many floors, and the sum of the weights on it; of the only one, the sum of all weights.
    pub fn likeliest(&self, floors: u8, weights: f32) -> (F, f32) {
        if floors <= 1 {
            return (F::LOWEST, weights);
        }
        let mut likeliest = (F::LOWEST, 0.0);
        for floor in (0..floors).map(F::of) {
            let sum = self.weights_on(floor).sum();
            if sum > likeliest.1 {
                likeliest = (floor, sum);
            }
        }
        likeliest
    }

    /// The weights, of particles on other floors zero.
    #[inline(always)]
    fn weights_on(&self, floor: F) -> impl Iterator<Item = f32> {
        let weights = self.weights.iter().zip(&self.floors);
        weights.map(move |(weight, of)| if *of == floor { *weight } else { 0.0 })
    }

    /// Moments of the particles on a floor by weights, which have this sum there.
    #[inline(never)]
    pub fn moments(&self, is_plane: bool, floor: F, weights: f32) -> Moments {
        let scale = 1.0 / weights;
        let ([x, y], [vx, vy]) = (&self.places, &self.velocities);
        let (mut mean, mut velocity) = ([0.0f32; 2], [0.0f32; 2]);
        let mut covariance = Symmetric2::ZERO;
        if is_plane {
            let columns = x.iter().zip(y).zip(vx.iter().zip(vy));
            for (weight, ((x, y), (vx, vy))) in self.weights_on(floor).zip(columns) {
                mean[0] += weight * x;
                mean[1] += weight * y;
                velocity[0] += weight * vx;
                velocity[1] += weight * vy;
            }
            mean = mean.map(|sum| sum * scale);
            for (weight, (x, y)) in self.weights_on(floor).zip(x.iter().zip(y)) {
                let [dx, dy] = [x - mean[0], y - mean[1]];
                let [of_x, of_y] = [weight * dx, weight * dy];
                covariance.xx += of_x * dx;
                covariance.xy += of_x * dy;
                covariance.yy += of_y * dy;
            }
        } else {
            for (weight, (x, vx)) in self.weights_on(floor).zip(x.iter().zip(vx)) {
                mean[0] += weight * x;
                velocity[0] += weight * vx;
            }
            mean[0] *= scale;
            for (weight, x) in self.weights_on(floor).zip(x) {
                let dx = x - mean[0];
                covariance.xx += weight * dx * dx;
            }
        }
        Moments {
            place: mean,
            velocity: velocity.map(|sum| sum * scale),
            covariance: covariance.scaled(scale),
        }
    }

    /// Chooses as many particles as there are by their weights, of this sum, and packs them: systematic resampling, in
    /// order.
    #[inline(always)]
    pub fn resample<S: Stored<Floor = F>, R: Rng + ?Sized>(
        &self,
        weights: f32,
        particles: &mut [S; N],
        grain: &Grain,
        rng: &mut R,
    ) {
        let gap = weights * (1.0 / N as f32);
        let mut to_next = uniform(rng) * gap;
        let mut last = S::EMPTY;
        let mut slots = particles.iter_mut();
        let ([x, y], [vx, vy]) = (&self.places, &self.velocities);
        let columns = x.iter().zip(y).zip(vx.iter().zip(vy)).zip(&self.floors);
        for (weight, (((x, y), (vx, vy)), floor)) in self.weights.iter().zip(columns) {
            to_next -= weight;
            // False for NaN.
            if to_next < 0.0 {
                last = S::pack([*x, *y], [*vx, *vy], *floor, grain);
                while to_next < 0.0
                    && let Some(slot) = slots.next()
                {
                    *slot = last;
                    to_next += gap;
                }
            }
        }
        // Rounding may leave a few behind the end.
        for slot in slots {
            *slot = last;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_points_belong_to_the_cells_before_them() {
        let plane = Lattice::new([0.0; 2], 1.0, 5, 3).unwrap();
        let places = [
            ([0.0, 0.0], Some(0)),
            ([4.0, 2.0], Some(8)),
            ([4.0, 0.5], Some(3)),
            ([1.5, 2.0], Some(6)),
            ([1.5, 2.1], None),
            ([4.1, 1.0], None),
            ([-0.1, 1.0], None),
            ([1.0, -0.1], None),
        ];
        let mut cloud = Cloud::<8, u8>::EMPTY;
        cloud.floors = [2; 8];
        for (number, ([x, y], _)) in places.into_iter().enumerate() {
            (cloud.places[0][number], cloud.places[1][number]) = (x, y);
        }
        cloud.find_cells(&plane);
        cloud.exclude_beyond(&plane);
        for (number, (place, cell)) in places.into_iter().enumerate() {
            assert_eq!(is_on(place, &plane), cell.is_some(), "{place:?}");
            let cell = cell.map_or(BEYOND, |cell| 2 * 15 + cell);
            assert_eq!(cloud.cells[number], cell, "{place:?}");
            assert_eq!(cloud.weights[number].is_finite(), is_on(place, &plane));
        }
        let line = Lattice::new([0.0; 2], 1.0, 1, 5).unwrap();
        for (steps, is_within) in [(4.0, true), (4.1, false), (-0.1, false)] {
            assert_eq!(is_on([steps, 9.0], &line), is_within, "{steps}");
        }
    }

    /// An odd number of them: half, a quarter, and as likely as the best one.
    #[test]
    fn weights_are_relative_to_the_largest() {
        let mut cloud = Cloud::<3, u8>::EMPTY;
        cloud.floors = [0, 0, 1];
        let ln_2 = core::f32::consts::LN_2;
        cloud.weights = [40.0, 40.0 - 2.0 * ln_2, 40.0 - ln_2];
        let sums = cloud.weigh().unwrap();
        for (weight, expected) in cloud.weights.into_iter().zip([1.0, 0.25, 0.5]) {
            assert!((weight - expected).abs() < 1e-5, "{weight}");
        }
        assert!((sums.weights - 1.75).abs() < 1e-5, "{sums:?}");
        assert!((sums.squares - 1.3125).abs() < 1e-5, "{sums:?}");
        let (floor, on_floor) = cloud.likeliest(2, sums.weights);
        assert!(floor == 0 && (on_floor - 1.25).abs() < 1e-5);
        // Of floors that are as likely as each other, the lowest.
        cloud.weights = [0.25, 0.25, 0.5];
        assert_eq!(cloud.likeliest(2, 1.0), (0, 0.5));
        assert_eq!(cloud.likeliest(1, 1.0), (0, 1.0));
    }
}
