//! Exact answers in f64, to measure the library against.

mod bound;
mod brute;
mod cell;
pub mod corridor;
pub mod gamma;
mod gauss_newton;
pub mod growth;
mod kalman;
mod kept;
mod likelihood;
mod line;
mod model;
mod pending;
mod posterior;
pub mod remembering;
mod scales;
mod sums;
mod von_mises;
mod walker;

#[cfg(test)]
mod tests;

pub use bound::{cramer_rao, cramer_rao_of_biased};
pub use brute::{Brute, Difference, Grid};
pub use gauss_newton::{Maximum, gauss_newton};
pub use kalman::Kalman;
pub use model::{Biases, ByDirection, Model, Prior, biases_by_station, turns};
pub use posterior::{Posterior, Square};
pub use von_mises::von_mises;
pub use walker::Walkers;

use nalgebra::{Matrix2, Vector2};

/// Square root of the squared Mahalanobis distance of `error` under `covariance`.
pub fn mahalanobis(error: [f64; 2], covariance: &Matrix2<f64>) -> f64 {
    let error = Vector2::from(error);
    match covariance.cholesky() {
        Some(factor) => error.dot(&factor.solve(&error)).sqrt(),
        None => f64::INFINITY,
    }
}
