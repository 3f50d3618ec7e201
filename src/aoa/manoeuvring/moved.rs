//! The explanation that the source has moved: a mixture over what it may have done.

use super::biases::StationBiases;
use super::component::{Component, Heard, KnownBias};
use super::drive::Drive;
use crate::aoa::robust::Errors;
use crate::aoa::{Alternative, Bias, Mixture, Observation};
use crate::estimate::Symmetric2;
use crate::math::{exp, larger, ln, sqrt};
use crate::persist;
use crate::random::{Rng, uniform};
use crate::resample::Scheme;
use crate::weights::Weights;

/// Effective sample size, as a fraction of the components, below which they are resampled: the usual one half.
const RESAMPLE_BELOW: f32 = 0.5;

/// Steps of this part of a circle never leave a large gap.
pub(super) const GOLDEN: f32 = 0.618_034;

/// What is left of the weights when nearly everything was removed counts as nothing.
const ALL: f32 = 0.999;

/// `N` normal distributions with weights: a mixture Kalman filter (Chen and Liu 2000), whose samples are the times at which
/// the source departed, turned and stopped.
#[derive(Debug, Clone)]
pub(super) struct Moved<const K: usize, const N: usize> {
    pub(super) components: [Component<K>; N],
    pub(super) weights: Weights<N>,
    pub(super) bias: KnownBias,
    alive: bool,
}

persist!(impl[const K: usize, const N: usize] Moved<K, N> as "Moved"() { components, weights, bias, alive });

/// The stationary components.
#[derive(Clone, Copy)]
pub(super) struct Stopped {
    /// Sum of their weights.
    pub(super) probability: f32,
    /// Mean of the seconds for which they have been stationary.
    pub(super) seconds: f32,
    /// Variance of these seconds.
    pub(super) variance: f32,
}

impl<const K: usize, const N: usize> Moved<K, N> {
    pub(super) const EMPTY: Self = Self {
        components: [Component::stationary([0.0; 2], Symmetric2::ZERO); N],
        weights: Weights::EMPTY,
        bias: KnownBias {
            mean: 0.0,
            variance: 0.0,
        },
        alive: false,
    };

    pub(super) fn clear(&mut self) {
        self.alive = false;
    }

    pub(super) const fn is_alive(&self) -> bool {
        self.alive
    }

    pub(super) fn effective_sample_size(&self) -> f32 {
        self.weights.effective_sample_size()
    }

    /// Replaces `count` components, evenly among all, by some that `draw` makes and that get the fraction `mass` of the
    /// weight; all components if there were none.
    pub(super) fn insert<R: Rng + ?Sized>(
        &mut self,
        mass: f32,
        count: f32,
        rng: &mut R,
        mut draw: impl FnMut(&mut R) -> Component<K>,
    ) {
        let all = N as f32;
        let (mass, count) = if self.alive {
            self.resample(rng);
            (mass, count)
        } else {
            (1.0, all)
        };
        let (old, new) = if count < all {
            (ln((1.0 - mass) / (all - count)), ln(mass / count))
        } else {
            (0.0, -ln(all))
        };
        // New components are spread evenly among the others.
        let mut due = 0.0;
        let log_weights = self.weights.log_weights_mut();
        for (component, weight) in self.components.iter_mut().zip(log_weights) {
            due += count;
            let is_new = due >= all;
            if is_new {
                due -= all;
                *component = draw(rng);
            }
            *weight = if is_new { new } else { old };
        }
        self.alive = true;
        let _ = self.weights.normalise();
    }

    /// Lets time pass, until a bearing is taken somewhere.
    pub(super) fn predict<R: Rng + ?Sized>(&mut self, drive: &Drive, from: [f32; 2], rng: &mut R) {
        // Where stations have biases, no component is divided: what they have in common with the place would be drawn with it,
        // and a few components would have to hold what all bearings have taught of them.
        if K > 0 {
            return self.branch(drive, rng);
        }
        if self.effective_sample_size() < RESAMPLE_BELOW * N as f32 {
            self.resample(rng);
        }
        // Evenly over neighbours, too, which are copies after a resampling: of these as many turn and stop as should.
        let mut chance = uniform(rng);
        for component in &mut self.components {
            chance += GOLDEN;
            chance -= if chance < 1.0 { 0.0 } else { 1.0 };
            drive.step(component, chance, rng);
            component.divide(from, rng);
        }
    }

    /// Takes the bearings of a reading into all components, and returns the mean of one plus their odds.
    pub(super) fn update(&mut self, reading: &[Alternative], errors: &Errors) -> f32 {
        let bias = self.bias;
        fn heard<'a>(
            alternative: &'a Alternative,
            errors: &'a Errors,
            bias: KnownBias,
        ) -> Heard<'a> {
            Heard {
                observation: alternative.observation(),
                errors,
                bias,
                probability: alternative.probability(),
            }
        }
        let log_likelihoods = self.weights.log_likelihoods_mut();
        for (component, value) in self.components.iter_mut().zip(log_likelihoods) {
            *value = ln(component.update(reading.iter().map(|one| heard(one, errors, bias))));
        }
        self.weights.update().map_or(1.0, exp)
    }

    const fn heard<'a>(&self, observation: &'a Observation, errors: &'a Errors) -> Heard<'a> {
        Heard {
            observation,
            errors,
            bias: self.bias,
            probability: 1.0,
        }
    }

    /// Mean odds that a bearing is no outlier, if everything goes straight on for `seconds` until it is taken; zero if
    /// nothing has moved.
    pub(super) fn odds(&self, observation: &Observation, errors: &Errors, seconds: f32) -> f32 {
        if !self.alive {
            return 0.0;
        }
        let heard = self.heard(observation, errors);
        let odds = self.iter().map(|(component, weight)| {
            let mut component = *component;
            component.travel(seconds, 1.0);
            weight * component.odds(&heard).0
        });
        odds.sum()
    }

    /// The probabilities that a bearing is direct, mirrored or an outlier.
    pub(super) fn classify(&self, observation: &Observation, errors: &Errors) -> Mixture {
        let [mut direct, mut mirrored, mut outlier] = [0.0; 3];
        let heard = self.heard(observation, errors);
        for (component, weight) in self.iter() {
            let (odds, is_mirrored) = component.odds(&heard);
            let rest = weight / (1.0 + odds);
            outlier += rest;
            *(if is_mirrored {
                &mut mirrored
            } else {
                &mut direct
            }) += weight - rest;
        }
        Mixture {
            direct,
            mirrored,
            outlier,
        }
    }

    fn resample<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        let components = &mut self.components;
        (self.weights).resample(Scheme::Systematic, rng, |ancestors, _| {
            rearrange(components, ancestors.iter());
        });
    }

    /// Removes some components, and returns the sum of their weights.
    pub(super) fn remove(&mut self, which: impl Fn(&Component<K>) -> bool) -> f32 {
        let mut mass = 0.0;
        let (log_weights, weights) = self.weights.columns_mut();
        let weights = log_weights.iter_mut().zip(weights);
        for (component, (log_weight, weight)) in self.components.iter().zip(weights) {
            if *weight > 0.0 && which(component) {
                *log_weight = f32::NEG_INFINITY;
                mass += *weight;
            }
        }
        if mass > ALL {
            self.clear();
            mass = 1.0;
        } else if mass > 0.0 {
            let _ = self.weights.normalise();
        }
        mass
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&Component<K>, f32)> {
        (self.components.iter()).zip(self.weights.weights().iter().copied())
    }

    /// Mean and covariance of the position.
    pub(super) fn position(&self) -> ([f32; 2], Symmetric2) {
        self.moments(|component| Some((component.position, component.position_covariance)))
    }

    /// Mean and variance, of either component, of the velocity of those that move.
    pub(super) fn velocity(&self) -> ([f32; 2], f32) {
        let (mean, covariance) = self.moments(|component| {
            let velocity = (component.velocity, component.velocity_covariance);
            (!component.is_stationary()).then_some(velocity)
        });
        (mean, 0.5 * (covariance.xx + covariance.yy))
    }

    /// Mean and covariance of the mixture of what is normally distributed in some of the components.
    fn moments(
        &self,
        of: impl Fn(&Component<K>) -> Option<([f32; 2], Symmetric2)>,
    ) -> ([f32; 2], Symmetric2) {
        let parts =
            || (self.iter()).filter_map(|(component, weight)| Some((of(component)?, weight)));
        let (mut mass, mut x, mut y) = (1e-9, 0.0, 0.0);
        for (([a, b], _), weight) in parts() {
            mass += weight;
            x += weight * a;
            y += weight * b;
        }
        let (x, y) = (x / mass, y / mass);
        let mut sum = Symmetric2::ZERO;
        for (([a, b], covariance), weight) in parts() {
            sum = (sum.plus(&covariance.scaled(weight))).plus_outer(weight, [a - x, b - y]);
        }
        ([x, y], sum.scaled(1.0 / mass))
    }

    /// The bias of the station of a bearing; `None` where stations have none.
    pub(super) fn bias_of(&self, observation: &Observation) -> Option<Bias> {
        let station = StationBiases::<K>::index(observation)?;
        let (mut mean, mut square) = (0.0, 0.0);
        for (component, weight) in self.iter() {
            let (own, own_square) = component.biases.moments_of(station);
            mean += weight * own;
            square += weight * own_square;
        }
        let variance = square - mean * mean;
        Some(Bias {
            mean_rad: mean,
            sigma_rad: sqrt(larger(variance, 0.0)),
        })
    }

    pub(super) fn stopped(&self) -> Stopped {
        let (mut probability, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (component, weight) in self.iter().filter(|(it, _)| it.is_stationary()) {
            probability += weight;
            sum += weight * component.stationary_s;
            squares += weight * component.stationary_s * component.stationary_s;
        }
        let mass = larger(probability, 1e-9);
        let seconds = sum / mass;
        let variance = squares / mass - seconds * seconds;
        Stopped {
            probability,
            seconds,
            variance: larger(variance, 0.0),
        }
    }
}

/// Puts in every place what stands in that of its ancestor: these are in order, so that no copy from below overwrites what one
/// from above needs.
pub(super) fn rearrange<T: Copy>(
    items: &mut [T],
    ancestors: impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + Clone,
) {
    let mut copy = |to: usize, from: usize| {
        if let Some(item) = items.get(from).copied()
            && let Some(place) = items.get_mut(to)
        {
            *place = item;
        }
    };
    for (to, from) in ancestors.clone().enumerate() {
        if from > to {
            copy(to, from);
        }
    }
    for (to, from) in ancestors.enumerate().rev() {
        if from < to {
            copy(to, from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    /// Three have stopped, 2, 4 and 12 s ago, and one moves: a mean of 6 s, squares of 164 / 3 s^2.
    #[test]
    fn it_is_known_when_the_source_stopped() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut times = [2.0, -1.0, 4.0, 12.0].into_iter();
        let mut cloud = Moved::<0, 4>::EMPTY;
        cloud.insert(1.0, 4.0, &mut rng, |_| {
            let mut component = Component::stationary([0.0; 2], Symmetric2::ZERO);
            component.stationary_s = times.next().unwrap();
            component
        });
        let stopped = cloud.stopped();
        assert!((stopped.probability - 0.75).abs() < 1e-5);
        assert!((stopped.seconds - 6.0).abs() < 1e-4);
        assert!((stopped.variance - (164.0 / 3.0 - 36.0)).abs() < 1e-3);
        cloud.clear();
        assert!(!cloud.is_alive());
    }

    #[test]
    fn what_is_rearranged_comes_from_its_ancestors() {
        let mut items = [10, 11, 12, 13, 14];
        rearrange(&mut items, [1, 1, 1, 2, 4].into_iter());
        assert_eq!(items, [11, 11, 11, 12, 14]);
        let mut items = [10, 11, 12, 13, 14];
        rearrange(&mut items, [0, 0, 3, 4, 4].into_iter());
        assert_eq!(items, [10, 10, 13, 14, 14]);
    }
}
