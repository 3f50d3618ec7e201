//! The exact filter of a linear model with Gaussian noise.

use nalgebra::{SMatrix, SVector};

/// Kalman filter with `D` states and scalar measurements.
#[derive(Debug, Clone)]
pub struct Kalman<const D: usize> {
    /// Mean of the state.
    pub mean: SVector<f64, D>,
    /// Covariance of the state.
    pub covariance: SMatrix<f64, D, D>,
}

impl<const D: usize> Kalman<D> {
    /// Moves the state: x' = `transition` x + noise of covariance `process`.
    pub fn predict(&mut self, transition: &SMatrix<f64, D, D>, process: &SMatrix<f64, D, D>) {
        self.mean = transition * self.mean;
        self.covariance = transition * self.covariance * transition.transpose() + process;
    }

    /// Takes in z = `row` x + noise of variance `variance`.
    /// Returns the logarithm of the evidence, the density of z given all before it.
    pub fn update(&mut self, row: &SMatrix<f64, 1, D>, z: f64, variance: f64) -> f64 {
        let innovation = z - (row * self.mean)[0];
        let spread = (row * self.covariance * row.transpose())[0] + variance;
        let gain = self.covariance * row.transpose() / spread;
        self.mean += gain * innovation;
        self.covariance -= gain * row * self.covariance;
        -0.5 * (innovation * innovation / spread + (std::f64::consts::TAU * spread).ln())
    }
}
