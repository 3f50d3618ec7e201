//! Kalman filters: the exact answer for a linear model with normal noise, and the unscented one for others.
//!
//! The state is a [`Gaussian`]. It moves and learns by [`Gaussian::predict`] and [`Gaussian::update`], the Kalman
//! filter, where the model is a matrix, and by an [`Unscented`] filter where it is a function.
//!
//! Covariances are held and propagated as their Cholesky factors, and nothing is ever subtracted from one: an
//! update brings the joint factor of measurement and state into triangular form by rotations and takes the
//! posterior's factor out of its corner (Kailath, Sayed and Hassibi, "Linear Estimation" (2000), chapter 12). So a
//! covariance stays symmetric and positive semidefinite however long a filter runs, and f32 resolves variances
//! whose ratio is 10^14. Cost of an update: about `3 (D + M)^2 (D + M)` products for a state of `D` dimensions and
//! a measurement of `M`.
//!
//! A bearing of a source at rest, of which the plain Kalman filter cannot make use:
//!
//! ```
//! use foxhunt::kalman::{Covariance, Gaussian, Unscented};
//! use foxhunt::math::{atan2, wrap};
//!
//! let mut source = Gaussian { mean: [900.0, 900.0], covariance: Covariance::diagonal([300.0, 300.0]) };
//! let noise = Covariance::diagonal([0.02]);
//! for (receiver, bearing) in [([0.0, 0.0], 0.7854), ([1000.0, 0.0], 1.5708), ([2000.0, 0.0], 2.3562)] {
//!     let [px, py]: [f32; 2] = receiver;
//!     let residual = |[x, y]: &[f32; 2]| [wrap(bearing - atan2(y - py, x - px))];
//!     Unscented::DEFAULT.update(&mut source, residual, &noise)?;
//! }
//! assert!((source.mean[0] - 1000.0).abs() < 15.0 && (source.mean[1] - 1000.0).abs() < 15.0);
//! # Ok::<(), foxhunt::kalman::KalmanError>(())
//! ```

mod covariance;
mod gaussian;
mod linear;
mod unscented;

pub use covariance::Covariance;
pub use gaussian::Gaussian;
pub use unscented::Unscented;

use crate::error::messages;

/// What a measurement of `M` dimensions told that the filter did not expect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Innovation<const M: usize> {
    /// Measured less expected, in the units of the measurement.
    pub residual: [f32; M],
    /// How far the residual should scatter.
    pub covariance: Covariance<M>,
    /// Square of the residual in sigmas: chi-squared with `M` degrees of freedom when the model is
    /// right, so a measurement far beyond that does not fit.
    pub squared_distance: f32,
    /// Natural logarithm of the density of the measurement, given all earlier ones.
    pub log_evidence: f32,
}

/// Why a step of a Kalman filter was refused; the state is as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum KalmanError {
    /// The result would hold NaN or an infinity: an argument does, or the model returned one.
    NotFinite,
    /// The measurement has no uncertainty at all in some direction, so it cannot be weighed against the state.
    Singular,
}

messages!(KalmanError {
    Self::NotFinite => "the result is not finite",
    Self::Singular => "the measurement has no uncertainty",
});
