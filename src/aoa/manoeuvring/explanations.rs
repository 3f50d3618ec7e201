//! The probabilities of both explanations.

use super::cloud::COMPONENTS;
use super::component::{Component, KnownBias};
use super::drive::Drive;
use super::state::{MEMORY, Manoeuvring, Phase};
use crate::aoa::Observation;
use crate::aoa::robust::Errors;
use crate::aoa::track::{Stationary, odds_by_moments};
use crate::estimate::Symmetric2;
use crate::random::Rng;

/// Least probability that a stationary source is still there, after any time without a bearing: it may have returned. The
/// smaller, the longer it takes to find a source again that never left.
const RETURNED: f32 = 1e-3;

/// Least fraction of the components that have departed since the latest bearing: the smaller, the fewer follow a departure
/// that is noticed at once; the larger, the fewer are left for earlier ones.
const NEWEST: f32 = 1.0 / 16.0;

/// Departures that have less than this fraction of the weight of all that have moved are not worth components.
const NEGLIGIBLE: f32 = 1e-3;

/// Mean and covariance of position and bias, as the stationary locator knows them.
pub(super) type Moments = ([f32; 3], [[f32; 3]; 3]);

/// What is stationary where the stationary locator says.
pub(super) fn stationary_there(([x, y, _], covariance): &Moments) -> Component {
    let [[xx, xy, _], [_, yy, _], _] = *covariance;
    Component::stationary([*x, *y], Symmetric2 { xx, xy, yy })
}

impl<L: Stationary> Manoeuvring<L> {
    /// Lets time pass: what moves goes on, and some of what was stationary at `place` departs.
    pub(super) fn let_time_pass<R: Rng + ?Sized>(
        &mut self,
        drive: &Drive,
        place: &Moments,
        rng: &mut R,
    ) {
        if self.cloud.is_alive() {
            self.cloud.predict(drive, self.latest_position(), rng);
        }
        if !self.may_be_stationary() {
            return;
        }
        let stayed = 1.0 - drive.departed();
        let stayed = if stayed > RETURNED { stayed } else { RETURNED };
        let departed = (1.0 - stayed) * (1.0 - self.moved);
        self.moved += departed;
        let mass = departed / self.moved;
        // NaN, if nothing moves.
        if mass > NEGLIGIBLE {
            let mass = if mass < 0.999 { mass } else { 0.999 };
            let count = if mass > NEWEST { mass } else { NEWEST } * COMPONENTS as f32;
            if self.phase == Phase::Stationary {
                let ([_, _, mean], [_, _, [_, _, variance]]) = *place;
                self.cloud.bias = KnownBias { mean, variance };
            }
            let place = stationary_there(place);
            self.cloud.admit(mass, count, rng, |rng| {
                let mut component = place;
                drive.depart(&mut component, rng);
                component
            });
        }
    }

    /// Weighs both explanations by a bearing: that of a stationary source by the normal distribution of where it was.
    pub(super) fn weigh(&mut self, observation: &Observation, place: &Moments, errors: &Errors) {
        let moved = if self.cloud.is_alive() {
            self.moved * self.cloud.update(observation, errors)
        } else {
            0.0
        };
        let mut total = moved;
        if self.may_be_stationary() {
            total += (1.0 - self.moved) * (1.0 + odds_by_moments(observation, errors, place));
            self.moved = moved / total;
        }
        self.misfit += (1.0 / total - self.misfit) / MEMORY;
    }
}
