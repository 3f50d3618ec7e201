//! The particles of the tag that is being updated, unpacked: columns in steps of the lattice.

use super::comparison::{Comparison, Found, Spot};
use super::motion::{Noise, Step};
use super::stored::{Grain, Stored};
use crate::estimate::Symmetric2;
use crate::fingerprint::Lattice;
use crate::math::exp_of_weight;
use crate::random::{Rng, uniform};

/// Places in steps from the first point of the lattice, velocities in steps a second, and weights up to a common factor.
/// On a map of one row or one column only the first of two columns is in use, for places along it.
#[derive(Debug, Clone)]
pub(super) struct Cloud<const N: usize> {
    pub places: [[f32; N]; 2],
    pub velocities: [[f32; N]; 2],
    /// Log-likelihoods at first.
    pub weights: [f32; N],
    /// What the particles think of the offset: the probability that there is one, and the correction of its mean.
    pub opinions: [[f32; 2]; N],
    /// How much the scan adds to the precision of the offset, per dB^2: the mean over the particles.
    pub precision: f32,
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

impl<const N: usize> Cloud<N> {
    /// Zero in all bits.
    pub const EMPTY: Self = Self {
        places: [[0.0; N]; 2],
        velocities: [[0.0; N]; 2],
        weights: [0.0; N],
        opinions: [[0.0; 2]; N],
        precision: 0.0,
    };

    /// Particles of which the evidence is taken: fewer are work saved, and noise.
    const SAMPLE: usize = 32;

    /// Unpacks particles, moved along an axis, and returns the mean of the squares of their moves.
    #[inline(always)]
    pub fn advance<const AXIS: usize, S: Stored>(
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

    /// Unpacks particles as they are, with equal weights.
    pub fn unpack<S: Stored>(&mut self, particles: &[S; N], grain: &Grain) {
        let [x, y] = self.places.each_mut();
        let [vx, vy] = self.velocities.each_mut();
        let columns = x.iter_mut().zip(y).zip(vx.iter_mut().zip(vy));
        for (particle, ((x, y), (vx, vy))) in particles.iter().zip(columns) {
            (*x, *vx) = (particle.place::<0>(grain), particle.velocity::<0>(grain));
            (*y, *vy) = (particle.place::<1>(grain), particle.velocity::<1>(grain));
        }
        self.weights = [1.0; N];
    }

    /// Sets the log-likelihoods to those of the places, of tags that were where their velocity says `age_s` seconds ago.
    #[inline(never)]
    pub fn compare<const B: usize>(
        &mut self,
        scan: &Comparison<'_, B>,
        lattice: &Lattice,
        age_s: f32,
    ) {
        let mut precision = 0.0;
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let last = |points: usize| points.saturating_sub(1) as f32;
        let ([x, y], [vx, vy]) = (&self.places, &self.velocities);
        let to = self.weights.iter_mut().zip(&mut self.opinions);
        if lattice.is_plane() {
            let ends = [last(columns), last(rows)];
            let columns_of = x.iter().zip(y).zip(vx.iter().zip(vy));
            for ((weight, opinion), ((x, y), (vx, vy))) in to.zip(columns_of) {
                let past = [
                    within(x - age_s * vx, ends[0]),
                    within(y - age_s * vy, ends[1]),
                ];
                let found = match (
                    Spot::in_plane([*x, *y], columns, rows),
                    Spot::in_plane(past, columns, rows),
                ) {
                    (Some(spot), Some(past)) => scan.at::<true>(&spot, &past),
                    _ => Found::NOWHERE,
                };
                *weight = found.log_likelihood;
                *opinion = [found.probability, found.shift];
                precision += found.precision;
            }
        } else {
            let (points, end) = (lattice.points(), last(lattice.points()));
            for ((weight, opinion), (x, vx)) in to.zip(x.iter().zip(vx)) {
                let past = within(x - age_s * vx, end);
                let found = match (Spot::on_line(*x, points), Spot::on_line(past, points)) {
                    (Some(spot), Some(past)) => scan.at::<false>(&spot, &past),
                    _ => Found::NOWHERE,
                };
                *weight = found.log_likelihood;
                *opinion = [found.probability, found.shift];
                precision += found.precision;
            }
        }
        self.precision = precision * (1.0 / N as f32);
    }

    /// The mean likelihood of a scan by which nothing is remembered, relative to `top`, over some of the particles.
    #[inline(never)]
    pub fn evidence<const B: usize>(
        &self,
        scan: &Comparison<'_, B>,
        lattice: &Lattice,
        top: f32,
    ) -> f32 {
        let stride = N / Self::SAMPLE + 1;
        let [x, y] = &self.places;
        let (mut sum, mut count) = (0.0, 0u32);
        for (x, y) in x.iter().zip(y).step_by(stride) {
            let log_likelihood = if lattice.is_plane() {
                let spot = Spot::in_plane([*x, *y], lattice.columns(), lattice.rows());
                spot.map_or(Found::NOWHERE, |spot| scan.at::<true>(&spot, &spot))
            } else {
                let spot = Spot::on_line(*x, lattice.points());
                spot.map_or(Found::NOWHERE, |spot| scan.at::<false>(&spot, &spot))
            }
            .log_likelihood;
            sum += exp_of_weight(log_likelihood - top);
            count += 1;
        }
        sum / count as f32
    }

    /// Makes places impossible.
    pub fn exclude(&mut self, lattice: &Lattice, is_possible: impl Fn(usize) -> bool) {
        let [x, y] = &self.places;
        for (weight, (x, y)) in self.weights.iter_mut().zip(x.iter().zip(y)) {
            let spot = if lattice.is_plane() {
                Spot::in_plane([*x, *y], lattice.columns(), lattice.rows())
            } else {
                Spot::on_line(*x, lattice.points())
            };
            let point = spot.map(|spot| spot.nearest(lattice.columns()));
            if !point.is_some_and(&is_possible) {
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

    /// Moments by weights of this sum.
    #[inline(never)]
    pub fn moments(&self, is_plane: bool, weights: f32) -> Moments {
        let scale = 1.0 / weights;
        let ([x, y], [vx, vy]) = (&self.places, &self.velocities);
        let (mut mean, mut velocity) = ([0.0f32; 2], [0.0f32; 2]);
        let mut covariance = Symmetric2::ZERO;
        if is_plane {
            let columns = x.iter().zip(y).zip(vx.iter().zip(vy));
            for (weight, ((x, y), (vx, vy))) in self.weights.iter().zip(columns) {
                mean[0] += weight * x;
                mean[1] += weight * y;
                velocity[0] += weight * vx;
                velocity[1] += weight * vy;
            }
            mean = mean.map(|sum| sum * scale);
            for (weight, (x, y)) in self.weights.iter().zip(x.iter().zip(y)) {
                let [dx, dy] = [x - mean[0], y - mean[1]];
                let [of_x, of_y] = [weight * dx, weight * dy];
                covariance.xx += of_x * dx;
                covariance.xy += of_x * dy;
                covariance.yy += of_y * dy;
            }
        } else {
            for (weight, (x, vx)) in self.weights.iter().zip(x.iter().zip(vx)) {
                mean[0] += weight * x;
                velocity[0] += weight * vx;
            }
            mean[0] *= scale;
            for (weight, x) in self.weights.iter().zip(x) {
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
    pub fn resample<S: Stored, R: Rng + ?Sized>(
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
        let columns = x.iter().zip(y).zip(vx.iter().zip(vy));
        for (weight, ((x, y), (vx, vy))) in self.weights.iter().zip(columns) {
            to_next -= weight;
            // False for NaN.
            if to_next < 0.0 {
                last = S::pack([*x, *y], [*vx, *vy], grain);
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

/// From 0 to the end of an axis.
#[inline(always)]
fn within(steps: f32, end: f32) -> f32 {
    let steps = if steps > 0.0 { steps } else { 0.0 };
    if steps < end { steps } else { end }
}
