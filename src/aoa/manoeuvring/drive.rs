//! How a source moves, stops and departs again.

use super::component::Component;
use super::config::Config;
use crate::math::{larger, ln, one_minus_exp, sqrt};
use crate::random::{Rng, normal, uniform, uniform_open};

/// On a straight road the velocity is remembered for so many times the time until a turn: the larger, the straighter a
/// road is taken to be, and the more components a slow bend costs.
const STRAIGHTNESS: f32 = 20.0;

/// Fraction of the variance of a new velocity that is drawn, rather than left to the Kalman filter: the smaller, the sooner
/// a component is so long that a bearing is no linear measurement of it; the larger, the fewer velocities are covered.
const DRAWN: f32 = 0.8;

/// Fraction of new velocities that are those of the slowest source: more follow somebody on foot sooner and leave fewer
/// components for a car.
const SLOW: f32 = 0.25;

/// Among stations, time for which a pause may be over at any moment, in seconds: whoever has stood for longer is thought to
/// stand for about as long again, up to the configured mean. More is sure of a place sooner, and notices later that somebody
/// walks on.
const PAUSE_S: f32 = 5.0;

/// Among stations, departures are drawn as if there was one in so many seconds, and count for less: fewer seconds leave less
/// of the cloud to the source at rest, more are late to follow one that hardly ever departs.
const DRAWN_EVERY_S: f32 = 15.0;

/// A velocity that follows an Ornstein-Uhlenbeck process, and the way meanwhile: exact for any time.
#[derive(Clone, Copy)]
struct Leg {
    /// Correlation of the velocity at the end with that at the beginning.
    keep: f32,
    /// Standard deviation of what is new in the velocity.
    kick: f32,
    /// Mean of the way for a sum of both velocities of one metre a second, in seconds.
    reach: f32,
    /// Standard deviation of the way, given both velocities.
    scatter: f32,
}

impl Leg {
    /// `sigma_m_s` is that of either component of the velocity at any time; `memory_s` its correlation time.
    fn new(seconds: f32, memory_s: f32, sigma_m_s: f32) -> Self {
        let lengths = seconds / memory_s;
        let lost = one_minus_exp(lengths);
        let tanh = lost / (2.0 - lost);
        // The difference of nearly equal numbers, unless by its series.
        let bend = if lengths < 0.5 {
            lengths * lengths * lengths * (1.0 - 0.1 * lengths * lengths) * (1.0 / 12.0)
        } else {
            lengths - 2.0 * tanh
        };
        Self {
            keep: 1.0 - lost,
            kick: sigma_m_s * sqrt(lost * (2.0 - lost)),
            reach: memory_s * tanh,
            scatter: sigma_m_s * memory_s * sqrt(2.0 * bend),
        }
    }

    fn apply<const K: usize>(&self, component: &mut Component<K>) {
        let pace = component.pace();
        let (kick, scatter) = (pace * self.kick, pace * self.scatter);
        let square = kick * kick;
        component.travel(self.reach * (1.0 + self.keep), self.keep);
        component.disturb(
            self.reach * self.reach * square + scatter * scatter,
            self.reach * square,
            square,
        );
    }
}

/// An event that happens within some time with a probability.
#[derive(Clone, Copy)]
struct Event {
    mean_s: f32,
    probability: f32,
    /// The probability by which it is drawn.
    drawn: f32,
}

impl Event {
    fn new(seconds: f32, mean_s: f32) -> Self {
        let probability = one_minus_exp(seconds / mean_s);
        Self {
            mean_s,
            probability,
            drawn: probability,
        }
    }

    /// When it happened, given that it did.
    fn after<R: Rng + ?Sized>(&self, rng: &mut R) -> f32 {
        -self.mean_s * ln(1.0 - self.probability * uniform(rng))
    }
}

/// What a source does.
#[derive(Clone, Copy)]
pub(super) enum What {
    Rest,
    Departure,
    Straight,
    Turn,
    Stop,
}

/// How many things a source may do.
pub(super) const COURSES: usize = 3;

/// What a source may do.
pub(super) struct Course {
    pub(super) what: What,
    pub(super) probability: f32,
    /// The probability by which it is drawn.
    pub(super) drawn: f32,
}

/// What may happen to a source in a certain time.
pub(super) struct Drive {
    pub(super) seconds: f32,
    /// Of either component of the velocity of the fastest source.
    sigma_m_s: f32,
    /// How fast the slowest is, as a fraction of that.
    slowest: f32,
    straight: Leg,
    turn: Event,
    stop: Event,
    departure: Event,
}

impl Drive {
    pub(super) fn new<C>(habits: &Config<C>, seconds: f32) -> Self {
        let sigma_m_s = core::f32::consts::FRAC_1_SQRT_2 * habits.speed_m_s;
        Self {
            seconds,
            sigma_m_s,
            slowest: habits.slowest_m_s / habits.speed_m_s,
            straight: Leg::new(seconds, STRAIGHTNESS * habits.straight_s, sigma_m_s),
            turn: Event::new(seconds, habits.straight_s),
            stop: Event::new(seconds, habits.moving_s),
            departure: Event::new(seconds, habits.stationary_s),
        }
    }

    /// The probability that a stationary source has departed.
    pub(super) fn departed(&self) -> f32 {
        self.departure.probability
    }

    /// The departure of a stationary one.
    fn departure_of<const K: usize>(&self, component: &Component<K>) -> Event {
        let pause_s = PAUSE_S + component.stationary_s;
        if K == 0 {
            return self.departure;
        }
        let mut event = if pause_s < self.departure.mean_s {
            Event::new(self.seconds, pause_s)
        } else {
            self.departure
        };
        let drawn = one_minus_exp(self.seconds / DRAWN_EVERY_S);
        if event.drawn < drawn {
            event.drawn = drawn;
        }
        event
    }

    /// Gives it any velocity: drawn for the most part, because what has any velocity is soon anywhere, where a bearing is
    /// no linear measurement. Whether it is a slow one is drawn, too.
    ///
    /// Among stations, which see it from all sides and many times a second, nothing but that is drawn.
    pub(super) fn accelerate<const K: usize, R: Rng + ?Sized>(
        &self,
        component: &mut Component<K>,
        rng: &mut R,
    ) {
        let pace = if !component.is_stationary() {
            component.pace()
        } else if uniform(rng) < SLOW {
            self.slowest
        } else {
            1.0
        };
        let sigma_m_s = pace * self.sigma_m_s;
        if K > 0 {
            component.set_velocity([0.0; 2], sigma_m_s * sigma_m_s);
        } else {
            let drawn = sigma_m_s * sqrt(DRAWN);
            let velocity = [drawn * normal(rng), drawn * normal(rng)];
            let variance = (1.0 - DRAWN) * sigma_m_s * sigma_m_s;
            component.set_velocity(velocity, variance);
        }
        component.stationary_s = -pace;
    }

    /// Moves one that was stationary and has departed since.
    pub(super) fn depart<const K: usize, R: Rng + ?Sized>(
        &self,
        component: &mut Component<K>,
        rng: &mut R,
    ) {
        let departure = self.departure_of(component);
        self.accelerate(component, rng);
        let left = self.seconds - departure.after(rng);
        let way = -self.stop.mean_s * ln(uniform_open(rng));
        if way < left {
            component.travel(way, 1.0);
            component.stop(left - way);
        } else {
            component.travel(left, 1.0);
        }
    }

    /// Goes on for half of the time, the former or the latter of a turn. Stations see whether it was a little more or less: among
    /// them, the turn is evenly distributed over the time.
    fn travel_about_half<const K: usize>(&self, component: &mut Component<K>) {
        component.travel(0.5 * self.seconds, 1.0);
        if K > 0 {
            component.blur(self.seconds * self.seconds * (1.0 / 12.0));
        }
    }

    /// All that a component may do while the time passes.
    pub(super) fn courses<const K: usize>(&self, component: &Component<K>) -> [Course; COURSES] {
        let course = |what, probability, drawn| Course {
            what,
            probability,
            drawn,
        };
        if component.is_stationary() {
            let Event {
                probability, drawn, ..
            } = self.departure_of(component);
            [
                course(What::Departure, probability, drawn),
                course(What::Turn, 0.0, 0.0),
                course(What::Rest, 1.0 - probability, 1.0 - drawn),
            ]
        } else {
            let stop = self.stop.probability;
            let turn = (1.0 - stop) * self.turn.probability;
            let straight = 1.0 - stop - turn;
            [
                course(What::Stop, stop, stop),
                course(What::Turn, turn, turn),
                course(What::Straight, straight, straight),
            ]
        }
    }

    /// Lets the time pass. What happens meanwhile is decided by a number that is evenly distributed from 0 to 1.
    pub(super) fn step<const K: usize, R: Rng + ?Sized>(
        &self,
        component: &mut Component<K>,
        chance: f32,
        rng: &mut R,
    ) {
        let [first, second, third] = self.courses(component);
        let course = if chance < first.drawn {
            first
        } else if chance < first.drawn + second.drawn {
            second
        } else {
            third
        };
        self.follow(component, course.what, rng);
    }

    /// Lets the time pass while that happens.
    pub(super) fn follow<const K: usize, R: Rng + ?Sized>(
        &self,
        component: &mut Component<K>,
        what: What,
        rng: &mut R,
    ) {
        match what {
            What::Rest => component.stationary_s += self.seconds,
            What::Departure => self.depart(component, rng),
            What::Straight => self.straight.apply(component),
            What::Turn => {
                self.travel_about_half(component);
                self.accelerate(component, rng);
                self.travel_about_half(component);
            }
            What::Stop => {
                let way = self.stop.after(rng);
                component.travel(way, 1.0);
                let left = self.seconds - way;
                component.stop(larger(left, 0.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::clean;
    use crate::estimate::Symmetric2;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    /// Who goes east and turns at any moment of the time, with another velocity for what is left of it: the mean square of either
    /// part is a third of the square of the time, and its variance a twelfth.
    #[test]
    fn who_turns_is_where_a_turn_at_any_moment_leads() {
        const SECONDS: f32 = 2.0;
        const SPEED: f32 = 3.0;
        let drive = Drive::new(&Config::new(clean::Config::DEFAULT), SECONDS);
        let mut component = Component::<1>::stationary([1.0, 2.0], Symmetric2::isotropic(0.5));
        component.stationary_s = -1.0;
        component.velocity = [SPEED, 0.0];
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        drive.follow(&mut component, What::Turn, &mut rng);
        let close = |a: f32, b: f32| assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
        let square = drive.sigma_m_s * drive.sigma_m_s;
        let north = 0.5 + square * SECONDS * SECONDS / 3.0;
        assert_eq!(component.position, [1.0 + 0.5 * SECONDS * SPEED, 2.0]);
        close(component.position_covariance.yy, north);
        let east = north + SPEED * SPEED * SECONDS * SECONDS / 12.0;
        close(component.position_covariance.xx, east);
        close(component.cross_covariance[0][0], 0.5 * SECONDS * square);
        close(component.velocity_covariance.xx, square);
    }

    /// What is drawn of a velocity and what is left to the filter make the whole variance.
    #[test]
    fn a_new_velocity_has_the_variance_of_its_pace() {
        const RUNS: usize = 4_000;
        let drive = Drive::new(&Config::new(clean::Config::DEFAULT), 1.0);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(8);
        let mut at_rest = Component::<1>::stationary([0.0; 2], Symmetric2::ZERO);
        drive.accelerate(&mut at_rest, &mut rng);
        let sigma = at_rest.pace() * drive.sigma_m_s;
        assert_eq!(at_rest.velocity, [0.0; 2]);
        assert_eq!(
            at_rest.velocity_covariance,
            Symmetric2::isotropic(sigma * sigma)
        );
        assert!(!at_rest.is_stationary());

        let mut drawn = 0.0;
        for _ in 0..RUNS {
            let mut moving = Component::<0>::stationary([0.0; 2], Symmetric2::ZERO);
            moving.stationary_s = -0.5;
            drive.accelerate(&mut moving, &mut rng);
            assert_eq!(moving.pace(), 0.5);
            let [u, v] = moving.velocity;
            drawn += (u * u + v * v) / (2 * RUNS) as f32;
            let left = 0.05 * drive.sigma_m_s * drive.sigma_m_s;
            assert!((moving.velocity_covariance.xx / left - 1.0).abs() < 1e-4);
        }
        // Of 8,000 squares of normal numbers, five standard deviations of the mean are 0.08: once in a million seeds.
        let whole = 0.2 * drive.sigma_m_s * drive.sigma_m_s;
        assert!((drawn / whole - 1.0).abs() < 0.08, "{drawn} {whole}");
    }
}
