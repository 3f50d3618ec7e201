//! The Kalman filter that the paper compares with: for its model, the exact answer.

use super::Model;
use foxhunt::kalman::{Covariance, Gaussian, Innovation, KalmanError};

impl Model {
    /// The state after the first match, for [`Model::kalman_step`].
    pub fn kalman_start(&self, found: [f32; 2]) -> Gaussian<4> {
        let [[a, b], [_, c]] = *self.observation.columns();
        let [vx, vy] = self.velocity_sigma_m_s;
        let mut covariance = Covariance::diagonal([0.0, 0.0, vx, vy]);
        covariance.add([a, b, 0.0, 0.0]);
        covariance.add([0.0, c, 0.0, 0.0]);
        Gaussian {
            mean: [found[0], found[1], 0.0, 0.0],
            covariance,
        }
    }

    /// Takes the match of a scan, `dt` seconds after the last one.
    ///
    /// # Errors
    /// [`KalmanError::NotFinite`], also for a match or a time that is not; the state is then as before.
    pub fn kalman_step(
        &self,
        state: &mut Gaussian<4>,
        dt: f32,
        found: [f32; 2],
    ) -> Result<Innovation<2>, KalmanError> {
        const OBSERVATION: [[f32; 4]; 2] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
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
        next.predict(&transition, &noise)?;
        let innovation = next.update(&OBSERVATION, found, &self.observation)?;
        *state = next;
        Ok(innovation)
    }
}
