//! What may happen to each of the components, side by side: among stations, where a component that goes straight on draws
//! nothing, copies would stay copies for ever.

use super::drive::{COURSES, Drive};
use super::moved::{Moved, rearrange};
use crate::math::ln;
use crate::random::{Rng, uniform};

/// What stands for no branch: one more than any has.
const NONE: u32 = u32::MAX;

/// Passes over the branches until it is known which are kept for sure: fewer leave room, more take time.
const PASSES: u32 = 4;

impl<const K: usize, const N: usize> Moved<K, N> {
    /// Lets time pass: all that each component may do makes a branch, and of all branches as many are kept as there is room for.
    ///
    /// The heaviest are kept as they are; of the others some are drawn, each of which counts for the least that is kept for sure:
    /// the selection of least variance (Fearnhead and Clifford 2003).
    pub(super) fn branch<R: Rng + ?Sized>(&mut self, drive: &Drive, rng: &mut R) {
        let components = &mut self.components;
        let (codes, weights) = self.weights.columns_mut();
        let scores = || {
            let branches = components.iter().zip(&*weights);
            branches.flat_map(|(component, weight)| {
                (drive.courses(component)).map(|course| weight * course.drawn)
            })
        };
        let least = least_kept(scores, N);
        let mut due = uniform(rng);
        let chosen = (0..).zip(scores()).filter_map(|(code, score)| {
            if score <= 0.0 {
                return None;
            }
            if score < least {
                due += score / least;
                if due < 1.0 {
                    return None;
                }
                due -= 1.0;
            }
            Some(code)
        });
        for (place, code) in codes.iter_mut().zip(chosen.chain(core::iter::repeat(NONE))) {
            *place = f32::from_bits(code);
        }
        let parent = |code: &f32| code.to_bits() as usize / COURSES;
        rearrange(components, codes.iter().map(parent));
        for (component, log_weight) in components.iter_mut().zip(codes) {
            let code = log_weight.to_bits() as usize;
            let weight = weights.get(code / COURSES).copied();
            let course = drive.courses(component).into_iter().nth(code % COURSES);
            *log_weight = f32::NEG_INFINITY;
            if let (Some(weight), Some(course)) = (weight, course) {
                let score = weight * course.drawn;
                let grown = if score < least { least / score } else { 1.0 };
                *log_weight = ln(weight * course.probability * grown);
                drive.follow(component, course.what, rng);
            }
        }
        let _ = self.weights.normalise();
    }
}

/// The score from which on all are kept, if all others together leave `room` for so many in proportion to their scores: never
/// too low, and a little too high if there are still more to find after a few passes. Zero if there is room for all.
fn least_kept<I: Iterator<Item = f32>>(scores: impl Fn() -> I, room: usize) -> f32 {
    let mut least = f32::INFINITY;
    for _ in 0..PASSES {
        let (mut sure, mut rest) = (0, 0.0);
        for score in scores() {
            if score >= least {
                sure += 1;
            } else {
                rest += score;
            }
        }
        if rest <= 0.0 {
            return 0.0;
        }
        if sure >= room {
            break;
        }
        least = rest / (room - sure) as f32;
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::clean;
    use crate::aoa::manoeuvring::Config;
    use crate::aoa::manoeuvring::component::Component;
    use crate::estimate::Symmetric2;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    fn least(scores: &[f32], room: usize) -> f32 {
        least_kept(|| scores.iter().copied(), room)
    }

    #[test]
    fn there_is_room_for_what_is_kept() {
        let scores = [0.5, 0.2, 0.1, 0.1, 0.06, 0.03, 0.01];
        for room in 1..scores.len() {
            let least = least(&scores, room);
            let kept: f32 = scores.iter().map(|score| (score / least).min(1.0)).sum();
            assert!((kept - room as f32).abs() < 1e-5, "{room} {least} {kept}");
        }
        assert_eq!(least(&[0.5, 0.5, 0.0], 2), 0.0);
        assert_eq!(least(&[0.0, 0.0], 1), 0.0);
    }

    /// Heavy components keep their weights, and light ones have theirs in the mean, whatever is drawn more often than it happens.
    #[test]
    fn branches_have_the_weights_of_what_may_happen() {
        const RUNS: usize = 4_000;
        const SECONDS: f32 = 2.0;
        const MEAN_S: f32 = 10.0;
        let config = Config {
            stationary_s: MEAN_S,
            ..Config::new(clean::Config::DEFAULT)
        };
        let drive = Drive::new(&config, SECONDS);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
        let mut sums = [0.0; 4];
        for _ in 0..RUNS {
            let mut places = 0.0;
            let mut cloud = Moved::<1, 4>::EMPTY;
            cloud.insert(1.0, 4.0, &mut rng, |_| {
                places += 1.0;
                // Long at rest: departures have their mean time.
                let mut component = Component::stationary([places, 0.0], Symmetric2::ZERO);
                component.stationary_s = 100.0;
                component
            });
            cloud.branch(&drive, &mut rng);
            for (component, weight) in cloud.iter() {
                if component.is_stationary() && component.stationary_s > 100.0 {
                    assert_eq!(component.stationary_s, 100.0 + SECONDS);
                    sums[component.position[0] as usize - 1] += weight / RUNS as f32;
                }
            }
        }
        // Of 4,000 runs: five standard errors are less than 0.01.
        let stayed = 0.25 * (-SECONDS / MEAN_S).exp();
        for sum in sums {
            assert!((sum - stayed).abs() < 0.01, "{sums:?} {stayed}");
        }
    }
}
