//! The Kalman filter that the paper compares with: for its model, the exact answer.

use super::{Model, StepError, check_match, check_time};
use crate::kalman::{Covariance, Gaussian, Innovation};

impl Model {
    /// The state after the first match, for [`Model::kalman_step`].
    ///
    /// # Errors
    /// [`StepError::Match`].
    pub fn kalman_start(&self, found: [f32; 2]) -> Result<Gaussian<4>, StepError> {
        check_match(found)?;
        let [[a, b], [_, c]] = *self.observation.columns();
        let [vx, vy] = self.velocity_sigma_m_s;
        let mut covariance = Covariance::diagonal([0.0, 0.0, vx, vy]);
        covariance.add([a, b, 0.0, 0.0]);
        covariance.add([0.0, c, 0.0, 0.0]);
        Ok(Gaussian {
            mean: [found[0], found[1], 0.0, 0.0],
            covariance,
        })
    }

    /// Takes the match of a scan, `dt` seconds after the last one.
    ///
    /// # Errors
    /// [`StepError::Match`], [`StepError::Time`], or [`StepError::Impossible`] when the result would not be finite.
    pub fn kalman_step(
        &self,
        state: &mut Gaussian<4>,
        dt: f32,
        found: [f32; 2],
    ) -> Result<Innovation<2>, StepError> {
        const OBSERVATION: [[f32; 4]; 2] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
        check_match(found)?;
        check_time(dt)?;
        let transition = [
            [1.0, 0.0, dt, 0.0],
            [0.0, 1.0, 0.0, dt],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let [ax, ay] = self.acceleration_sigma_m_s2;
        let half = 0.5 * dt * dt;
        let mut noise = Covariance::ZERO;
        noise.add([half * ax, 0.0, dt * ax, 0.0]);
        noise.add([0.0, half * ay, 0.0, dt * ay]);
        let mut next = *state;
        next.predict(&transition, &noise)
            .map_err(|_| StepError::Impossible)?;
        let innovation = next
            .update(&OBSERVATION, found, &self.observation)
            .map_err(|_| StepError::Impossible)?;
        *state = next;
        Ok(innovation)
    }
}
