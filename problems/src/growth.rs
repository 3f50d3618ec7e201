//! The univariate growth model, on which every particle filter is tried.
//!
//! x_k = x / 2 + 25 x / (1 + x^2) + 8 cos(1.2 (k - 1)) + u, y_k = x_k^2 / 20 + v, u and v standard normal,
//! x_0 = 0.1 (Gordon, Salmond and Smith 1993). The measurement does not know the sign, so the posterior has two
//! modes. 50 steps; the exact filter's pooled RMSE is 3.01.

use foxhunt::kalman::Covariance;
use foxhunt::math::sin_cos;
use foxhunt::model::{Dynamics, Likelihood};
use foxhunt::proposal::{Sensor, Transition};
use foxhunt::random::{Rng, normal};

/// State before the first step.
pub const START: f32 = 0.1;

/// ln(2 pi) / 2
const HALF_LN_TAU: f32 = 0.918_938_5;

/// How the state comes to step `step`, counted from one. Time in seconds plays no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Growth {
    /// k
    pub step: u32,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// y
    pub value: f32,
}

/// An endless run: for each step from the first, its dynamics, the state there and the measurement of it.
pub fn simulate<R: Rng + ?Sized>(
    rng: &mut R,
) -> impl Iterator<Item = (Growth, f32, Measurement)> + use<'_, R> {
    let mut state = START;
    (1..).map(move |step| {
        let growth = Growth { step };
        [state] = growth.step([state], 1.0, rng);
        let value = state * state / 20.0 + normal(rng);
        (growth, state, Measurement { value })
    })
}

impl Dynamics<1> for Growth {
    fn step<R: Rng + ?Sized>(&self, state: [f32; 1], dt: f32, rng: &mut R) -> [f32; 1] {
        self.mean(&state, dt).map(|x| x + normal(rng))
    }
}

impl Transition<1> for Growth {
    fn mean(&self, [x]: &[f32; 1], _dt: f32) -> [f32; 1] {
        let (_, cos) = sin_cos(1.2 * (self.step as f32 - 1.0));
        [0.5 * x + 25.0 * x / (1.0 + x * x) + 8.0 * cos]
    }

    fn noise(&self, _dt: f32) -> Covariance<1> {
        Covariance::diagonal([1.0])
    }

    fn log_transition(&self, from: &[f32; 1], [to]: &[f32; 1], dt: f32) -> f32 {
        let [mean] = self.mean(from, dt);
        -0.5 * (to - mean) * (to - mean) - HALF_LN_TAU
    }
}

impl Likelihood<1> for Measurement {
    fn log_likelihood(&self, state: &[f32; 1]) -> f32 {
        let [residual] = self.residual(state);
        -0.5 * residual * residual - HALF_LN_TAU
    }
}

impl Sensor<1, 1> for Measurement {
    fn residual(&self, [x]: &[f32; 1]) -> [f32; 1] {
        [self.value - x * x / 20.0]
    }

    fn noise(&self) -> Covariance<1> {
        Covariance::diagonal([1.0])
    }
}
