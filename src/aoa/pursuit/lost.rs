//! A source that is lost.

use super::Pursuit;
use super::cloud::COMPONENTS;
use super::component::Component;
use super::drive::Drive;
use crate::aoa::Observation;
use crate::estimate::largest_variance;
use crate::math::{sin_cos, sqrt};
use crate::random::{Rng, normal};

/// Bearings over which it is counted how many fit.
pub(super) const MEMORY: f32 = 8.0;
/// The source is lost when fewer fit, and seen again when more do.
const TOO_FEW: f32 = 0.3;
const ENOUGH: f32 = 0.5;

/// For how long the source has been lost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lost {
    pub(super) seconds: f32,
    pub(super) bearings: u32,
}

impl<const N: usize, const B: usize> Pursuit<N, B> {
    /// Looks for a source that is lost on the ray of a bearing.
    pub(super) fn search<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        drive: &Drive,
        seconds: f32,
        rng: &mut R,
    ) {
        /// Share of the distributions that are put there at a time.
        const SHARE: f32 = 0.2;
        if self.fitted > ENOUGH {
            self.lost = None;
        }
        if seconds == 0.0 || self.fitted > TOO_FEW && self.lost.is_none() {
            return;
        }
        let lost = self.lost.get_or_insert(Lost {
            seconds: 0.0,
            bearings: 0,
        });
        lost.seconds += seconds;
        lost.bearings += 1;
        let Some(seen) = self.seen else {
            return;
        };
        let spread = sqrt(largest_variance(&seen.covariance))
            + self.settings.habits.speed * (lost.seconds + MEMORY * seconds);
        if !self.cloud.is_alive() {
            return;
        }
        if self.may_be_parked() {
            self.parked *= 1.0 - SHARE;
        }
        let ray = Ray {
            observation,
            about: seen.position,
            spread,
        };
        let count = SHARE * COMPONENTS as f32;
        self.cloud.admit(SHARE, count, rng, |rng| {
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
    spread: f32,
}

impl Ray<'_> {
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> Component {
        /// Standard deviation of each of them along the ray.
        const LENGTH: f32 = 0.3;
        let [px, py] = self.observation.position();
        let (sin, cos) = sin_cos(self.observation.bearing().radians());
        let middle = (self.about[0] - px) * cos + (self.about[1] - py) * sin;
        let range = (middle + self.spread * normal(rng)).abs();
        let along = LENGTH * self.spread;
        let across = range * self.observation.deviation();
        let (along, across) = (along * along, across * across);
        let xy = (along - across) * sin * cos;
        Component::at_place(
            [px + range * cos, py + range * sin],
            [
                along * cos * cos + across * sin * sin,
                xy,
                along * sin * sin + across * cos * cos,
            ],
        )
    }
}
