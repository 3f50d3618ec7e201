//! Mass, mean and covariance of a density, in one pass and without underflow.

use crate::math::vector::{difference, plus_scaled};
use crate::math::{exp_of_weight, ln};

/// What has been seen of a density.
///
/// Means are updated rather than sums divided (Chan, Golub and LeVeque 1983): f32 resolves a spread that is a
/// millionth of the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments<const D: usize> {
    /// Logarithm of the unit of `mass` and `scatter`: the largest log-mass seen. Void as long as there is no mass.
    shift: f32,
    mass: f32,
    mean: [f32; D],
    scatter: [[f32; D]; D],
}

impl<const D: usize> Moments<D> {
    /// No mass at all, in bits that are all zero.
    pub(super) const NONE: Self = Self {
        shift: 0.0,
        mass: 0.0,
        mean: [0.0; D],
        scatter: [[0.0; D]; D],
    };

    /// One point of mass one.
    pub(super) const fn point(at: [f32; D]) -> Self {
        Self {
            shift: 0.0,
            mass: 1.0,
            mean: at,
            scatter: [[0.0; D]; D],
        }
    }

    /// Adds `e^log_factor` times another density. Factors that are NaN or infinite add nothing.
    pub(super) fn add(&mut self, other: &Self, log_factor: f32) {
        let shift = other.shift + log_factor;
        if other.mass == 0.0 || !shift.is_finite() {
            return;
        }
        if self.mass == 0.0 {
            self.shift = shift;
        } else if shift > self.shift {
            let scale = exp_of_weight(self.shift - shift);
            self.shift = shift;
            self.mass *= scale;
            for entry in self.scatter.as_flattened_mut() {
                *entry *= scale;
            }
        }
        let scale = exp_of_weight(shift - self.shift);
        let mass = scale * other.mass;
        if mass == 0.0 {
            return;
        }
        let total = self.mass + mass;
        let fraction = mass / total;
        let apart = difference(other.mean, self.mean);
        self.mean = plus_scaled(self.mean, fraction, apart);
        let between = fraction * self.mass;
        for ((row, other), a) in self.scatter.iter_mut().zip(&other.scatter).zip(apart) {
            for ((entry, other), b) in row.iter_mut().zip(other).zip(apart) {
                *entry += scale * other + between * (a * b);
            }
        }
        self.mass = total;
    }

    /// Natural logarithm of the mass; minus infinity when there is none.
    pub(super) fn log_mass(&self) -> f32 {
        self.shift + ln(self.mass)
    }

    pub(super) fn mean(&self) -> [f32; D] {
        self.mean
    }

    pub(super) fn covariance(&self) -> [[f32; D]; D] {
        self.scatter.map(|row| {
            row.map(|entry| {
                if self.mass > 0.0 {
                    entry / self.mass
                } else {
                    0.0
                }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_whole() {
        let points = [[5.0, 1.0], [5.001, 2.0], [5.002, 4.0], [5.001, 1.0]];
        let mut whole = Moments::NONE;
        let mut parts = [Moments::NONE; 2];
        for (i, point) in points.into_iter().enumerate() {
            let log_mass = i as f32 * 100.0 - 300.0;
            whole.add(&Moments::point(point), log_mass.max(-1.0));
            parts[i / 2].add(&Moments::point(point), log_mass.max(-1.0) - 500.0);
        }
        let mut sum = Moments::NONE;
        parts.iter().for_each(|part| sum.add(part, 500.0));
        sum.add(&Moments::point([7.0, 7.0]), f32::NEG_INFINITY);
        sum.add(&Moments::point([7.0, 7.0]), f32::NAN);
        sum.add(&Moments::point([7.0, 7.0]), f32::INFINITY);
        sum.add(&Moments::NONE, 0.0);
        // Masses 1/e, 1/e, 1/e and 1.
        let expected = [
            5.001,
            (7.0 + core::f32::consts::E) / (3.0 + core::f32::consts::E),
        ];
        for moments in [whole, sum] {
            assert!((moments.log_mass() - 0.743_668).abs() < 1e-4, "{moments:?}");
            assert!((moments.mean()[0] - expected[0]).abs() < 1e-6);
            assert!((moments.mean()[1] - expected[1]).abs() < 1e-6);
            let [[xx, xy], [yx, _]] = moments.covariance();
            let exact = 2e-6 / (3.0 + core::f32::consts::E);
            assert!((xx / exact - 1.0).abs() < 2e-3, "{xx} {exact}");
            assert_eq!(xy, yx);
        }
        assert_eq!(Moments::<2>::NONE.covariance(), [[0.0; 2]; 2]);
    }
}
