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
//!   deviation of 6.3 m where the walls are 3.5 m apart (at most 3.1 m^2 fit), and along it 200 m^2, where matches err
//!   by a few metres. A filter that believes so little in its measurements lags behind a person who walks at 2.5 m/s
//!   by up to 7 m. Pass what the matches of the survey err by instead.
//! * The model is linear and its errors normal, so the Kalman filter is the exact answer for it, and the particle
//!   filter comes to the same with more work and noise. Particles earn their place where they are weighed by the map
//!   itself, see [`super::tracker`]: a match throws away that a scan may fit two places.
//!
//! ```
//! use foxhunt::fingerprint::published::{Cloud, Model};
//! use foxhunt::kalman::Covariance;
//! use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
//!
//! // Matches that err by 3 m along the tunnel and by 1 m across it.
//! let model = Model::AS_PRINTED.with_observation(Covariance::diagonal([3.0, 1.0]))?;
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
//! let mut cloud = Cloud::<300>::new();
//! cloud.start_around([0.0, 1.75], &model, &mut rng)?;
//! let mut kalman = model.kalman_start([0.0, 1.75])?;
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

use core::fmt;

use crate::kalman::Covariance;
use crate::model::ConstantVelocity;

pub use cloud::Cloud;

/// What is taken for true of a walk and of its matches. States are (x, y, vx, vy).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    observation: Covariance<2>,
    motion: ConstantVelocity,
    velocity: [f32; 2],
}

/// What of a [`Model`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ModelError {
    /// The covariance of a match is singular or not finite.
    Observation,
    /// A deviation of the acceleration is negative or not finite.
    Acceleration,
    /// A deviation of the first velocity is negative or not finite.
    Velocity,
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Observation => "the covariance of a match is singular or not finite",
            Self::Acceleration => "a deviation of the acceleration is negative or not finite",
            Self::Velocity => "a deviation of the velocity is negative or not finite",
        })
    }
}

impl core::error::Error for ModelError {}

/// Why a match was not taken in. The filter is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StepError {
    /// The match is not finite.
    Match,
    /// The time since the last step is negative or not finite.
    Time,
    /// The box of a start is none.
    Box,
    /// It is so far from everything that was thought possible that nothing would be left: start again.
    Impossible,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Match => "the match is not finite",
            Self::Time => "the time since the last step is negative or not finite",
            Self::Box => "the box of the start is none",
            Self::Impossible => "the match is too far from everything that was thought possible",
        })
    }
}

impl core::error::Error for StepError {}

impl Model {
    /// With the covariance diag(200, 40) m^2 that the paper prints and that cannot be. The paper leaves the rest open:
    /// accelerations of 0.5 along x and 0.1 m/s^2 along y, first velocities of 1.5 and 0.3 m/s.
    pub const AS_PRINTED: Self = Self {
        // The roots of 200 and 40.
        observation: Covariance::diagonal([14.142_136, 6.324_555_5]),
        motion: ConstantVelocity {
            sigma_m_s2: [0.5, 0.1],
        },
        velocity: [1.5, 0.3],
    };

    /// The covariance of a match, in square metres.
    ///
    /// # Errors
    /// [`ModelError::Observation`] when it is singular or not finite.
    pub fn with_observation(mut self, covariance: Covariance<2>) -> Result<Self, ModelError> {
        let [[a, b], [_, c]] = *covariance.columns();
        if !(a > 0.0 && c > 0.0 && a.is_finite() && b.is_finite() && c.is_finite()) {
            return Err(ModelError::Observation);
        }
        self.observation = covariance;
        Ok(self)
    }

    /// Standard deviations of the acceleration along x and along y, in metres per second squared.
    ///
    /// # Errors
    /// [`ModelError::Acceleration`] when one is negative or not finite.
    pub fn with_acceleration(mut self, acceleration: [f32; 2]) -> Result<Self, ModelError> {
        if !are_deviations(acceleration) {
            return Err(ModelError::Acceleration);
        }
        self.motion = ConstantVelocity {
            sigma_m_s2: acceleration,
        };
        Ok(self)
    }

    /// Standard deviations of the first velocity, about zero, along x and along y, in metres a second.
    ///
    /// # Errors
    /// [`ModelError::Velocity`] when one is negative or not finite.
    pub fn with_velocity(mut self, velocity: [f32; 2]) -> Result<Self, ModelError> {
        if !are_deviations(velocity) {
            return Err(ModelError::Velocity);
        }
        self.velocity = velocity;
        Ok(self)
    }
}

fn are_deviations(deviations: [f32; 2]) -> bool {
    deviations.iter().all(|d| *d >= 0.0 && d.is_finite())
}

fn check_match(found: [f32; 2]) -> Result<(), StepError> {
    if found.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(StepError::Match)
    }
}

fn check_time(dt: f32) -> Result<(), StepError> {
    if dt >= 0.0 && dt.is_finite() {
        Ok(())
    } else {
        Err(StepError::Time)
    }
}

#[cfg(test)]
mod tests;
