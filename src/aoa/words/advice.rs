//! Where to drive, so that the next bearings tell most.

use heapless::Vec;

use super::answer::{Cloud, Hypothesis};
use super::observation::{Bearing, Observation};
use crate::estimate::Ellipse;
use crate::math::{ln, sin_cos, sqrt};

/// Advice to the driver.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Advice {
    /// The direction of travel from which bearings are expected to tell most; one of [`DIRECTIONS`].
    pub direction: Bearing,
    /// Expected information of a bearing from there, in nats: half the logarithm of the ratio of the predicted variance of
    /// that bearing to the variance of its error. Below about 0.1 the next bearing says little that is new.
    pub information: f32,
    /// Distance to drive in that direction until the bearings cross, as likely as not, at the angle that a fix needs, in
    /// metres: infinity beyond [`FARTHEST_M`]. Zero with a fix.
    pub distance_m: f32,
}

/// Directions of travel that are compared: the points of a compass.
pub const DIRECTIONS: u8 = 16;

/// Largest `distance_m` that is advised, in metres.
pub const FARTHEST_M: f32 = 25_600.0;

/// Distance at which directions are compared, as a fraction of the distance to the source: less sees only what is near by,
/// more what is beyond the next bearings.
const REACH: f32 = 0.15;

/// Minimum gain, in nats, to prefer another direction: less turns the driver back at every bearing, since left and right of
/// a ray are equally good; more overlooks better ones.
const TIE: f32 = 0.05;

/// The most places of a [`Belief`]: more resolve hypotheses better, for time and 12 bytes of stack each.
const PLACES: usize = 32;

/// Places where the source may be, as likely as their weights say.
///
/// A bearing tells most from where it is hardest to foretell (maximum entropy sampling: Shewry and Wynn 1987): from
/// where these places are seen in directions as different as can be. That weighs hypotheses against each other just as
/// ranges along a ray.
#[derive(Debug, Clone, Default)]
pub(in crate::aoa) struct Belief {
    /// Positions and weights.
    places: Vec<([f32; 2], f32), PLACES>,
}

impl Belief {
    /// The belief of particles: at most `PLACES` of them, at equal distances in the columns.
    pub(in crate::aoa) fn of_particles(cloud: Cloud<'_>) -> Self {
        let mut belief = Self::default();
        let step = cloud.weights.len().div_ceil(PLACES).max(1);
        let particles = cloud.east.iter().zip(cloud.north).zip(cloud.weights);
        for ((x, y), weight) in particles.step_by(step) {
            belief.add([*x, *y], *weight);
        }
        belief
    }

    /// Of hypotheses, as seen from where the `latest` bearing was taken: five places along the longer axis of each; of one
    /// that is so long that it says no more than a direction, along the ray to it. Of that bearing, if there are none.
    pub(in crate::aoa) fn of_hypotheses(
        hypotheses: impl Iterator<Item = Hypothesis>,
        latest: &Observation,
        range_m: f32,
    ) -> Self {
        /// Places in standard deviations, and their weights in a normal distribution.
        const SHAPE: [(f32, f32); 5] = [
            (-1.5, 0.123),
            (-0.75, 0.237),
            (0.0, 0.28),
            (0.75, 0.237),
            (1.5, 0.123),
        ];
        /// Of the distance, the longest semi-axis of what is more than a ray.
        const LONG: f32 = 0.5;
        let from = latest.position();
        let mut belief = Self::default();
        for hypothesis in hypotheses {
            let ellipse = Ellipse::of_sigmas(hypothesis.position, hypothesis.covariance, 1.0);
            let (towards, distance) = sight(from, hypothesis.position);
            if ellipse.semi_major < LONG * distance {
                let (sin, cos) = sin_cos(ellipse.orientation);
                for (z, weight) in SHAPE {
                    let along = z * ellipse.semi_major;
                    let place = offset(hypothesis.position, [cos, sin], along);
                    belief.add(place, hypothesis.probability * weight);
                }
            } else {
                belief.add_ray(from, towards, 4.0 * distance, hypothesis.probability);
            }
        }
        if belief.places.is_empty() {
            return Self::of_ray(latest, range_m);
        }
        belief
    }

    /// Of a single bearing: somewhere along its ray, up to half of the range.
    pub(in crate::aoa) fn of_ray(observation: &Observation, range_m: f32) -> Self {
        let mut belief = Self::default();
        let (sin, cos) = sin_cos(observation.bearing().radians());
        belief.add_ray(observation.position(), [cos, sin], 0.5 * range_m, 1.0);
        belief
    }

    /// Five places, each twice as far as the next.
    fn add_ray(&mut self, from: [f32; 2], direction: [f32; 2], farthest: f32, mass: f32) {
        let mut r = farthest;
        for _ in 0..5 {
            self.add(offset(from, direction, r), 0.2 * mass);
            r *= 0.5;
        }
    }

    fn add(&mut self, position: [f32; 2], weight: f32) {
        let _ = self.places.push((position, weight));
    }

    /// What is best for a vehicle that is where the `latest` bearing was taken and whose bearings still have to turn by
    /// the angle `missing`, in radians. `None` of no belief.
    #[inline(never)]
    pub(in crate::aoa) fn advice(&self, latest: &Observation, missing: f32) -> Option<Advice> {
        let (from, sigma) = (latest.position(), latest.sigma_rad());
        let reach = REACH * self.distance(from)?;
        let mut best: Option<([f32; 2], Advice)> = None;
        for k in 0..DIRECTIONS {
            let radians = core::f32::consts::TAU / f32::from(DIRECTIONS) * f32::from(k);
            let (sin, cos) = sin_cos(radians);
            let spread = self.spread(offset(from, [cos, sin], reach));
            let information = 0.5 * ln(1.0 + spread / (sigma * sigma));
            if best.is_none_or(|(_, best)| information > best.information + TIE) {
                let advice = Advice {
                    direction: Bearing::from_radians(radians),
                    information,
                    distance_m: 0.0,
                };
                best = Some(([cos, sin], advice));
            }
        }
        let (direction, mut advice) = best?;
        if missing > 0.0 {
            advice.distance_m = self.way(from, direction, missing);
        }
        Some(advice)
    }

    /// Harmonic mean of the distances of the places, in metres.
    fn distance(&self, from: [f32; 2]) -> Option<f32> {
        let (mut sum, mut total) = (0.0, 0.0);
        for (place, weight) in &self.places {
            sum += weight / sight(from, *place).1;
            total += weight;
        }
        let distance = total / sum;
        distance.is_finite().then_some(distance)
    }

    /// Mean square of how far the directions of the places, as seen from `from`, are from their mean: of chords of the
    /// unit circle, which are angles where these are small.
    fn spread(&self, from: [f32; 2]) -> f32 {
        let (mut mean, mut total) = ([0.0; 2], 0.0);
        for (place, weight) in &self.places {
            let ([x, y], _) = sight(from, *place);
            mean = [mean[0] + weight * x, mean[1] + weight * y];
            total += weight;
        }
        let mean = mean.map(|sum| sum / total);
        let mut squares = 0.0;
        for (place, weight) in &self.places {
            squares += weight * square_of_chord(sight(from, *place).0, mean);
        }
        squares / total
    }

    /// The way in a direction until the directions of half of the places, by weight, have turned by `missing`; to a
    /// fifth.
    fn way(&self, from: [f32; 2], direction: [f32; 2], missing: f32) -> f32 {
        let mut way = 25.0;
        while way <= FARTHEST_M {
            let to = offset(from, direction, way);
            let mut balance = 0.0;
            for (place, weight) in &self.places {
                let turn = square_of_chord(sight(from, *place).0, sight(to, *place).0);
                balance += if turn >= missing * missing {
                    *weight
                } else {
                    -weight
                };
            }
            if balance >= 0.0 {
                return way;
            }
            way *= 1.2;
        }
        f32::INFINITY
    }
}

fn offset(from: [f32; 2], direction: [f32; 2], way: f32) -> [f32; 2] {
    [from[0] + way * direction[0], from[1] + way * direction[1]]
}

fn square_of_chord([ax, ay]: [f32; 2], [bx, by]: [f32; 2]) -> f32 {
    (ax - bx) * (ax - bx) + (ay - by) * (ay - by)
}

/// Unit vector to a place, and its distance, not nearer than a metre.
fn sight(from: [f32; 2], to: [f32; 2]) -> ([f32; 2], f32) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let r = sqrt(dx * dx + dy * dy + 1.0);
    ([dx / r, dy / r], r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::testing::Clocked;
    use crate::aoa::{Answer, Clean, Robust, clean, robust};
    use crate::estimate::Symmetric2;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

    const SOURCE: [f32; 2] = [1_000.0, 2_000.0];

    /// Takes a bearing from a place.
    fn look(from: [f32; 2], rng: &mut Xoshiro128PlusPlus) -> Observation {
        let angle = (SOURCE[1] - from[1]).atan2(SOURCE[0] - from[0]) + 0.03 * normal(rng);
        Observation::new(0, from, Bearing::from_radians(angle), 0.03).unwrap()
    }

    /// Whether there is a fix within 40 bearings, 30 m from one to the next. `steer` chooses the direction of travel from
    /// that of the advice.
    fn arrives(
        seed: u64,
        mut push: impl FnMut(Observation, &mut Xoshiro128PlusPlus) -> (Answer, Option<Advice>),
        steer: impl Fn(f32) -> f32,
    ) -> bool {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let mut place = [0.0; 2];
        (0..40).any(|_| {
            let observation = look(place, &mut rng);
            let (answer, advice) = push(observation, &mut rng);
            let (sin, cos) = steer(advice.unwrap().direction.radians()).sin_cos();
            place = offset(place, [cos, sin], 30.0);
            matches!(answer, Answer::Fix(_))
        })
    }

    /// A belief weighs hypotheses against each other by their probabilities, whatever their shapes.
    #[test]
    fn a_hypothesis_weighs_what_it_is_probable() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
        let latest = look([0.0; 2], &mut rng);
        let one = |sigma: f32, probability| Hypothesis {
            position: SOURCE,
            covariance: Symmetric2 {
                xx: sigma * sigma,
                xy: 0.0,
                yy: 100.0,
            },
            probability,
        };
        let both = [one(50.0, 0.3), one(5_000.0, 0.7)];
        let belief = Belief::of_hypotheses(both.into_iter(), &latest, 1e4);
        let weigh = |places: &[([f32; 2], f32)]| places.iter().map(|(_, weight)| weight).sum();
        let (ellipse, ray) = belief.places.split_at(5);
        let weights: [f32; 2] = [weigh(ellipse), weigh(ray)];
        assert!((weights[0] - 0.3).abs() < 0.01, "{weights:?}");
        assert!((weights[1] - 0.7).abs() < 0.01, "{weights:?}");
        // The ray leads through the hypothesis and beyond.
        let farthest = offset([0.0; 2], sight([0.0; 2], SOURCE).0, 4.0 * 2_236.068);
        let [x, y] = ray[0].0;
        assert!((x - farthest[0]).abs() < 1.0 && (y - farthest[1]).abs() < 1.0);
    }

    #[test]
    fn who_drives_as_advised_gets_a_fix() {
        let (mut plain, mut robust, mut astray) = (0, 0, 0);
        for seed in 0..40 {
            let mut locator = Clocked::<Clean<100>>::new(clean::Config::DEFAULT);
            plain += u32::from(arrives(
                seed,
                |o, rng| (locator.push(o, rng), locator.advice()),
                |radians| radians,
            ));
            let mut locator = Clocked::<Robust<128, 32>>::new(robust::Config::DEFAULT);
            robust += u32::from(arrives(
                seed,
                |o, rng| (locator.push(o, rng), locator.advice()),
                |radians| radians,
            ));
            // Towards where the bearings point instead.
            let mut locator = Clocked::<Robust<128, 32>>::new(robust::Config::DEFAULT);
            astray += u32::from(arrives(
                seed,
                |o, rng| (locator.push(o, rng), locator.advice()),
                |_| SOURCE[1].atan2(SOURCE[0]),
            ));
        }
        assert!(
            plain >= 36 && robust >= 36 && astray < 10,
            "{plain} {robust} {astray}"
        );
    }

    fn degrees(belief: &Belief, from: [f32; 2], missing: f32) -> (f32, Advice) {
        let latest = Observation::new(0, from, Bearing::from_radians(0.0), 0.02).unwrap();
        let advice = belief.advice(&latest, missing).unwrap();
        (advice.direction.compass_degrees(), advice)
    }

    fn of_particles(east: &[f32], north: &[f32], weights: &[f32]) -> Belief {
        Belief::of_particles(Cloud {
            east,
            north,
            weights,
        })
    }

    /// As seen from the origin.
    fn of_one(hypothesis: Hypothesis) -> Belief {
        let latest = Observation::new(0, [0.0; 2], Bearing::from_radians(0.0), 0.02).unwrap();
        Belief::of_hypotheses([hypothesis].into_iter(), &latest, 20_000.0)
    }

    #[test]
    fn a_ray_is_crossed_by_driving_across_it() {
        let observation =
            Observation::new(0, [100.0, 50.0], Bearing::from_compass_degrees(30.0), 0.02).unwrap();
        let belief = Belief::of_ray(&observation, 20_000.0);
        let (direction, advice) = degrees(&belief, [100.0, 50.0], 0.1);
        let across = (direction - 30.0).rem_euclid(180.0) - 90.0;
        // A little forward, for what is near is seen from farther aside there.
        assert!(across.abs() < 34.0, "{direction}");
        // The nearest of the places that it is thought of at is 625 m away, the farthest 10 km.
        assert!((62.0..1_000.0).contains(&advice.distance_m));
        assert!(advice.information > 1.0);
        let (_, enough) = degrees(&belief, [100.0, 50.0], 0.0);
        assert_eq!(enough.distance_m, 0.0);
    }

    #[test]
    fn the_longer_axis_is_looked_at_from_the_side() {
        // Long from north to south, seen from the south: by its near end, it is left and right that tell.
        let hypothesis = Hypothesis {
            position: [0.0, 1_000.0],
            covariance: Symmetric2 {
                xx: 25.0,
                xy: 0.0,
                yy: 90_000.0,
            },
            probability: 1.0,
        };
        let belief = of_one(hypothesis);
        let (direction, _) = degrees(&belief, [0.0, 0.0], 0.0);
        assert!((direction - 180.0).abs() > 60.0 && direction.min(360.0 - direction) > 60.0);
        // Once round it, there is less to learn than at the start.
        let round = Hypothesis {
            covariance: Symmetric2::isotropic(25.0),
            ..hypothesis
        };
        let round = of_one(round);
        let before = degrees(&belief, [0.0, 0.0], 0.0).1.information;
        let after = degrees(&round, [0.0, 0.0], 0.0).1.information;
        assert!(after < 0.1 * before, "{after} {before}");
    }

    #[test]
    fn the_best_of_all_directions_is_the_best() {
        // Two hypotheses in one line from here: exhaustively, by the spread itself.
        let particles = [[800.0, 2_000.0], [600.0, 1_500.0]];
        let [east, north] = &particles;
        let belief = of_particles(east, north, &[0.5, 0.5]);
        let (direction, _) = degrees(&belief, [0.0, 0.0], 0.0);
        let reach = REACH * belief.distance([0.0; 2]).unwrap();
        let spread = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            belief.spread([reach * sin, reach * cos])
        };
        let best = (0..16).map(|k| spread(22.5 * k as f32));
        let best = best.fold(0.0, f32::max);
        // As good as the best, but for a tie.
        assert!(spread(direction) > 0.9 * best);
    }

    #[test]
    fn there_is_none_without_a_belief() {
        let latest = Observation::new(0, [0.0; 2], Bearing::from_radians(0.0), 0.02).unwrap();
        assert_eq!(Belief::default().advice(&latest, 0.1), None);
        let nowhere = of_particles(&[f32::NAN], &[0.0], &[1.0]);
        assert_eq!(nowhere.advice(&latest, 0.1), None);
    }

    #[test]
    fn what_cannot_turn_is_infinitely_far() {
        let belief = of_particles(&[5e5], &[0.0], &[1.0]);
        assert_eq!(degrees(&belief, [0.0; 2], 0.5).1.distance_m, f32::INFINITY);
    }
}
