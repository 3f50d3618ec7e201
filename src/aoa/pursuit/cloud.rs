//! A source that has moved: a mixture over what it may have done.

use super::component::{Component, Offset, Symmetric};
use super::drive::Drive;
use crate::aoa::Observation;
use crate::aoa::robust::{Errors, Shares};
use crate::math::{exp, ln};
use crate::random::Rng;
use crate::resample::{Scheme, resample};
use crate::weights;

/// How many normal distributions the mixture is of.
pub(super) const COMPONENTS: usize = 128;

/// Normal distributions with weights: a mixture Kalman filter (Chen and Liu 2000), whose samples are the times at which
/// the source departed, turned and stopped.
#[derive(Debug, Clone)]
pub(super) struct Cloud {
    pub(super) components: [Component; COMPONENTS],
    pub(super) log_weights: [f32; COMPONENTS],
    /// They sum to one.
    pub(super) weights: [f32; COMPONENTS],
    /// Logarithm of what the log-weights stand for.
    pub(super) log_sum: f32,
    pub(super) effective_sample_size: f32,
    pub(super) offset: Offset,
    pub(super) alive: bool,
}

/// What of a cloud is at rest.
#[derive(Clone, Copy)]
pub(super) struct AtRest {
    /// By weight.
    pub(super) share: f32,
    /// For so many seconds: mean and variance.
    pub(super) seconds: f32,
    pub(super) variance: f32,
}

impl Cloud {
    pub(super) const fn new() -> Self {
        Self {
            components: [Component::new(); COMPONENTS],
            log_weights: [0.0; COMPONENTS],
            weights: [1.0 / COMPONENTS as f32; COMPONENTS],
            log_sum: ln(COMPONENTS as f32),
            effective_sample_size: COMPONENTS as f32,
            offset: Offset {
                mean: 0.0,
                variance: 1.0,
            },
            alive: false,
        }
    }

    pub(super) fn clear(&mut self) {
        self.alive = false;
    }

    pub(super) const fn is_alive(&self) -> bool {
        self.alive
    }

    pub(super) const fn effective_sample_size(&self) -> f32 {
        self.effective_sample_size
    }

    /// Replaces `count` components, evenly among all, by some that `draw` makes and that have `share` of the mass; all
    /// if there were none.
    pub(super) fn admit<R: Rng + ?Sized>(
        &mut self,
        share: f32,
        count: f32,
        rng: &mut R,
        mut draw: impl FnMut(&mut R) -> Component,
    ) {
        let all = COMPONENTS as f32;
        let (share, count) = if self.alive {
            self.resample(rng);
            (share, count)
        } else {
            (1.0, all)
        };
        let (old, new) = if count < all {
            (ln((1.0 - share) / (all - count)), ln(share / count))
        } else {
            (0.0, -ln(all))
        };
        // Every so many components one is new.
        let mut due = 0.0;
        for (component, weight) in self.components.iter_mut().zip(&mut self.log_weights) {
            due += count;
            let is_new = due >= all;
            if is_new {
                due -= all;
                *component = draw(rng);
            }
            *weight = if is_new { new } else { old };
        }
        self.alive = true;
        self.normalise();
    }

    fn normalise(&mut self) {
        if let Some(normalised) = weights::normalise(&mut self.log_weights, &mut self.weights) {
            self.log_sum = normalised.log_sum;
            self.effective_sample_size = normalised.effective_sample_size;
        }
    }

    /// Lets time pass, until a bearing is taken somewhere.
    pub(super) fn predict<R: Rng + ?Sized>(&mut self, drive: &Drive, from: [f32; 2], rng: &mut R) {
        for component in &mut self.components {
            drive.step(component, rng);
            component.divide(from, rng);
        }
    }

    /// Takes a bearing into all components, and returns the mean of one plus its odds.
    pub(super) fn take(&mut self, observation: &Observation, errors: &Errors) -> f32 {
        for (component, weight) in self.components.iter_mut().zip(&mut self.weights) {
            *weight = ln(component.take(observation, errors, self.offset));
        }
        let before = self.log_sum;
        let Some(normalised) = weights::reweigh(&mut self.log_weights, &mut self.weights) else {
            self.normalise();
            return 1.0;
        };
        self.log_sum = normalised.log_sum;
        self.effective_sample_size = normalised.effective_sample_size;
        exp(normalised.shift + normalised.log_sum - before)
    }

    /// Mean odds of a bearing not being wild, if everything goes straight on until it is taken; none if nothing has moved.
    pub(super) fn odds(&self, observation: &Observation, errors: &Errors, seconds: f32) -> f32 {
        if !self.alive {
            return 0.0;
        }
        let odds = self.iter().map(|(component, weight)| {
            let mut component = *component;
            component.travel(seconds, 1.0);
            weight * component.odds(observation, errors, self.offset).0
        });
        odds.sum()
    }

    /// The probabilities that a bearing is direct, mirrored or wild.
    pub(super) fn classify(&self, observation: &Observation, errors: &Errors) -> Shares {
        let [mut direct, mut mirror, mut wild] = [0.0; 3];
        for (component, weight) in self.iter() {
            let (odds, mirrored) = component.odds(observation, errors, self.offset);
            let other = weight / (1.0 + odds);
            wild += other;
            *if mirrored { &mut mirror } else { &mut direct } += weight - other;
        }
        Shares {
            direct,
            mirror,
            wild,
        }
    }

    pub(super) fn resample_below<R: Rng + ?Sized>(&mut self, share: f32, rng: &mut R) {
        if self.effective_sample_size < share * COMPONENTS as f32 {
            self.resample(rng);
        }
    }

    /// In place: the ancestors are in order, so that what one that comes from below needs is never overwritten by one
    /// that comes from above.
    fn resample<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        let ancestors = resample(
            Scheme::Systematic,
            &self.weights,
            &mut self.log_weights,
            rng,
        );
        let mut copy = |to: usize, from: usize| {
            if let Some(component) = self.components.get(from).copied()
                && let Some(place) = self.components.get_mut(to)
            {
                *place = component;
            }
        };
        for (to, from) in ancestors.iter().enumerate() {
            if from > to {
                copy(to, from);
            }
        }
        let indices = self.log_weights.iter().enumerate().rev();
        for (to, from) in indices.map(|(to, from)| (to, from.to_bits() as usize)) {
            if from < to {
                copy(to, from);
            }
        }
        self.log_weights = [0.0; COMPONENTS];
        self.weights = [1.0 / COMPONENTS as f32; COMPONENTS];
        self.log_sum = ln(COMPONENTS as f32);
        self.effective_sample_size = COMPONENTS as f32;
    }

    /// Gives up some components, and returns what their share was.
    pub(super) fn give_up(&mut self, which: impl Fn(&Component) -> bool) -> f32 {
        let mut share = 0.0;
        let weights = self.log_weights.iter_mut().zip(&self.weights);
        for (component, (log_weight, weight)) in self.components.iter().zip(weights) {
            if *weight > 0.0 && which(component) {
                *log_weight = f32::NEG_INFINITY;
                share += weight;
            }
        }
        if share > 0.999 {
            self.clear();
            share = 1.0;
        } else if share > 0.0 {
            self.normalise();
        }
        share
    }

    fn iter(&self) -> impl Iterator<Item = (&Component, f32)> + Clone {
        self.components.iter().zip(self.weights.iter().copied())
    }

    /// Mean and covariance of the place.
    pub(super) fn place(&self) -> ([f32; 2], Symmetric) {
        let of = |(component, weight): (&Component, f32)| {
            (component.place, component.place_spread, weight)
        };
        moments(self.iter().map(of))
    }

    /// Mean and variance, of either component, of the velocity of those that drive.
    pub(super) fn velocity(&self) -> ([f32; 2], f32) {
        let driving = self.iter().filter(|(component, _)| component.rest < 0.0);
        let of = |(component, weight): (&Component, f32)| {
            (component.velocity, component.velocity_spread, weight)
        };
        let (mean, [uu, _, vv]) = moments(driving.map(of));
        (mean, 0.5 * (uu + vv))
    }

    pub(super) fn at_rest(&self) -> AtRest {
        let (mut share, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (component, weight) in self.iter() {
            if component.rest >= 0.0 {
                share += weight;
                sum += weight * component.rest;
                squares += weight * component.rest * component.rest;
            }
        }
        let mass = if share > 1e-9 { share } else { 1e-9 };
        let seconds = sum / mass;
        let variance = squares / mass - seconds * seconds;
        AtRest {
            share,
            seconds,
            variance: if variance > 0.0 { variance } else { 0.0 },
        }
    }
}

fn moments(
    parts: impl Iterator<Item = ([f32; 2], Symmetric, f32)> + Clone,
) -> ([f32; 2], Symmetric) {
    let (mut mass, mut x, mut y) = (1e-9, 0.0, 0.0);
    for ([a, b], _, weight) in parts.clone() {
        mass += weight;
        x += weight * a;
        y += weight * b;
    }
    let (x, y) = (x / mass, y / mass);
    let mut spread = [0.0; 3];
    for ([a, b], [xx, xy, yy], weight) in parts {
        let (a, b) = (a - x, b - y);
        spread[0] += weight * (xx + a * a);
        spread[1] += weight * (xy + a * b);
        spread[2] += weight * (yy + b * b);
    }
    ([x, y], spread.map(|sum| sum / mass))
}
