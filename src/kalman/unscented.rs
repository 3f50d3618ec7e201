//! The unscented Kalman filter.

use super::{Covariance, Gaussian, Innovation, KalmanError};
use crate::ConfigError;
use crate::config::require_within;
use crate::math::sqrt;
use crate::math::vector::{difference, plus_scaled};

/// An unscented Kalman filter: pushes a few points of the state's distribution through the model, and fits a
/// normal distribution to what comes out.
///
/// Julier and Uhlmann, "Unscented filtering and nonlinear estimation" (2004), in the square-root form of van der
/// Merwe and Wan (2001), but without a downdate: with `beta` and `kappa` not negative, the weighted outer product
/// about the mean of all points equals one about the mean of the outer points, in which no weight is negative.
/// Calls the model `2 D + 1` times for a prediction and as often for an update.
///
/// A configuration that serves any number of filters, whose states are [`Gaussian`]s. See [`crate::kalman`] for an
/// example. The fields are not checked when it is used: call [`Unscented::check`], or [`config!`](crate::config!) in a
/// constant.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unscented {
    /// How far from the mean the points are: `alpha sqrt(D + kappa)` sigmas.
    pub alpha: f32,
    /// What is known of the kurtosis: 2 for a normal distribution.
    pub beta: f32,
    /// Adds to the dimension: see `alpha`.
    pub kappa: f32,
}

/// What became of a normal distribution of `D` dimensions in a function to `M` dimensions.
struct Transformed<const D: usize, const M: usize> {
    mean: [f32; M],
    /// Half the difference of the values at either end of each column of the factor, over their distance from the
    /// middle: what a derivative would say.
    slopes: [[f32; M]; D],
    /// The noise that was given, and what is not explained by the slopes.
    rest: Covariance<M>,
}

impl Unscented {
    /// Points one sigma times the root of `D` from the mean: exact in mean and covariance for a
    /// quadratic function of one variable. `alpha` 1, `beta` 2, `kappa` 0.
    pub const DEFAULT: Self = Self {
        alpha: 1.0,
        beta: 2.0,
        kappa: 0.0,
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// Names the first field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        // With a smaller alpha, f32 cannot tell the points apart.
        require_within!(self: alpha 0.01..=1.0, beta 0.0..=100.0, kappa 0.0..=100.0);
        Ok(())
    }

    /// Moves `state`: x' = `transition`(x) + `noise`. Noise whose mean is not zero belongs in `transition`.
    ///
    /// # Errors
    /// When the result is not finite; the state is then as before.
    pub fn predict<const D: usize>(
        &self,
        state: &mut Gaussian<D>,
        transition: impl Fn(&[f32; D]) -> [f32; D],
        noise: &Covariance<D>,
    ) -> Result<(), KalmanError> {
        let Transformed { mean, slopes, rest } = self.transform(state, transition, noise);
        let mut covariance = rest;
        for slope in slopes {
            covariance.add(slope);
        }
        state.become_finite(Gaussian { mean, covariance })
    }

    /// Takes in a measurement with `noise`, and says what was new in it.
    ///
    /// `residual` gives measured less expected for a state. Where that is an angle, wrap it there: the points then
    /// may lie on both sides of the cut.
    ///
    /// # Errors
    /// When the result is not finite, or the measurement has no uncertainty at all; the state is then as before.
    pub fn update<const D: usize, const M: usize>(
        &self,
        state: &mut Gaussian<D>,
        residual: impl Fn(&[f32; D]) -> [f32; M],
        noise: &Covariance<M>,
    ) -> Result<Innovation<M>, KalmanError> {
        let Transformed { mean, slopes, rest } = self.transform(state, residual, noise);
        // The measurement grows as the residual of a fixed one falls.
        let slopes = slopes.map(|slope| slope.map(|v| -v));
        state.condition(mean, &slopes, &rest)
    }

    /// The distribution of `function` of the state, by sigma points `mean +- reach L_d`, with `L` the factor of the
    /// covariance.
    ///
    /// With f(0) the value in the middle and f(+d) and f(-d) at the ends, slope_d = (f(+d) - f(-d)) / (2 reach) and
    /// bend_d = (f(+d) + f(-d)) / 2 - f(0). The mean is f(0) + shift, shift = sum bend_d / reach^2; the covariance is
    /// sum slope_d slope_d^T + rest.
    fn transform<const D: usize, const M: usize>(
        &self,
        state: &Gaussian<D>,
        function: impl Fn(&[f32; D]) -> [f32; M],
        noise: &Covariance<M>,
    ) -> Transformed<D, M> {
        let square = self.alpha * self.alpha * (D as f32 + self.kappa);
        let reach = sqrt(square);
        let middle = function(&state.mean);
        let mut bends = [[0.0; M]; D];
        let mut slopes = [[0.0; M]; D];
        let mut bend = [0.0; M];
        let columns = state.covariance.columns().iter();
        for ((column, own), slopes) in columns.zip(&mut bends).zip(&mut slopes) {
            let end = |reach: f32| function(&plus_scaled(state.mean, reach, *column));
            let (above, below) = (end(reach), end(-reach));
            // Differences first: they are exact where sums would be rounded.
            let up = difference(above, middle);
            *own = plus_scaled(up, 1.0, difference(below, middle)).map(|b| 0.5 * b);
            *slopes = difference(above, below).map(|s| 0.5 * s / reach);
            bend = plus_scaled(bend, 1.0, own.map(|b| b / D as f32));
        }
        // `bend` is the average of the outer points less the middle; the weighted mean lies D / reach^2 times as far.
        let shift = bend.map(|b| b * (D as f32 / square));
        let mut rest = *noise;
        for own in bends {
            rest.add(difference(own, bend).map(|b| b / reach));
        }
        let factor = sqrt(self.beta + self.alpha * self.alpha * self.kappa / D as f32);
        rest.add(shift.map(|s| factor * s));
        let mean = plus_scaled(middle, 1.0, shift);
        Transformed { mean, slopes, rest }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};
    use std::{vec, vec::Vec};

    const SETS: [Unscented; 5] = [
        Unscented::DEFAULT,
        of(1.0, 0.0, 2.0),
        of(0.3, 2.0, 0.0),
        of(0.1, 0.0, 1.0),
        of(1.0, 0.0, 0.0),
    ];

    const fn of(alpha: f32, beta: f32, kappa: f32) -> Unscented {
        Unscented { alpha, beta, kappa }
    }

    fn state() -> Gaussian<3> {
        Gaussian {
            mean: [1.0, -0.5, 2.0],
            covariance: Covariance::new(&[[1.0, 0.3, 0.1], [0.3, 0.8, -0.2], [0.1, -0.2, 0.5]])
                .unwrap(),
        }
    }

    fn bent([x, y, z]: &[f32; 3]) -> [f32; 2] {
        [x * y + z, z * z - 0.3 * x * x * x]
    }

    /// The unscented transform as it is printed, negative weights and all, in f64: mean, covariance of the values,
    /// and covariance of state and values.
    fn printed(
        unscented: &Unscented,
        state: &Gaussian<3>,
    ) -> ([f64; 2], [[f64; 2]; 2], [[f64; 2]; 3]) {
        let n = 3.0;
        let Unscented { alpha, beta, kappa } = *unscented;
        let [alpha, beta, kappa] = [alpha, beta, kappa].map(f64::from);
        let lambda = alpha * alpha * (n + kappa) - n;
        let mut points = vec![state.mean.map(f64::from)];
        for column in state.covariance.columns() {
            for sign in [1.0, -1.0] {
                points.push(core::array::from_fn(|d| {
                    f64::from(state.mean[d]) + sign * (n + lambda).sqrt() * f64::from(column[d])
                }));
            }
        }
        let values: Vec<[f64; 2]> = points
            .iter()
            .map(|[x, y, z]| [x * y + z, z * z - 0.3 * x * x * x])
            .collect();
        let outer = 0.5 / (n + lambda);
        let weight = |i: usize| if i == 0 { lambda / (n + lambda) } else { outer };
        let spread = |i: usize| {
            weight(i)
                + if i == 0 {
                    1.0 - alpha * alpha + beta
                } else {
                    0.0
                }
        };
        let mean: [f64; 2] =
            core::array::from_fn(|d| (0..7).map(|i| weight(i) * values[i][d]).sum());
        let covariance = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                (0..7)
                    .map(|i| spread(i) * (values[i][a] - mean[a]) * (values[i][b] - mean[b]))
                    .sum()
            })
        });
        let cross = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                (0..7)
                    .map(|i| spread(i) * (points[i][a] - points[0][a]) * (values[i][b] - mean[b]))
                    .sum()
            })
        });
        (mean, covariance, cross)
    }

    #[test]
    fn the_transform_is_the_printed_one() {
        let state = state();
        for unscented in SETS {
            let found = unscented.transform(&state, bent, &Covariance::ZERO);
            let (mean, covariance, cross) = printed(&unscented, &state);
            let mut total = found.rest;
            let mut together = [[0.0; 2]; 3];
            for (slope, column) in found.slopes.iter().zip(state.covariance.columns()) {
                total.add(*slope);
                for a in 0..3 {
                    for b in 0..2 {
                        together[a][b] += column[a] * slope[b];
                    }
                }
            }
            let near = |found: f32, expected: f64| (f64::from(found) - expected).abs() < 2e-4;
            for a in 0..2 {
                assert!(near(found.mean[a], mean[a]), "{unscented:?}");
                for (b, expected) in covariance[a].iter().enumerate() {
                    assert!(near(total.matrix()[a][b], *expected), "{unscented:?}");
                }
            }
            for a in 0..3 {
                for b in 0..2 {
                    assert!(near(together[a][b], cross[a][b]), "{unscented:?}");
                }
            }
        }
    }

    #[test]
    fn of_a_linear_model_it_is_the_kalman_filter() {
        let transition = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.5], [0.0, 0.0, 0.9]];
        let noise = Covariance::diagonal([0.0, 0.1, 0.2]);
        let row = [1.0, 0.0, -0.5];
        let dot = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(35);
        for unscented in SETS {
            let (mut exact, mut other) = (state(), state());
            for _ in 0..200 {
                exact.predict(&transition, &noise).unwrap();
                let through = |x: &[f32; 3]| transition.map(|row| dot(&row, x));
                unscented.predict(&mut other, through, &noise).unwrap();
                let z = normal(&mut rng);
                let noise = Covariance::diagonal([0.7]);
                let ours = exact.update(&[row], [z], &noise).unwrap();
                let theirs = unscented
                    .update(&mut other, |x| [z - dot(&row, x)], &noise)
                    .unwrap();
                assert!((ours.log_evidence - theirs.log_evidence).abs() < 1e-3);
            }
            for (a, b) in exact.mean.iter().zip(other.mean) {
                assert!((a - b).abs() < 1e-3, "{unscented:?}: {exact:?} {other:?}");
            }
            let (a, b) = (exact.covariance.matrix(), other.covariance.matrix());
            for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
                assert!((a - b).abs() < 1e-3, "{unscented:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn of_a_square_it_is_exact() {
        let state = Gaussian {
            mean: [3.0],
            covariance: Covariance::diagonal([2.0]),
        };
        let mut squared = state;
        Unscented::DEFAULT
            .predict(&mut squared, |[x]| [x * x], &Covariance::ZERO)
            .unwrap();
        // m^2 + s^2 and 4 m^2 s^2 + 2 s^4
        assert!((squared.mean[0] - 13.0).abs() < 1e-5);
        assert!((squared.covariance.matrix()[0][0] - 176.0).abs() < 1e-3);
    }

    #[test]
    fn precise_measurements_of_a_nearly_flat_state_leave_a_covariance() {
        // Correlation 1 - 5e-7, and a curved measurement to 1e-4, 50,000 times.
        let unscented = of(0.1, 2.0, 0.0);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(36);
        let mut covariance = Covariance::diagonal([1e-3, 1e-3]);
        covariance.add([1.0, 1.0]);
        let mut state = Gaussian {
            mean: [5.0, 5.0],
            covariance,
        };
        let drift = Covariance::diagonal([1e-3, 1e-3]);
        for step in 0..50_000 {
            unscented.predict(&mut state, |x| *x, &drift).unwrap();
            let z = 50.0 + 1e-4 * normal(&mut rng);
            let residual = |[x, y]: &[f32; 2]| [z - x * x - y * y];
            let innovation = unscented
                .update(&mut state, residual, &Covariance::diagonal([1e-4]))
                .unwrap();
            assert!(innovation.log_evidence.is_finite());
            assert!(!state.covariance.is_singular(), "step {step}: {state:?}");
        }
        // The distribution lies along a tangent of the circle: its mean square is what was measured.
        let [[xx, _], [_, yy]] = state.covariance.matrix();
        let [x, y] = state.mean;
        assert!((x * x + y * y + xx + yy - 50.0).abs() < 1e-2, "{state:?}");
    }

    #[test]
    fn fields_and_models_out_of_range_are_refused() {
        for (unscented, field) in [
            (of(0.0, 2.0, 0.0), "alpha"),
            (of(1.1, 2.0, 0.0), "alpha"),
            (of(f32::NAN, 2.0, 0.0), "alpha"),
            (of(1.0, -1.0, 0.0), "beta"),
            (of(1.0, 2.0, -0.1), "kappa"),
            (of(1.0, 2.0, f32::INFINITY), "kappa"),
        ] {
            assert_eq!(unscented.check().unwrap_err().field(), field);
        }
        let mut there = state();
        let noise = Covariance::diagonal([1.0]);
        let result = Unscented::DEFAULT.update(&mut there, |_| [f32::NAN], &noise);
        assert_eq!(result, Err(KalmanError::NotFinite));
        let nowhere = |_: &[f32; 3]| [f32::INFINITY; 3];
        let result = Unscented::DEFAULT.predict(&mut there, nowhere, &Covariance::ZERO);
        assert_eq!(result, Err(KalmanError::NotFinite));
        assert_eq!(there, state());
    }
}
