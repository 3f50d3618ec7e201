//! A source that is lost.

use super::cloud::COMPONENTS;
use super::component::Component;
use super::config::Config;
use super::drive::Drive;
use super::state::{Lost, MEMORY, Manoeuvring};
use crate::aoa::Observation;
use crate::aoa::track::Stationary;
use crate::estimate::Symmetric2;
use crate::math::{sin_cos, sqrt};
use crate::random::{Rng, normal};

/// The source is lost when more of the latest bearings are outliers: lower searches for sources that were never lost,
const TOO_MANY: f32 = 0.7;

/// and it is seen again when fewer are.
const FEW_ENOUGH: f32 = 0.5;

/// Fraction of the components that each bearing on a lost source puts on its ray: the more, the sooner one of them is right,
/// and the fewer remember where the source was.
const SEARCHING: f32 = 0.2;

/// Standard deviation of such a component along the ray, as a fraction of that of all: small enough for a bearing from
/// elsewhere to be linear, large enough for some two dozen to cover the ray.
const LENGTH: f32 = 0.3;

impl<L: Stationary> Manoeuvring<L> {
    /// Looks for a lost source on the ray of a bearing.
    pub(super) fn search<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        drive: &Drive,
        config: &Config<L::Config>,
        rng: &mut R,
    ) {
        if self.misfit < FEW_ENOUGH {
            self.lost = Lost::NOT;
        }
        let is_lost = self.lost.bearings > 0 || self.misfit >= TOO_MANY;
        if drive.seconds == 0.0 || !is_lost {
            return;
        }
        self.lost.seconds += drive.seconds;
        self.lost.bearings += 1;
        let Some(seen) = self.seen.filter(|_| self.cloud.is_alive()) else {
            return;
        };
        if self.may_be_stationary() {
            self.moved += SEARCHING * (1.0 - self.moved);
        }
        let ray = Ray {
            observation,
            about: seen.position,
            sigma_m: sqrt(seen.covariance.largest_eigenvalue())
                + config.speed_m_s * (self.lost.seconds + MEMORY * drive.seconds),
        };
        let count = SEARCHING * COMPONENTS as f32;
        self.cloud.admit(SEARCHING, count, rng, |rng| {
            let mut component = ray.draw(rng);
            drive.accelerate(&mut component, rng);
            component
        });
    }
}

/// Places in the direction of a bearing, more or less near to where a source was seen.
struct Ray<'a> {
    observation: &'a Observation,
    about: [f32; 2],
    sigma_m: f32,
}

impl Ray<'_> {
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> Component {
        let [px, py] = self.observation.position();
        let (sin, cos) = sin_cos(self.observation.bearing().radians());
        let middle = (self.about[0] - px) * cos + (self.about[1] - py) * sin;
        let range = (middle + self.sigma_m * normal(rng)).abs();
        let along = LENGTH * self.sigma_m;
        let across = range * self.observation.sigma_rad();
        let (along, across) = (along * along, across * across);
        Component::stationary(
            [px + range * cos, py + range * sin],
            Symmetric2::isotropic(across).plus_outer(along - across, [cos, sin]),
        )
    }
}
