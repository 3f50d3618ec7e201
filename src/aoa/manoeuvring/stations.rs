//! A source among fixed stations: what is learned of their biases is kept whether it moves or not, so the cloud is the only
//! explanation from the first fix on.

use core::f32::consts::TAU;

use super::biases::StationBiases;
use super::component::Component;
use super::drive::Drive;
use super::explanations::BEARINGS_TO_START_OVER;
use super::moved::GOLDEN;
use super::{Config, MEMORY, Manoeuvring, Phase, seconds};
use crate::aoa::core::{check_narrow, square_of_distance};
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::successive;
use crate::aoa::track::{Stationary, Track, reading_of};
use crate::aoa::{Alternative, Observation, PushError};
use crate::estimate::Symmetric2;
use crate::math::{larger, sin_cos, sqrt};
use crate::random::{Rng, uniform};

/// Largest standard deviation of the first position, as a fraction of the range, for which the cloud starts before all stations
/// have heard the source, and rounds of bearings after which it starts in any case: less is more linear, more follows a source
/// sooner.
const NARROW: f32 = 0.25;
const ROUNDS: u32 = 4;

/// Sigmas of the first fix within which components start: more find who is elsewhere, fewer put them closer together.
const REACH: f32 = 4.0;

/// Times that components are spread, each about what the time before has told: the first fix is rough.
const SPREADS: u32 = 2;

impl<L: Stationary, const K: usize, const N: usize> Manoeuvring<L, K, N> {
    /// The errors of a bearing beside the bias of its station.
    pub(super) fn errors_beside_biases(&self, config: &Config<L::Config>) -> Errors {
        let mut errors = self.errors(config);
        if K > 0 {
            errors.stop_sigma_rad = 0.0;
        }
        errors
    }

    /// Whether a bearing can be taken.
    fn admit(&self, observation: &Observation) -> Result<(), PushError> {
        let Some(latest) = self.recent.back() else {
            return Ok(());
        };
        let same = |old: &Observation| {
            (old.time_ms(), old.station()) == (observation.time_ms(), observation.station())
        };
        if self.recent.iter().any(same) {
            Err(PushError::Duplicate)
        } else if observation.since_ms(latest.time_ms()) < 0 {
            Err(PushError::TooOld)
        } else {
            Ok(())
        }
    }

    /// Takes the bearings of a reading into the cloud alone.
    pub(super) fn follow<R: Rng + ?Sized>(
        &mut self,
        best: &Observation,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
        rng: &mut R,
    ) -> Result<(), PushError> {
        self.admit(best)?;
        let elapsed_ms = (self.recent.back()).map_or(0, |latest| best.since_ms(latest.time_ms()));
        let mut errors = self.errors_beside_biases(config);
        let since = self.since_station_heard(best);
        // The same for all components: what differs among them would count with every reading, however much repeats.
        let about = self.cloud.position().0;
        let fresh = reading_of(alternatives, |one| {
            one.with_observation(successive(one.observation(), since, &errors, about))
        });
        (errors.sigma_scale, errors.position_sigma_m) = (1.0, 0.0);
        self.keep(best);
        let drive = Drive::new(config, seconds(elapsed_ms));
        self.cloud.predict(&drive, best.position(), rng);
        let total = self.cloud.update(&fresh, &errors);
        self.outlier_fraction += (1.0 / total - self.outlier_fraction) / MEMORY;
        self.search(best, &drive, config, rng);
        if self.lost.bearings > BEARINGS_TO_START_OVER {
            self.start_over(config);
        }
        Ok(())
    }

    /// Seconds since the latest bearing of the same station. What that says is no matter: stations hear many readings a second,
    /// of which those that differ repeat, too.
    fn since_station_heard(&self, observation: &Observation) -> f32 {
        /// After which nothing repeats.
        const LONG_S: f32 = 1e6;
        let is_of_it = |old: &&Observation| old.station() == observation.station();
        let latest = self.recent.iter().rev().find(is_of_it);
        latest.map_or(LONG_S, |old| seconds(observation.since_ms(old.time_ms())))
    }

    /// The latest bearing of a station.
    fn latest_of(&self, station: usize) -> Option<&Observation> {
        let is_of = |old: &&Observation| StationBiases::<K>::index(old) == Some(station);
        self.recent.iter().rev().find(is_of)
    }

    /// Whether the source is known well enough for the cloud to start: by all stations or, once as many bearings have come, by
    /// those that hear it. It starts anyway when it has taken long, for the source may move.
    pub(super) fn may_follow(&self) -> bool {
        let Some(fix) = self.stationary.fix() else {
            return false;
        };
        let range = square_of_distance(fix.position, self.latest_position());
        let is_narrow = check_narrow(fix.covariance.largest_eigenvalue(), range, NARROW).is_ok();
        let by_all = (0..K).all(|station| self.latest_of(station).is_some());
        let enough = self.bearings >= K as u32 && (is_narrow || by_all);
        enough || self.bearings >= ROUNDS * K as u32
    }

    /// Starts the cloud about the first fix, at rest or not, as it is at any time. What is known of the place and the biases then
    /// is what components learn from the latest bearing of each station that were evenly spread before.
    pub(super) fn start_to_follow<R: Rng + ?Sized>(
        &mut self,
        config: &Config<L::Config>,
        rng: &mut R,
    ) {
        let (Some(fix), errors) = (self.stationary.fix(), self.errors_beside_biases(config)) else {
            return;
        };
        let sigma = errors.sigma_scale * self.errors(config).stop_sigma_rad;
        let drive = Drive::new(config, 0.0);
        let moving = config.moving_s / (config.moving_s + config.stationary_s);
        let (mut middle, mut covariance) = (fix.position, fix.covariance);
        for _ in 0..SPREADS {
            let mut places = spread(middle, covariance, N);
            // Neighbours overlap so far that all together are even.
            let own = covariance.scaled(REACH * REACH / N as f32);
            self.cloud.clear();
            (self.cloud).insert(1.0, N as f32, rng, |rng| {
                let place = places.next().unwrap_or(middle);
                let mut component = Component::among_stations(place, own, sigma);
                if uniform(rng) < moving {
                    drive.accelerate(&mut component, rng);
                }
                component
            });
            for station in 0..K {
                if let Some(observation) = self.latest_of(station).copied() {
                    self.cloud.update(&[observation.into()], &errors);
                }
            }
            (middle, covariance) = self.cloud.position();
        }
        (self.moved, self.phase) = (1.0, Phase::Moving);
    }
}

/// So many places, evenly spread over the ellipse of `REACH` sigmas about a mean as seeds are over a sunflower.
fn spread(mean: [f32; 2], covariance: Symmetric2, count: usize) -> impl Iterator<Item = [f32; 2]> {
    // The square root of the matrix, by the theorem of Cayley and Hamilton.
    let product = sqrt(larger(covariance.determinant(), 0.0));
    let trace = covariance.xx + covariance.yy + 2.0 * product;
    let root = covariance.plus(&Symmetric2::isotropic(product));
    let root = root.scaled(1.0 / sqrt(larger(trace, f32::MIN_POSITIVE)));
    (0..count).map(move |i| {
        let radius = REACH * sqrt((i as f32 + 0.5) / count as f32);
        let (sin, cos) = sin_cos(TAU * GOLDEN * i as f32);
        let [x, y] = root.times([radius * cos, radius * sin]);
        [mean[0] + x, mean[1] + y]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An even distribution over an ellipse has a quarter of the square of its axes for a covariance.
    #[test]
    fn places_are_evenly_spread() {
        const COUNT: usize = 1024;
        let covariance = Symmetric2 {
            xx: 4.0,
            xy: -1.2,
            yy: 1.0,
        };
        let (mut sum, mut squares) = ([0.0; 2], Symmetric2::ZERO);
        for [x, y] in spread([7.0, -3.0], covariance, COUNT) {
            let offset = [x - 7.0, y + 3.0];
            assert!(covariance.is_within(offset, REACH));
            sum = [sum[0] + offset[0], sum[1] + offset[1]];
            squares = squares.plus_outer(1.0 / COUNT as f32, offset);
        }
        let expected = covariance.scaled(0.25 * REACH * REACH);
        let close = |a: f32, b: f32| (a - b).abs() < 0.01 * expected.xx;
        assert!(close(squares.xx, expected.xx), "{squares:?}");
        assert!(close(squares.xy, expected.xy), "{squares:?}");
        assert!(close(squares.yy, expected.yy), "{squares:?}");
        let mean = sum.map(|sum| sum / COUNT as f32);
        assert!(mean.iter().all(|mean| mean.abs() < 0.02), "{mean:?}");

        let nowhere = spread([1.0, 2.0], Symmetric2::ZERO, 3);
        assert!(nowhere.into_iter().all(|place| place == [1.0, 2.0]));
    }
}
