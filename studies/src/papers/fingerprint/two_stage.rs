//! Match, then filter: the tracker of the paper.
//!
//! Eq. 8 to 16: a [`Matcher`](foxhunt::fingerprint::Matcher) says where a scan was taken, and a filter takes that place
//! for a measurement with normal errors of a person who keeps the velocity but for random accelerations. [`Cloud`] is their
//! particle filter, and [`Model::kalman_start`] their Kalman filter.
//!
//! Two traps:
//!
//! * The printed covariance of a match, [`Model::AS_PRINTED`], cannot be: the variance across the tunnel is 40 m^2, a
//!   sigma of 6.3 m where the walls are 3.5 m apart (at most 3.1 m^2 fit), and along it 200 m^2, where matches err
//!   by a few metres. A filter with such a covariance lags behind a person who walks at 2.5 m/s by up to 7 m. Pass the
//!   covariance of the errors of the survey's matches instead.
//! * The model is linear and its errors normal, so the Kalman filter is the exact answer for it, and the particle
//!   filter comes to the same with more work and noise. Particles are worth their cost where they are weighed by the map
//!   itself, see [`foxhunt::fingerprint::tracker`]: a match does not tell that a scan may fit two places.

mod cloud;
mod kalman;

use foxhunt::kalman::Covariance;

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
}

#[cfg(test)]
mod tests;
