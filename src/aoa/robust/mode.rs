//! A mode of the posterior: one hypothesis of where the source is.

use heapless::Vec;

use super::density::{Density, Logarithm};
use super::term::{Reading, SCALE, State, Width};
use crate::aoa::Hypothesis;
use crate::estimate::Symmetric2;
use crate::kalman::Covariance;
use crate::math::vector::{difference, dot, plus_scaled};
use crate::math::{exp, larger};
use crate::snapshot::value;

/// The most hypotheses that are kept: more keep more sources apart, for time and 90 bytes each.
pub(in crate::aoa) const MODES: usize = 4;

pub(super) type Modes<const D: usize> = Vec<Mode<D>, MODES>;

/// A mode and the normal distribution of its curvature.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mode<const D: usize> {
    pub(super) mean: State<D>,
    pub(super) covariance: Covariance<D>,
    /// Logarithm of the mass about it by Laplace's approximation, up to a constant.
    pub(super) log_mass: f32,
    /// Weight among the proposals.
    pub(super) weight: f32,
}

value!(impl[const D: usize] Mode<D> as "Mode", { mean, covariance, log_mass, weight });

impl<const D: usize> Mode<D> {
    /// Squared distance of a state from the mean, in sigmas.
    #[inline(never)]
    pub(super) fn distance(&self, state: &State<D>) -> f32 {
        let white = self.covariance.whiten(difference(*state, self.mean));
        dot(white, white)
    }

    /// The same of the position alone.
    #[inline(never)]
    pub(super) fn distance_of_position(&self, state: &State<D>) -> f32 {
        let mut offset = [0.0; D];
        offset[0] = state[0] - self.mean[0];
        offset[1] = state[1] - self.mean[1];
        let white = self.covariance.whiten(offset);
        white[0] * white[0] + white[1] * white[1]
    }

    /// Whether the places of two modes are within two sigmas of each other, by either.
    fn is_at(&self, other: &Self) -> bool {
        const SQUARE: f32 = 4.0;
        self.distance_of_position(&other.mean) <= SQUARE
            && other.distance_of_position(&self.mean) <= SQUARE
    }

    /// A state about `from`, `scale` times as far as the sigmas `z` take it.
    #[inline(never)]
    pub(super) fn step(&self, from: &State<D>, scale: f32, z: [f32; D]) -> State<D> {
        plus_scaled(*from, scale, self.covariance.colour(z))
    }

    /// Climbs from `start` in at most so many steps: expectation maximisation over what each bearing is, damped
    /// Gauss-Newton over the state. `None` where the posterior has no curvature.
    #[inline(never)]
    pub(super) fn climb(density: &Density<'_, D>, start: State<D>, steps: u32) -> Option<Self> {
        let mut mean = start;
        let mut here = Normal::at(density, &mean);
        // Levenberg's, as a fraction of the diagonal.
        let mut damping = 0.0;
        for _ in 0..steps {
            let step = inverse(here.matrix, damping)?.map(|row| dot(row, here.gradient));
            let next = plus_scaled(mean, 1.0, step);
            let decrement = dot(step, here.gradient);
            let there = Normal::at(density, &next);
            if there.log_density >= here.log_density {
                (mean, here) = (next, there);
                damping *= 0.1;
            } else {
                damping = if damping > 0.0 { damping * 10.0 } else { 1e-2 };
            }
            // A hundredth of a sigma is near enough to propose from.
            if decrement * (1.0 + damping) < 1e-4 {
                break;
            }
        }
        let covariance = Covariance::new(&inverse(here.matrix, 0.0)?)?;
        let log_mass = here.log_density + covariance.half_ln_determinant();
        log_mass.is_finite().then_some(Self {
            mean,
            covariance,
            log_mass,
            weight: 0.0,
        })
    }
}

/// Sets the weights by the masses, and drops the modes that have next to none.
pub(super) fn weigh<const D: usize>(modes: &mut Modes<D>) {
    /// Least weight: Laplace's approximation is rough, and a mode that is never proposed is never tried; more wastes draws.
    const LEAST: f32 = 0.02;
    /// Logarithm of a mass over the largest that is dropped: less keeps modes that never come back, for time.
    const NEGLIGIBLE: f32 = -25.0;
    let best = largest(modes);
    modes.retain(|mode| mode.log_mass - best > NEGLIGIBLE);
    let mut total = 0.0;
    for mode in modes.iter_mut() {
        mode.weight = exp(mode.log_mass - best) + LEAST;
        total += mode.weight;
    }
    for mode in modes {
        mode.weight /= total;
    }
}

/// The one with the largest weight.
pub(super) fn best<const D: usize>(modes: &[Mode<D>]) -> Option<&Mode<D>> {
    modes.iter().max_by(|a, b| a.weight.total_cmp(&b.weight))
}

/// The largest logarithm of a mass.
pub(super) fn largest<const D: usize>(modes: &[Mode<D>]) -> f32 {
    let masses = modes.iter().map(|mode| mode.log_mass);
    masses.fold(f32::NEG_INFINITY, |a, b| larger(b, a))
}

/// Sums over all bearings at one state.
struct Normal<const D: usize> {
    /// The lower triangle.
    matrix: [State<D>; D],
    gradient: State<D>,
    log_density: f32,
}

impl<const D: usize> Normal<D> {
    fn at(density: &Density<'_, D>, state: &State<D>) -> Self {
        let (gradient, information) = density.prior(state);
        let mut normal = Self {
            matrix: diagonal(information),
            gradient,
            log_density: density.log_prior(state),
        };
        let width = Width::new(density.scale_sigma, state);
        let mut sum = Logarithm::OF_ONE;
        for place in density.places() {
            // Most places have one bearing, which is read once.
            let alone = matches!(place, [_]);
            let mut total = if alone {
                1.0
            } else {
                1.0 + density.odds(place, state, &width)
            };
            for term in place {
                let (line, gradient) = density.linearise(term, state);
                let reading = term.reading(line, &width);
                if alone {
                    total += reading.odds;
                }
                let fit = reading.odds / total;
                normal.add(&reading, fit, &gradient, density.scale_sigma);
            }
            sum.multiply(total);
        }
        normal.log_density += sum.value();
        normal
    }

    /// Adds a bearing that fits with this probability, and of which the error has these derivatives by all but the scale.
    #[inline(always)]
    fn add(&mut self, reading: &Reading, fit: f32, derivative: &State<D>, scale_sigma: f32) {
        let information = fit * reading.precision;
        let error = reading.line.error;
        for (d, row) in self.matrix.iter_mut().enumerate() {
            let pull = information * derivative[d];
            self.gradient[d] -= pull * error;
            for (entry, b) in row.iter_mut().zip(derivative).take(d + 1) {
                *entry += pull * b;
            }
        }
        // A normal density of a standard deviation s has an information of 2 on ln s.
        self.matrix[SCALE][SCALE] += 2.0 * fit * reading.worth * scale_sigma * scale_sigma;
        let square = reading.precision * error * error;
        self.gradient[SCALE] += fit * scale_sigma * (square - reading.worth);
    }
}

const fn diagonal<const D: usize>(entries: State<D>) -> [State<D>; D] {
    *Covariance::diagonal(entries).columns()
}

/// The inverse of a matrix whose diagonal is larger by the fraction `damping`; `None` where that is not positive definite as
/// far as f32 can tell.
#[inline(never)]
fn inverse<const D: usize>(mut matrix: [State<D>; D], damping: f32) -> Option<[State<D>; D]> {
    for (d, row) in matrix.iter_mut().enumerate() {
        if let Some(entry) = row.get_mut(d) {
            *entry *= 1.0 + damping;
        }
    }
    let factor = Covariance::new(&matrix)?;
    // The columns of the inverse of the factor.
    let columns = diagonal([1.0; D]).map(|unit| factor.whiten(unit));
    let finite = columns.iter().flatten().all(|entry| entry.is_finite());
    finite.then(|| columns.map(|a| columns.map(|b| dot(a, b))))
}

/// The modes as hypotheses. Those of one place, under other scales of the errors, are one.
pub(super) fn hypotheses<const D: usize>(modes: &Modes<D>) -> impl Iterator<Item = Hypothesis> {
    (0..MODES).map_while(|index| hypothesis(modes, index))
}

/// One of them.
#[inline(never)]
pub(super) fn hypothesis<const D: usize>(modes: &Modes<D>, index: usize) -> Option<Hypothesis> {
    let best = largest(modes);
    let mass = |mode: &Mode<D>| exp(mode.log_mass - best);
    let total: f32 = modes.iter().map(mass).sum();
    let is_best_there = |mode: &&Mode<D>| {
        let is_better = |other: &Mode<D>| other.log_mass > mode.log_mass && mode.is_at(other);
        !modes.iter().any(is_better)
    };
    let mode = modes.iter().filter(is_best_there).nth(index)?;
    let there = modes.iter().filter(|other| mode.is_at(other));
    let within: f32 = there.map(mass).sum();
    Some(Hypothesis {
        position: position(&mode.mean),
        covariance: plane(&mode.covariance.matrix()),
        probability: within / total,
    })
}

/// Of a state, the place.
pub(super) fn position<const D: usize>(state: &State<D>) -> [f32; 2] {
    [state[0], state[1]]
}

/// Of a covariance of a state, that of the place.
pub(super) fn plane<const D: usize>(covariance: &[State<D>; D]) -> Symmetric2 {
    let ([xx, xy], yy) = ([covariance[0][0], covariance[0][1]], covariance[1][1]);
    Symmetric2 { xx, xy, yy }
}
