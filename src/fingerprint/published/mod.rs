//! Match, then filter: the published tracker, to compare with.
//!
//! Cui, Wu, He and Wu, "Fingerprint tracking in a tunnel" (Application Research of Computers 34(5), 2017), eq. 8 to 16:
//! a [`super::Matcher`] says where a scan was taken, and a filter takes that place for a measurement with normal errors
//! of a person who keeps the velocity but for random accelerations. [`Cloud`] is their particle filter, and
//! [`Model::kalman_start`] their Kalman filter.
//!
//! Two traps:
//!
//! * The printed covariance of a match, [`Model::AS_PRINTED`], cannot be: the variance across the tunnel is 40 m^2, a
//!   sigma of 6.3 m where the walls are 3.5 m apart (at most 3.1 m^2 fit), and along it 200 m^2, where matches err
//!   by a few metres. A filter with such a covariance lags behind a person who walks at 2.5 m/s by up to 7 m. Pass the
//!   covariance of the errors of the survey's matches instead.
//! * The model is linear and its errors normal, so the Kalman filter is the exact answer for it, and the particle
//!   filter comes to the same with more work and noise. Particles are worth their cost where they are weighed by the map
//!   itself, see [`super::tracker`]: a match does not tell that a scan may fit two places.
//!
//! ```
//! use foxhunt::fingerprint::published::{Cloud, Model};
//! use foxhunt::kalman::Covariance;
//! use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
//!
//! // Matches that err by 3 m along the tunnel and by 1 m across it.
//! let model = Model { observation: Covariance::diagonal([3.0, 1.0]), ..Model::AS_PRINTED };
//! model.check()?;
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut cloud = Cloud::<300>::EMPTY;
//! cloud.start_around([0.0, 1.75], &model, &mut rng);
//! let mut kalman = model.kalman_start([0.0, 1.75]);
//! for found in [[3.5, 1.75], [6.0, 1.75], [9.5, 1.75]] {
//!     cloud.step(2.0, found, &model, &mut rng)?;
//!     model.kalman_step(&mut kalman, 2.0, found)?;
//! }
//! assert!((kalman.mean[0] - 9.5).abs() < 2.0);
//! assert!((cloud.mean()[0] - kalman.mean[0]).abs() < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cloud;
mod kalman;

use crate::ConfigError;
use crate::config::require;
use crate::kalman::Covariance;

pub use cloud::Cloud;

/// How a person walks, and how matches scatter. States are (x, y, vx, vy).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Covariance of a match, in square metres.
    pub observation: Covariance<2>,
    /// Standard deviations of the acceleration along x and along y, in metres per second squared.
    pub acceleration_sigma_m_s2: [f32; 2],
    /// Standard deviations of the first velocity about zero, along x and along y, in metres a second.
    pub velocity_sigma_m_s: [f32; 2],
}

impl Model {
    /// With the covariance diag(200, 40) m^2 that the paper prints and that cannot be. The paper leaves the rest open.
    pub const AS_PRINTED: Self = Self {
        // The roots of 200 and 40.
        observation: Covariance::diagonal([14.142_136, 6.324_555_5]),
        acceleration_sigma_m_s2: [0.5, 0.1],
        velocity_sigma_m_s: [1.5, 0.3],
    };

    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        const fn is_sigma(sigma: f32) -> bool {
            sigma >= 0.0 && sigma.is_finite()
        }
        let [[a, b], [_, c]] = *self.observation.columns();
        require!(
            a > 0.0 && c > 0.0 && a.is_finite() && b.is_finite() && c.is_finite(),
            "observation is singular or not finite"
        );
        let [x, y] = self.acceleration_sigma_m_s2;
        require!(
            is_sigma(x) && is_sigma(y),
            "acceleration_sigma_m_s2 is negative or not finite"
        );
        let [x, y] = self.velocity_sigma_m_s;
        require!(
            is_sigma(x) && is_sigma(y),
            "velocity_sigma_m_s is negative or not finite"
        );
        Ok(())
    }
}

#[cfg(test)]
mod tests;
