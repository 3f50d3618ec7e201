//! A bearing in f64.

use core::f64::consts::{PI, TAU};

use foxhunt::aoa::{Bearing, Observation, ObservationError};

/// What [`Observation`] is to the library: one bearing and where it was taken, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// When it was taken, in milliseconds.
    pub time_ms: u32,
    /// Where it was taken, in metres east and north of the origin.
    pub position: [f64; 2],
    /// Direction of the source, in radians counter-clockwise from east.
    pub bearing: f64,
    /// Standard deviation of `bearing`, in radians.
    pub sigma: f64,
}

impl Sight {
    /// How far the bearing is from the direction of `place`: measured less true, in (-pi, pi].
    pub fn residual(&self, place: [f64; 2]) -> f64 {
        wrap(self.bearing - direction(self.position, place))
    }
}

impl TryFrom<Sight> for Observation {
    type Error = ObservationError;

    fn try_from(sight: Sight) -> Result<Self, ObservationError> {
        Self::new(
            sight.time_ms,
            sight.position.map(|v| v as f32),
            Bearing::from_radians(sight.bearing as f32),
            sight.sigma as f32,
        )
    }
}

impl From<&Observation> for Sight {
    fn from(observation: &Observation) -> Self {
        Self {
            time_ms: observation.time_ms(),
            position: observation.position().map(f64::from),
            bearing: f64::from(observation.bearing().radians()),
            sigma: f64::from(observation.sigma_rad()),
        }
    }
}

/// Direction from one place to another, in radians counter-clockwise from east.
pub fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::atan2(to[1] - from[1], to[0] - from[0])
}

/// The same angle in (-pi, pi].
pub fn wrap(angle: f64) -> f64 {
    let angle = angle % TAU;
    let angle = if angle < 0.0 { angle + TAU } else { angle };
    if angle > PI { angle - TAU } else { angle }
}
