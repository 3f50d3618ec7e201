//! The Kalman filter.

use super::covariance::Rotation;
use super::gaussian::log_density_at;
use super::{Covariance, Gaussian, Innovation, KalmanError};
use crate::math::vector::{difference, plus_scaled};

impl<const D: usize> Gaussian<D> {
    /// Moves the state by a Kalman filter's prediction: x' = `transition` x + `noise`. Rows come first.
    ///
    /// ```
    /// use foxhunt::kalman::{Covariance, Gaussian};
    ///
    /// // Position and speed, a second later; accelerations of 0.1 m/s^2.
    /// let mut state = Gaussian { mean: [0.0, 2.0], covariance: Covariance::diagonal([3.0, 1.0]) };
    /// let mut noise = Covariance::ZERO;
    /// noise.add([0.05, 0.1]);
    /// state.predict(&[[1.0, 1.0], [0.0, 1.0]], &noise)?;
    /// assert_eq!(state.mean, [2.0, 2.0]);
    ///
    /// // The position is measured, to a metre.
    /// let innovation = state.update(&[[1.0, 0.0]], [3.0], &Covariance::diagonal([1.0]))?;
    /// assert_eq!(innovation.residual, [1.0]);
    /// assert!(state.mean[0] > 2.9 && state.mean[1] > 2.0);
    /// # Ok::<(), foxhunt::kalman::KalmanError>(())
    /// ```
    ///
    /// # Errors
    /// When the result is not finite; the state is then as before.
    pub fn predict(
        &mut self,
        transition: &[[f32; D]; D],
        noise: &Covariance<D>,
    ) -> Result<(), KalmanError> {
        let mut covariance = *noise;
        for column in self.covariance.columns() {
            covariance.add(times(transition, column));
        }
        self.become_finite(Self {
            mean: times(transition, &self.mean),
            covariance,
        })
    }

    /// Takes in the measurement `measured` = `observation` x + `noise`, and says what was new in it.
    ///
    /// # Errors
    /// When the result is not finite, or the measurement has no uncertainty at all; the state is then as before.
    pub fn update<const M: usize>(
        &mut self,
        observation: &[[f32; D]; M],
        measured: [f32; M],
        noise: &Covariance<M>,
    ) -> Result<Innovation<M>, KalmanError> {
        let residual = difference(measured, times(observation, &self.mean));
        let slopes = self
            .covariance
            .columns()
            .map(|column| times(observation, &column));
        self.condition(residual, &slopes, noise)
    }

    /// Takes in a `residual` that scatters by `noise` and by what moves it with the state: `slopes` holds the
    /// change of the measurement with each column of the state's factor.
    ///
    /// The columns `[noise; 0]` and `[slopes; factor]` are a factor of the joint covariance of measurement and
    /// state. Rotated into a triangle, its corner is the factor of the posterior.
    pub(super) fn condition<const M: usize>(
        &mut self,
        residual: [f32; M],
        slopes: &[[f32; M]; D],
        noise: &Covariance<M>,
    ) -> Result<Innovation<M>, KalmanError> {
        let mut measured = *noise.columns();
        let mut cross = [[0.0; D]; M];
        let mut posterior = Covariance::ZERO;
        for (slope, column) in slopes.iter().zip(self.covariance.columns()) {
            let (mut slope, mut column) = (*slope, *column);
            for (k, (measured, cross)) in measured.iter_mut().zip(&mut cross).enumerate() {
                let rotation = Rotation::onto(measured, &slope, k);
                rotation.turn(measured, &mut slope, k);
                rotation.turn(cross, &mut column, 0);
            }
            posterior.add(column);
        }
        let covariance = Covariance::from_columns(measured);
        if covariance.is_singular() {
            return Err(KalmanError::Singular);
        }
        let white = covariance.whiten(residual);
        let mut mean = self.mean;
        for (cross, w) in cross.iter().zip(white) {
            mean = plus_scaled(mean, w, *cross);
        }
        let squared_distance = white.iter().map(|w| w * w).sum();
        self.become_finite(Self {
            mean,
            covariance: posterior,
        })?;
        Ok(Innovation {
            residual,
            covariance,
            squared_distance,
            log_evidence: log_density_at(squared_distance, &covariance),
        })
    }

    pub(super) fn become_finite(&mut self, next: Self) -> Result<(), KalmanError> {
        if !next.is_finite() {
            return Err(KalmanError::NotFinite);
        }
        *self = next;
        Ok(())
    }
}

fn times<const D: usize, const M: usize>(matrix: &[[f32; D]; M], vector: &[f32; D]) -> [f32; M] {
    let dot = |row: &[f32; D]| row.iter().zip(vector).map(|(a, b)| a * b).sum();
    matrix.each_ref().map(dot)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};
    use std::{vec, vec::Vec};

    /// The textbook filter in f64, as a reference.
    struct Textbook {
        mean: Vec<f64>,
        covariance: Vec<Vec<f64>>,
    }

    impl Textbook {
        fn predict(&mut self, transition: &[Vec<f64>], noise: &[Vec<f64>]) {
            let n = self.mean.len();
            self.mean = (0..n)
                .map(|i| (0..n).map(|j| transition[i][j] * self.mean[j]).sum())
                .collect();
            let mut next = noise.to_vec();
            for i in 0..n {
                for j in 0..n {
                    for k in 0..n {
                        for l in 0..n {
                            next[i][j] +=
                                transition[i][k] * self.covariance[k][l] * transition[j][l];
                        }
                    }
                }
            }
            self.covariance = next;
        }

        fn update(&mut self, row: &[f64], z: f64, variance: f64) -> f64 {
            let n = self.mean.len();
            let gain: Vec<f64> = (0..n)
                .map(|i| (0..n).map(|j| self.covariance[i][j] * row[j]).sum())
                .collect();
            let spread: f64 = variance + (0..n).map(|i| row[i] * gain[i]).sum::<f64>();
            let residual = z - (0..n).map(|i| row[i] * self.mean[i]).sum::<f64>();
            for i in 0..n {
                self.mean[i] += gain[i] / spread * residual;
                for j in 0..n {
                    self.covariance[i][j] -= gain[i] * gain[j] / spread;
                }
            }
            -0.5 * (residual * residual / spread + (core::f64::consts::TAU * spread).ln())
        }
    }

    #[test]
    fn agrees_with_the_textbook_in_double_precision() {
        let transition = [
            [1.0, 0.0, 0.5, 0.0],
            [0.0, 1.0, 0.0, 0.5],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let mut noise = Covariance::ZERO;
        noise.add([0.125, 0.0, 0.5, 0.0]);
        noise.add([0.0, 0.125, 0.0, 0.5]);
        let observation = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
        let wide = |rows: &[[f32; 4]]| rows.iter().map(|row| row.map(f64::from).to_vec()).collect();
        let (wide_transition, wide_noise): (Vec<Vec<f64>>, Vec<Vec<f64>>) =
            (wide(&transition), wide(&noise.matrix()));

        let mut state = Gaussian {
            mean: [0.0; 4],
            covariance: Covariance::diagonal([1000.0, 1000.0, 10.0, 10.0]),
        };
        let mut textbook = Textbook {
            mean: vec![0.0; 4],
            covariance: wide(&state.covariance.matrix()),
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(33);
        for step in 0..2000 {
            state.predict(&transition, &noise).unwrap();
            textbook.predict(&wide_transition, &wide_noise);
            let z = [
                300.0 * (step as f32 * 0.01).sin() + normal(&mut rng),
                100.0 + normal(&mut rng),
            ];
            let innovation = state
                .update(&observation, z, &Covariance::diagonal([1.0, 2.0]))
                .unwrap();
            let evidence = textbook.update(&[1.0, 0.0, 0.0, 0.0], f64::from(z[0]), 1.0)
                + textbook.update(&[0.0, 1.0, 0.0, 0.0], f64::from(z[1]), 4.0);
            assert!((f64::from(innovation.log_evidence) - evidence).abs() < 1e-3);
            let matrix = state.covariance.matrix();
            for (i, row) in matrix.iter().enumerate() {
                let sigma = textbook.covariance[i][i].sqrt();
                assert!((f64::from(state.mean[i]) - textbook.mean[i]).abs() < 1e-3 * sigma);
                for (j, entry) in row.iter().enumerate() {
                    let scale = sigma * textbook.covariance[j][j].sqrt();
                    let off = f64::from(*entry) - textbook.covariance[i][j];
                    assert!(off.abs() < 1e-4 * scale, "step {step}: {off} of {scale}");
                }
            }
        }
    }

    #[test]
    fn a_nearly_singular_covariance_stays_one_for_long() {
        // Ten orders of magnitude between what is known and what is not, and measurements that say the same
        // again and again: the textbook's P - K H P turns negative in f32 within a few steps.
        let mut state = Gaussian {
            mean: [0.0; 3],
            covariance: Covariance::diagonal([1e5; 3]),
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(34);
        let noise = Covariance::diagonal([1e-3]);
        let drift = Covariance::diagonal([1e-6; 3]);
        let still = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for step in 0..100_000 {
            state.predict(&still, &drift).unwrap();
            let row = [[1.0, 1.0 + 1e-4 * normal(&mut rng), 1e-4]];
            let innovation = state.update(&row, [1e-3 * normal(&mut rng)], &noise);
            assert!(innovation.unwrap().squared_distance >= 0.0);
            let sigmas = state.covariance.sigmas();
            assert!(
                sigmas.iter().all(|d| *d > 1e-6) && !state.covariance.is_singular(),
                "step {step}: {:?}",
                state.covariance
            );
        }
        // What was measured, the sum of the first two, is known to well below one measurement.
        let sum = Covariance::<1>::diagonal([0.0]);
        let innovation = state
            .update(&[[1.0, 1.0, 1e-4]], [0.0], &sum.plus(&noise))
            .unwrap();
        assert!(innovation.covariance.sigmas()[0] < 1.1e-3);
    }

    #[test]
    fn what_cannot_be_taken_in_changes_nothing() {
        let mut state = Gaussian {
            mean: [1.0, 2.0],
            covariance: Covariance::diagonal([1.0, 0.0]),
        };
        let before = state;
        let noise = Covariance::diagonal([1.0]);
        let row = [[1.0, 0.0]];
        assert_eq!(
            state.update(&row, [f32::NAN], &noise),
            Err(KalmanError::NotFinite)
        );
        assert_eq!(
            state.update(&[[f32::INFINITY, 0.0]], [0.0], &noise),
            Err(KalmanError::NotFinite)
        );
        assert_eq!(
            state.update(&[[0.0, 1.0]], [0.0], &Covariance::ZERO),
            Err(KalmanError::Singular)
        );
        assert_eq!(
            state.predict(&[[f32::NAN; 2]; 2], &Covariance::ZERO),
            Err(KalmanError::NotFinite)
        );
        assert_eq!(state, before);
        // An exact measurement of what is not known is fine.
        assert!(state.update(&row, [3.0], &Covariance::ZERO).is_ok());
        assert_eq!(state.mean, [3.0, 2.0]);
    }
}
