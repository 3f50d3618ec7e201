//! How a source drives, stops and drives on.

use super::component::{Component, DRIVING};
use super::settings::Habits;
use crate::math::{exp, ln, sqrt};
use crate::random::{Rng, normal, uniform, uniform_open};

/// A velocity that goes from one normal value to another as an Ornstein-Uhlenbeck process does, and the way meanwhile,
/// exactly, for any time.
#[derive(Clone, Copy)]
struct Leg {
    /// Correlation of the velocity at the end with that at the beginning.
    keep: f32,
    /// Deviation of what is new in the velocity.
    kick: f32,
    /// Mean of the way for a sum of both velocities of one metre a second, in seconds.
    reach: f32,
    /// Deviation of the way, given both velocities.
    scatter: f32,
}

impl Leg {
    /// `deviation` is that of either component of the velocity at any time; it lasts for `memory_s`.
    fn new(seconds: f32, memory_s: f32, deviation: f32) -> Self {
        let lengths = seconds / memory_s;
        let lost = passed(lengths);
        let tanh = lost / (2.0 - lost);
        // The difference of nearly equal numbers, unless by its series.
        let bend = if lengths < 0.5 {
            lengths * lengths * lengths * (1.0 - 0.1 * lengths * lengths) * (1.0 / 12.0)
        } else {
            lengths - 2.0 * tanh
        };
        Self {
            keep: 1.0 - lost,
            kick: deviation * sqrt(lost * (2.0 - lost)),
            reach: memory_s * tanh,
            scatter: deviation * memory_s * sqrt(2.0 * bend),
        }
    }

    fn drive(&self, component: &mut Component) {
        let square = self.kick * self.kick;
        component.travel(self.reach * (1.0 + self.keep), self.keep);
        component.disturb(
            self.reach * self.reach * square + self.scatter * self.scatter,
            self.reach * square,
            square,
        );
    }
}

/// 1 - e^-x, also where that is too small to be a difference.
fn passed(x: f32) -> f32 {
    if x < 0.02 {
        x * (1.0 - x * (0.5 - x / 6.0))
    } else {
        1.0 - exp(-x)
    }
}

/// An event that has happened within some time with a probability.
#[derive(Clone, Copy)]
struct Event {
    mean_s: f32,
    share: f32,
}

impl Event {
    fn new(seconds: f32, mean_s: f32) -> Self {
        Self {
            mean_s,
            share: passed(seconds / mean_s),
        }
    }

    /// When it happened, given that it did.
    fn after<R: Rng + ?Sized>(&self, rng: &mut R) -> f32 {
        -self.mean_s * ln(1.0 - self.share * uniform(rng))
    }
}

/// What may happen to a source in a certain time.
pub(super) struct Drive {
    seconds: f32,
    /// Of either component of the velocity.
    deviation: f32,
    straight: Leg,
    turn: Event,
    stop: Event,
    departure: Event,
}

impl Drive {
    /// On a straight road the velocity lasts for so many times the time until a turn.
    const STEADINESS: f32 = 20.0;

    pub(super) fn new(habits: &Habits, seconds: f32) -> Self {
        let deviation = core::f32::consts::FRAC_1_SQRT_2 * habits.speed;
        Self {
            seconds,
            deviation,
            straight: Leg::new(seconds, Self::STEADINESS * habits.straight_s, deviation),
            turn: Event::new(seconds, habits.straight_s),
            stop: Event::new(seconds, habits.driving_s),
            departure: Event::new(seconds, habits.parked_s),
        }
    }

    /// The probability that a parked source has departed.
    pub(super) fn departed(&self) -> f32 {
        self.departure.share
    }

    /// Gives it any velocity: drawn for the most part, because what is at any velocity is soon anywhere, where a
    /// bearing is no linear measurement.
    pub(super) fn accelerate<R: Rng + ?Sized>(&self, component: &mut Component, rng: &mut R) {
        const DRAWN: f32 = 0.8;
        let drawn = self.deviation * sqrt(DRAWN);
        let velocity = [drawn * normal(rng), drawn * normal(rng)];
        let variance = (1.0 - DRAWN) * self.deviation * self.deviation;
        component.set_velocity(velocity, variance);
        component.rest = DRIVING;
    }

    /// One that was parked and has departed since.
    pub(super) fn depart<R: Rng + ?Sized>(&self, component: &mut Component, rng: &mut R) {
        self.accelerate(component, rng);
        let left = self.seconds - self.departure.after(rng);
        let way = -self.stop.mean_s * ln(uniform_open(rng));
        if way < left {
            component.travel(way, 1.0);
            component.stop(left - way);
        } else {
            component.travel(left, 1.0);
        }
    }

    /// Lets the time pass.
    pub(super) fn step<R: Rng + ?Sized>(&self, component: &mut Component, rng: &mut R) {
        let parked = component.rest >= 0.0;
        let event = if parked { &self.departure } else { &self.stop };
        let happens = uniform(rng) < event.share;
        if parked {
            component.rest += self.seconds;
            if happens {
                self.depart(component, rng);
            }
        } else if happens {
            let way = event.after(rng);
            component.travel(way, 1.0);
            let left = self.seconds - way;
            component.stop(if left > 0.0 { left } else { 0.0 });
        } else if uniform(rng) < self.turn.share {
            // Half of the way as before, half of it as from now on.
            component.travel(0.5 * self.seconds, 1.0);
            self.accelerate(component, rng);
            component.travel(0.5 * self.seconds, 1.0);
        } else {
            self.straight.drive(component);
        }
    }
}
