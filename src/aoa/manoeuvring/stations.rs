//! A source among fixed stations: what is learned of their biases is kept whether it moves or not, so the cloud is the only
//! explanation from the first fix on.

use super::biases::StationBiases;
use super::component::{Component, Heard, KnownBias};
use super::drive::Drive;
use super::explanations::BEARINGS_TO_START_OVER;
use super::{Config, MEMORY, Manoeuvring, Phase, seconds};
use crate::aoa::core::{check_narrow, square_of_distance};
use crate::aoa::robust::Errors;
use crate::aoa::robust::outside::successive;
use crate::aoa::track::{Stationary, Track, reading_of};
use crate::aoa::{Alternative, Observation, PushError};
use crate::math::sqrt;
use crate::random::{Rng, uniform};

/// Largest standard deviation of the first position, as a fraction of the range, and rounds of bearings after which a larger one
/// will do: less is more linear, more follows a source sooner.
const NARROW: f32 = 0.25;
const ROUNDS: u32 = 4;

/// Fraction of the variance of the first position that is left to each component: less linearises bearings better about where
/// it is, more leaves more components when most have turned out to be elsewhere.
const LEFT: f32 = 0.25;

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

    /// Whether the source is known well enough for the cloud to start: its components are linear only so far. It starts anyway
    /// when it has taken long, for the source may move.
    pub(super) fn may_follow(&self) -> bool {
        let Some(fix) = self.stationary.fix() else {
            return false;
        };
        let range = square_of_distance(fix.position, self.latest_position());
        let is_narrow = check_narrow(fix.covariance.largest_eigenvalue(), range, NARROW).is_ok();
        is_narrow || self.bearings >= ROUNDS * K as u32
    }

    /// Starts the cloud from the first fix: at rest or not, as it is at any time.
    pub(super) fn start_to_follow<R: Rng + ?Sized>(
        &mut self,
        config: &Config<L::Config>,
        rng: &mut R,
    ) {
        let (Some(fix), errors) = (self.stationary.fix(), self.errors_beside_biases(config)) else {
            return;
        };
        let sigma = errors.sigma_scale * self.errors(config).stop_sigma_rad;
        let bias = KnownBias {
            mean: 0.0,
            variance: 0.0,
        };
        let heard = (0..K).filter_map(|station| {
            let is_of = |old: &&Observation| StationBiases::<K>::index(old) == Some(station);
            let observation = self.recent.iter().rev().find(is_of)?;
            Some(Heard {
                observation,
                errors: &errors,
                bias,
                probability: 1.0,
            })
        });
        let left = fix.covariance.scaled(LEFT);
        // Of the spread of places, so that with what is left to each it is that of the fix.
        let drawn = sqrt(1.0 - LEFT);
        let cloud = self.stationary.cloud(0);
        let anywhere = |rng: &mut R| {
            let cloud = cloud?;
            let mut left = uniform(rng);
            let i = cloud.weights.iter().position(|weight| {
                left -= weight;
                left < 0.0
            })?;
            Some([*cloud.east.get(i)?, *cloud.north.get(i)?])
        };
        let drive = Drive::new(config, 0.0);
        let moving = config.moving_s / (config.moving_s + config.stationary_s);
        (self.cloud).insert(1.0, N as f32, rng, |rng| {
            let [[x, y], [mx, my]] = [anywhere(rng).unwrap_or(fix.position), fix.position];
            let place = [mx + drawn * (x - mx), my + drawn * (y - my)];
            let mut component = Component::among_stations(place, left, sigma, heard.clone());
            if uniform(rng) < moving {
                drive.accelerate(&mut component, rng);
            }
            component
        });
        (self.moved, self.phase) = (1.0, Phase::Moving);
    }
}
