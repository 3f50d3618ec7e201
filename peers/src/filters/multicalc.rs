//! `multicalc::estimation::ParticleFilter`, in either precision.

use multicalc::estimation::{Likelihood, ParticleFilter};
use multicalc::linear_algebra::{Matrix, Vector};
use multicalc::random::RandomScalar;
use multicalc::scalar::{Numeric, VectorFn};

use super::Filter;
use crate::workload::{BEARING_VARIANCE, CLOUD_SIGMA_M, SOURCE, Sighting, WALK_VARIANCE};

/// `multicalc`'s filter with its own generator and its default, systematic resampling, made to
/// resample after every bearing instead of below half the effective sample size.
pub struct Multicalc<T: RandomScalar>(ParticleFilter<2, 1, T>);

/// The state stays where it is; the crate adds the noise.
struct Stays;

impl VectorFn<2, 2> for Stays {
    fn eval<S: Numeric>(&self, state: &[S; 2]) -> [S; 2] {
        *state
    }
}

/// The bearing of a state from the place of a sighting.
struct BearingFrom([f32; 2]);

impl VectorFn<2, 1> for BearingFrom {
    fn eval<S: Numeric>(&self, state: &[S; 2]) -> [S; 1] {
        let [east, north] = self.0.map(|metres| S::from_f64(f64::from(metres)));
        [(state[1] - north).atan2(state[0] - east)]
    }
}

/// The crate's own Gaussian does not wrap angles; its manual asks for a likelihood like this.
struct WrappedGaussian<T> {
    precision: T,
}

impl<T: Numeric> Likelihood<1, T> for WrappedGaussian<T> {
    fn log_weight(&self, predicted: &[T; 1], measurement: &[T; 1]) -> T {
        let mut difference = measurement[0] - predicted[0];
        if difference > T::PI {
            difference -= T::TWO_PI;
        } else if difference < -T::PI {
            difference += T::TWO_PI;
        }
        -T::HALF * self.precision * difference * difference
    }
}

fn scalar<T: Numeric>(value: f32) -> T {
    T::from_f64(f64::from(value))
}

fn isotropic<T: Numeric>(variance: f32) -> Matrix<2, 2, T> {
    let variance = scalar(variance);
    Matrix::new([[variance, T::ZERO], [T::ZERO, variance]])
}

impl<const N: usize, T: RandomScalar + Into<f64>> Filter<N> for Multicalc<T> {
    fn new(seed: u64) -> Self {
        let filter = ParticleFilter::new(
            N,
            Vector::new(SOURCE.map(scalar)),
            isotropic(CLOUD_SIGMA_M * CLOUD_SIGMA_M),
            isotropic(WALK_VARIANCE),
            seed,
        )
        .expect("the workload's covariances are positive definite");
        Self(filter.with_resample_threshold(T::INFINITY))
    }

    fn step(&mut self, sighting: &Sighting) -> Option<[f32; 2]> {
        let likelihood = WrappedGaussian {
            precision: scalar(1.0 / BEARING_VARIANCE),
        };
        let measurement = Vector::new([scalar(sighting.bearing)]);
        self.0.predict(&Stays).ok()?;
        self.0
            .update(&BearingFrom(sighting.position), &likelihood, measurement)
            .ok()?;
        let mean = self.0.mean();
        Some([mean[0].into() as f32, mean[1].into() as f32])
    }
}
