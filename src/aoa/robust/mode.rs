//! A mode of the posterior: one hypothesis of where the source is.

use heapless::Vec;

use super::density::Density;
use super::term::State;
use crate::aoa::Hypothesis;
use crate::estimate::Symmetric2;
use crate::kalman::Covariance;
use crate::math::{exp, ln};
use crate::snapshot::value;

/// The most hypotheses that are kept: more keep more sources apart, for time and 60 bytes each.
pub(super) const MODES: usize = 4;

pub(super) type Modes = Vec<Mode, MODES>;

/// A mode and the normal distribution of its curvature.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mode {
    pub(super) mean: State,
    pub(super) covariance: Covariance<3>,
    /// Logarithm of the mass about it by Laplace's approximation, up to a constant.
    pub(super) log_mass: f32,
    /// Weight among the proposals.
    pub(super) weight: f32,
}

value!(Mode {
    mean,
    covariance,
    log_mass,
    weight,
});

impl Mode {
    /// Squared distance of a state from the mean, in sigmas.
    pub(super) fn distance(&self, state: &State) -> f32 {
        let offset = core::array::from_fn(|d| state[d] - self.mean[d]);
        let white = self.covariance.whiten(offset);
        dot(&white, &white)
    }

    /// The same of the position alone.
    pub(super) fn distance_of_position(&self, &[x, y, _]: &State) -> f32 {
        let offset = [x - self.mean[0], y - self.mean[1], 0.0];
        let [u, v, _] = self.covariance.whiten(offset);
        u * u + v * v
    }

    /// A state about `from`, `scale` times as far as the sigmas `z` take it.
    pub(super) fn step(&self, from: &State, scale: f32, z: [f32; 3]) -> State {
        let offset = self.covariance.colour(z);
        core::array::from_fn(|d| from[d] + scale * offset[d])
    }

    /// Climbs from `start` in at most so many steps: expectation maximisation over what each bearing is, damped
    /// Gauss-Newton over the state. `None` where the posterior has no curvature.
    #[inline(never)]
    pub(super) fn climb(density: &Density<'_>, start: State, steps: u32) -> Option<Self> {
        let mut mean = start;
        let mut here = Normal::at(density, &mean);
        // Levenberg's, as a fraction of the diagonal.
        let mut damping = 0.0;
        for _ in 0..steps {
            let step = inverse(here.matrix, damping)?.map(|row| dot(&row, &here.gradient));
            let next = core::array::from_fn(|d| mean[d] + step[d]);
            let decrement = dot(&step, &here.gradient);
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
pub(super) fn weigh(modes: &mut Modes) {
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
pub(super) fn best(modes: &[Mode]) -> Option<&Mode> {
    modes.iter().max_by(|a, b| a.weight.total_cmp(&b.weight))
}

/// The largest logarithm of a mass.
pub(super) fn largest(modes: &[Mode]) -> f32 {
    let masses = modes.iter().map(|mode| mode.log_mass);
    masses.fold(f32::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

pub(super) fn dot(a: &State, b: &State) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sums over all bearings at one state.
struct Normal {
    matrix: [State; 3],
    gradient: State,
    log_density: f32,
}

impl Normal {
    fn at(density: &Density<'_>, state: &State) -> Self {
        let (region, bias_sigma_rad) = (&density.region, density.bias_sigma_rad);
        let pull = region.information(state);
        let mut matrix = [[pull, 0.0, 0.0], [0.0, pull, 0.0], [0.0, 0.0, 1.0]];
        let [cx, cy] = region.centre;
        let mut gradient = [pull * (cx - state[0]), pull * (cy - state[1]), -state[2]];
        let mut log_density = region.log_density(state);
        for term in density.terms {
            let reading = term.read(state, bias_sigma_rad * state[2]);
            log_density += ln(1.0 + reading.odds);
            let [gx, gy] = term.gradient(state);
            let derivative = [gx, gy, bias_sigma_rad];
            for ((row, total), a) in matrix.iter_mut().zip(&mut gradient).zip(derivative) {
                let pull = reading.information * a;
                for (entry, b) in row.iter_mut().zip(derivative) {
                    *entry += pull * b;
                }
                *total -= pull * reading.error;
            }
        }
        Self {
            matrix,
            gradient,
            log_density,
        }
    }
}

/// The inverse of a matrix whose diagonal is larger by the fraction `damping`; `None` where that is not positive definite as
/// far as f32 can tell.
fn inverse(mut matrix: [State; 3], damping: f32) -> Option<[State; 3]> {
    for (d, row) in matrix.iter_mut().enumerate() {
        if let Some(entry) = row.get_mut(d) {
            *entry *= 1.0 + damping;
        }
    }
    let factor = Covariance::new(&matrix)?;
    // The columns of the inverse of the factor.
    let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let columns = units.map(|unit| factor.whiten(unit));
    let finite = columns.iter().flatten().all(|entry| entry.is_finite());
    finite.then(|| columns.map(|a| columns.map(|b| dot(&a, &b))))
}

/// The modes as hypotheses.
pub(super) fn hypotheses(modes: &Modes) -> impl Iterator<Item = Hypothesis> {
    let best = largest(modes);
    let mass = move |mode: &Mode| exp(mode.log_mass - best);
    let total: f32 = modes.iter().map(mass).sum();
    modes.iter().map(move |mode| Hypothesis {
        position: position(&mode.mean),
        covariance: plane(&mode.covariance.matrix()),
        probability: mass(mode) / total,
    })
}

/// Of place and bias, the place.
pub(super) fn position(&[x, y, _]: &State) -> [f32; 2] {
    [x, y]
}

/// Of a covariance of place and bias, that of the place.
pub(super) fn plane(&[[xx, xy, _], [_, yy, _], _]: &[State; 3]) -> Symmetric2 {
    Symmetric2 { xx, xy, yy }
}
