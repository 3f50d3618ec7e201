//! A normal distribution.

use super::Covariance;
use crate::math::LN_TAU;
use crate::math::vector::{difference, plus_scaled};
use crate::random::{Rng, normal};

/// A normal distribution of `D` dimensions: the state of a Kalman filter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gaussian<const D: usize> {
    /// Its centre.
    pub mean: [f32; D],
    /// Its spread.
    pub covariance: Covariance<D>,
}

impl<const D: usize> Gaussian<D> {
    /// A random sample.
    pub fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> [f32; D] {
        let offset = self.covariance.colour([(); D].map(|()| normal(rng)));
        plus_scaled(offset, 1.0, self.mean)
    }

    /// Natural logarithm of the density; not finite where the covariance is singular.
    pub fn log_density(&self, point: [f32; D]) -> f32 {
        let white = self.covariance.whiten(difference(point, self.mean));
        let squares: f32 = white.iter().map(|w| w * w).sum();
        log_density_at(squares, &self.covariance)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.mean.iter().all(|x| x.is_finite()) && self.covariance.is_finite()
    }
}

/// Natural logarithm of a normal density `squares` squared sigmas from its mean.
pub(super) fn log_density_at<const D: usize>(squares: f32, covariance: &Covariance<D>) -> f32 {
    -0.5 * (squares + D as f32 * LN_TAU) - covariance.half_ln_determinant()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    #[test]
    fn samples_have_the_moments_and_the_density_integrates_to_one() {
        let gaussian = Gaussian {
            mean: [1.0, -2.0],
            covariance: Covariance::new(&[[4.0, 1.5], [1.5, 1.0]]).unwrap(),
        };
        // The standard error of each moment is below 0.015: five of them.
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(32);
        let mut moments = [0f64; 5];
        for _ in 0..200_000 {
            let [x, y] = gaussian.draw(&mut rng).map(f64::from);
            let (x, y) = (x - 1.0, y + 2.0);
            for (sum, value) in moments.iter_mut().zip([x, y, x * x, x * y, y * y]) {
                *sum += value / 200_000.0;
            }
        }
        for (found, expected) in moments.iter().zip([0.0, 0.0, 4.0, 1.5, 1.0]) {
            assert!((found - expected).abs() < 0.07, "{moments:?}");
        }

        let mut sum = 0.0;
        for i in -100..100 {
            for j in -100..100 {
                let point = [1.0 + 0.12 * i as f32, -2.0 + 0.07 * j as f32];
                sum += gaussian.log_density(point).exp() * (0.12 * 0.07);
            }
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }
}
