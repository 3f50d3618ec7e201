//! What either explanation is worth.

use super::Pursuit;
use super::cloud::COMPONENTS;
use super::component::{Component, Offset};
use super::drive::Drive;
use super::lost::MEMORY;
use super::phases::Phase;
use crate::aoa::Observation;
use crate::aoa::locator::Answer;
use crate::aoa::robust::outside::odds;
use crate::particles::read;
use crate::random::Rng;

/// The explanation that the source is parked survives any time between two bearings with this probability at least: who has gone may have come back.
const RETURNED: f32 = 1e-3;
/// Share of the newest distributions, at least.
const NEWEST: f32 = 1.0 / 16.0;

impl<const N: usize, const B: usize> Pursuit<N, B> {
    /// Whether there is an explanation at all.
    pub(super) fn is_tracking(&self) -> bool {
        self.cloud.is_alive() || matches!(self.locator.answer(), Answer::Fix(_))
    }

    /// What is parked where the locator says.
    pub(super) fn parked_there(&self) -> Component {
        let ([x, y, _], [[xx, xy, _], [_, yy, _], _]) = self.locator.moments();
        Component::at_place([x, y], [xx, xy, yy])
    }

    /// Lets time pass: what moves drives on, and some of what was parked departs.
    pub(super) fn wait<R: Rng + ?Sized>(&mut self, drive: &Drive, rng: &mut R) {
        self.cloud.resample_below(0.5, rng);
        if self.cloud.is_alive() {
            self.cloud.predict(drive, self.recent.place(), rng);
        }
        if !self.may_be_parked() {
            return;
        }
        let stayed = 1.0 - drive.departed();
        let stayed = if stayed > RETURNED { stayed } else { RETURNED };
        let departed = (1.0 - stayed) * self.parked;
        let moved = 1.0 - self.parked + departed;
        self.parked *= stayed;
        let share = departed / moved;
        // NaN, if nothing moves.
        if share > 1e-3 {
            let share = if share < 0.999 { share } else { 0.999 };
            let count = if share > NEWEST { share } else { NEWEST } * COMPONENTS as f32;
            let place = self.parked_there();
            if self.phase == Phase::Parked {
                let ([_, _, mean], [_, _, [_, _, variance]]) = self.locator.moments();
                self.cloud.offset = Offset { mean, variance };
            }
            self.cloud.admit(share, count, rng, |rng| {
                let mut component = place;
                drive.depart(&mut component, rng);
                component
            });
        }
    }

    /// Weighs both explanations by a bearing.
    pub(super) fn weigh(&mut self, observation: &Observation) {
        let moved = if self.cloud.is_alive() {
            (1.0 - self.parked) * self.cloud.take(observation, &self.errors)
        } else {
            0.0
        };
        let mut total = moved;
        if self.may_be_parked() {
            let columns = self.locator.columns();
            let (about, _) = self.locator.moments();
            let odds = odds(observation, &self.errors, &about);
            let mut mean = 0.0;
            for (i, weight) in self.locator.weights().iter().enumerate() {
                mean += weight * (1.0 + odds(&read(&columns, i)));
            }
            let parked = self.parked * mean;
            total += parked;
            self.parked = parked / total;
        }
        self.fitted += (1.0 - 1.0 / total - self.fitted) / MEMORY;
    }
}
