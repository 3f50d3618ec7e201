//! The probabilities of both explanations: when the source is said to move, to have stopped, and to be lost.

use super::component::{Component, KnownBias};
use super::drive::Drive;
use super::{Config, Lost, MEMORY, Manoeuvring, Phase, seconds};
use crate::aoa::robust::Errors;
use crate::aoa::track::{Stationary, odds_by_moments};
use crate::aoa::{Alternative, Observation};
use crate::estimate::Symmetric2;
use crate::math::{larger, sin_cos, smaller, sqrt};
use crate::random::{Rng, normal};

/// Least probability that a stationary source is still there, after any time without a bearing: it may have returned. The
/// smaller, the longer it takes to find a source again that never left.
const RETURNED: f32 = 1e-3;

/// Least fraction of the components that have departed since the latest bearing: the smaller, the fewer follow a departure
/// that is noticed at once; the larger, the fewer are left for earlier ones.
const NEWEST: f32 = 1.0 / 16.0;

/// Departures that have less than this fraction of the weight of all that have moved are not worth components.
const NEGLIGIBLE: f32 = 1e-3;

/// Probability of having moved above which the answer says so: lower notices a departure sooner, with more false alarms.
const MOVED: f32 = 0.5;

/// Probability of having moved below which the answer takes it back: the gap to `MOVED` keeps answers from flickering.
const NOT_MOVED: f32 = 0.2;

/// Probability below which the explanation that the source is stationary is given up: lower keeps the locator longer from
/// looking for the next stop.
const GIVEN_UP: f32 = 1e-3;

/// Prior probability that a source has stopped where the stationary locator finds a place: higher reports stops sooner,
/// with more false ones.
const STOPPED: f32 = 0.005;

/// Probability of having stopped from which on the stationary locator takes the bearings since then: lower finds stops
/// with fewer new bearings, and takes more that are from before.
const PROBABLY_STOPPED: f32 = 0.3;

/// Bearings after which the stationary locator starts again if it has found no place: fewer drop bearings on a stop,
/// more keep those from before it.
const BEARINGS_TO_STOP: u32 = 30;

/// Bearings on a lost source after which everything starts again: fewer give up sources that would be found again.
pub(super) const BEARINGS_TO_START_OVER: u32 = 40;

/// The latest bearings that everything starts again with: fewer take longer to a fix, more are from before the loss.
const BEARINGS_KEPT: usize = 12;

/// Fraction of outliers among the latest bearings from which the source counts as lost: lower searches for sources that
/// were never lost.
const TOO_MANY: f32 = 0.7;

/// Fraction below which a lost source counts as found again. The gap to `TOO_MANY` keeps the state from flickering.
const FEW_ENOUGH: f32 = 0.5;

/// Fraction of the components that each bearing on a lost source puts on its ray: the more, the sooner one of them is right,
/// and the fewer remember where the source was.
const SEARCHING: f32 = 0.2;

/// Standard deviation of such a component along the ray, as a fraction of that of all: small enough for a bearing from
/// elsewhere to be linear, large enough for some two dozen to cover the ray.
const LENGTH: f32 = 0.3;

/// Mean and covariance of position and bias, as the stationary locator knows them.
pub(super) type Moments = ([f32; 3], [[f32; 3]; 3]);

/// A stationary component at the place that the stationary locator has found.
pub(super) fn stationary_there<const K: usize>(([x, y, _], covariance): &Moments) -> Component<K> {
    let [[xx, xy, _], [_, yy, _], _] = *covariance;
    Component::stationary([*x, *y], Symmetric2 { xx, xy, yy })
}

impl<L: Stationary, const K: usize, const N: usize> Manoeuvring<L, K, N> {
    /// Lets time pass: the cloud moves on, and some components depart from the stationary source at `place`.
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
        let stayed = larger(stayed, RETURNED);
        let departed = (1.0 - stayed) * (1.0 - self.moved);
        if departed <= 0.0 && self.moved <= 0.0 {
            return;
        }
        self.moved += departed;
        let mass = departed / self.moved;
        if mass > NEGLIGIBLE {
            let mass = smaller(mass, 0.999);
            let count = larger(mass, NEWEST) * N as f32;
            if self.phase == Phase::Stationary {
                let ([_, _, mean], [_, _, [_, _, variance]]) = *place;
                self.cloud.bias = KnownBias { mean, variance };
            }
            let place = stationary_there(place);
            self.cloud.insert(mass, count, rng, |rng| {
                let mut component = place;
                drive.depart(&mut component, rng);
                component
            });
        }
    }

    /// Weighs both explanations by the bearings of a reading: that of a stationary source by the normal distribution of where it was.
    pub(super) fn weigh(&mut self, reading: &[Alternative], place: &Moments, errors: &Errors) {
        let moved = if self.cloud.is_alive() {
            self.moved * self.cloud.update(reading, errors)
        } else {
            0.0
        };
        let mut total = moved;
        if self.may_be_stationary() {
            let odds = |one: &Alternative| {
                one.probability() * odds_by_moments(one.observation(), errors, place)
            };
            total += (1.0 - self.moved) * (1.0 + reading.iter().map(odds).sum::<f32>());
            self.moved = moved / total;
        }
        // total = 1 + odds, so 1 / total is the probability that this bearing is an outlier.
        self.outlier_fraction += (1.0 / total - self.outlier_fraction) / MEMORY;
    }

    /// Whether the explanation that the source is stationary has a probability.
    pub(super) fn may_be_stationary(&self) -> bool {
        self.phase != Phase::Moving
    }

    /// Goes from one phase to another.
    pub(super) fn update_phase(&mut self, config: &Config<L::Config>) {
        if self.lost.bearings > BEARINGS_TO_START_OVER {
            return self.start_over(config);
        }
        let has_fix = self.stationary.fix().is_some();
        if self.phase == Phase::Moving {
            self.tries += 1;
            if has_fix {
                self.phase = Phase::Departing;
                self.moved = 1.0 - STOPPED;
            } else if self.tries > BEARINGS_TO_STOP {
                self.look_for_a_stop(config);
            }
        }
        if !self.may_be_stationary() {
            return;
        }
        if has_fix && self.cloud.is_alive() {
            // Components that have stopped there are the same explanation.
            let place = stationary_there(&self.stationary.moments());
            self.moved *= 1.0 - self.cloud.remove(|component| component.is_at(&place));
        }
        if !self.cloud.is_alive() {
            self.moved = 0.0;
        }
        if 1.0 - self.moved < GIVEN_UP {
            self.phase = Phase::Moving;
            self.look_for_a_stop(config);
        } else if self.moved > MOVED {
            self.phase = Phase::Departing;
        } else if self.moved < NOT_MOVED {
            self.phase = Phase::Stationary;
            self.learned = self.stationary.learned();
        }
    }

    /// Restarts the stationary locator about where the source is now.
    fn look_for_a_stop(&mut self, config: &Config<L::Config>) {
        self.moved = 1.0;
        self.tries = 0;
        let (position, covariance) = self.cloud.position();
        let sigma = sqrt(covariance.largest_eigenvalue());
        let range_m = 3.0 * sigma + 10.0 * config.speed_m_s;
        let range_m = smaller(range_m, 1e6);
        let stopped = self.cloud.stopped();
        // Not those from before it stopped, as far as can be told; the latest in any case.
        let since = if stopped.probability < PROBABLY_STOPPED {
            0.0
        } else {
            stopped.seconds - sqrt(stopped.variance)
        };
        self.stationary.restart(&self.learned);
        if let Some(latest) = self.recent.back() {
            for old in &self.recent {
                let age = seconds(latest.since_ms(old.time_ms()));
                if age == 0.0 || age < since {
                    self.stationary.recall(old, &config.stationary);
                }
            }
        }
        self.stationary.centre_prior(position, range_m);
    }

    /// Starts again with the latest bearings alone.
    pub(super) fn start_over(&mut self, config: &Config<L::Config>) {
        self.cloud.clear();
        self.moved = 0.0;
        self.phase = Phase::Stationary;
        self.outlier_fraction = 0.0;
        self.lost = Lost::NO;
        self.seen = None;
        self.stationary.restart(&self.learned);
        let skipped = self.recent.len().saturating_sub(BEARINGS_KEPT);
        for old in self.recent.iter().skip(skipped) {
            self.stationary.recall(old, &config.stationary);
        }
    }

    /// Looks for a lost source on the ray of a bearing.
    pub(super) fn search<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        drive: &Drive,
        config: &Config<L::Config>,
        rng: &mut R,
    ) {
        if self.outlier_fraction < FEW_ENOUGH {
            self.lost = Lost::NO;
        }
        let is_lost = self.lost.bearings > 0 || self.outlier_fraction >= TOO_MANY;
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
        let ray = SearchRay {
            observation,
            about: seen.position,
            sigma_m: sqrt(seen.covariance.largest_eigenvalue())
                + config.speed_m_s * (self.lost.seconds + MEMORY * drive.seconds),
        };
        let count = SEARCHING * N as f32;
        self.cloud.insert(SEARCHING, count, rng, |rng| {
            let mut component = ray.draw(rng);
            drive.accelerate(&mut component, rng);
            component
        });
    }
}

/// Places in the direction of a bearing, more or less near to where a source was seen.
struct SearchRay<'a> {
    observation: &'a Observation,
    about: [f32; 2],
    sigma_m: f32,
}

impl SearchRay<'_> {
    fn draw<const K: usize, R: Rng + ?Sized>(&self, rng: &mut R) -> Component<K> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    /// A ray to the north-east, from a place where the source was 500 m along it.
    #[test]
    fn places_lie_on_the_ray_about_where_the_source_was() {
        let sigma_m = 50.0;
        let bearing = Bearing::from_radians(core::f32::consts::FRAC_PI_4);
        let observation = Observation::new(0, [100.0, 200.0], bearing, 0.02).unwrap();
        let middle = 500.0 * core::f32::consts::FRAC_1_SQRT_2;
        let about = [100.0 + middle, 200.0 + middle];
        let ray = SearchRay {
            observation: &observation,
            about,
            sigma_m,
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        for _ in 0..100 {
            let place = ray.draw::<0, _>(&mut rng);
            let [x, y] = [0, 1].map(|d| place.position[d] - about[d]);
            let (along, across) = (0.5 * (x + y), x - y);
            assert!(along.abs() < 5.0 * sigma_m && across.abs() < 1e-3);
            let Symmetric2 { xx, xy, yy } = place.position_covariance;
            let (along, across) = (0.5 * (xx + yy) + xy, 0.5 * (xx + yy) - xy);
            // 0.02 at 250 to 750 m.
            assert!((5.0_f32.powi(2)..15.0_f32.powi(2)).contains(&across));
            assert!((along.sqrt() / (LENGTH * sigma_m) - 1.0).abs() < 1e-3);
        }
    }
}
