//! The classical estimates: where two bearings meet, and the position that explains all of them best.

use super::Observation;
use crate::estimate::Symmetric2;
use crate::math::{atan2, sin_cos, wrap};
use crate::random::{Rng, uniform};

/// Where the rays of two observations intersect, or `None` when they are nearly parallel (the sine of their angle below
/// `least_sine`) or meet behind a receiver.
///
/// By cross products: unlike the quotient of tangents of Du et al. (2016), eq. 22 and 23, it has no singular direction.
pub fn intersection(a: &Observation, b: &Observation, least_sine: f32) -> Option<[f32; 2]> {
    let crossing = crossing(a, b, least_sine)?;
    crossing.is_ahead.then_some(crossing.position)
}

/// Where the lines of two bearings meet.
pub(super) struct Crossing {
    pub(super) position: [f32; 2],
    /// Whether that is in front of both receivers.
    pub(super) is_ahead: bool,
}

fn crossing(a: &Observation, b: &Observation, least_sine: f32) -> Option<Crossing> {
    let (sin_a, cos_a) = sin_cos(a.bearing().radians());
    let (sin_b, cos_b) = sin_cos(b.bearing().radians());
    let cross = cos_a * sin_b - sin_a * cos_b;
    if cross.abs() < least_sine.max(1e-6) {
        return None;
    }
    let ([ax, ay], [bx, by]) = (a.position(), b.position());
    let (dx, dy) = (bx - ax, by - ay);
    // Metres from the receivers, negative behind them.
    let along_a = (dx * sin_b - dy * cos_b) / cross;
    let along_b = (dx * sin_a - dy * cos_a) / cross;
    Some(Crossing {
        position: [ax + along_a * cos_a, ay + along_a * sin_a],
        is_ahead: along_a > 0.0 && along_b > 0.0,
    })
}

/// Where a random pair of bearings crosses that `fits`: a draw from a cloud that holds the source, to start a filter from
/// (Du et al. 2016, eq. 22 and 23, which pairs bearings a fixed gap apart).
///
/// Up to `tries` pairs are drawn until their lines meet at an angle whose sine is at least `least_sine`.
pub(super) fn random_crossing<T: AsRef<Observation>, R: Rng + ?Sized>(
    bearings: &[T],
    least_sine: f32,
    tries: u32,
    rng: &mut R,
    fits: impl Fn(&T, &T, &Crossing) -> bool,
) -> Option<[f32; 2]> {
    let n = bearings.len() as f32;
    (0..tries).find_map(|_| {
        let a = bearings.get((uniform(rng) * n) as usize);
        let b = bearings.get((uniform(rng) * n) as usize);
        let (a, b) = a.zip(b)?;
        let crossing = crossing(a.as_ref(), b.as_ref(), least_sine)?;
        fits(a, b, &crossing).then_some(crossing.position)
    })
}

/// What one bearing says about a position: its error there, and the derivative of its direction.
pub(super) struct Linearised {
    /// Measured less expected direction, in radians.
    pub(super) residual: f32,
    /// Derivative of the expected direction, in radians a metre.
    gradient: [f32; 2],
    /// 1 / sigma^2
    pub(super) information: f32,
}

/// Closer to a receiver than this many metres, the direction of a source turns with every step.
const NEAREST_M: f32 = 1e-3;

// Once in flash: it holds an arc tangent, and its callers are many.
#[inline(never)]
pub(super) fn linearise(observation: &Observation, [x, y]: [f32; 2]) -> Linearised {
    let [px, py] = observation.position();
    let (dx, dy) = (x - px, y - py);
    let square = dx * dx + dy * dy + NEAREST_M * NEAREST_M;
    Linearised {
        residual: wrap(observation.bearing().radians() - atan2(dy, dx)),
        gradient: [-dy / square, dx / square],
        information: observation.information(),
    }
}

/// Sums over all bearings at one position.
#[derive(Default)]
struct Normal {
    matrix: Symmetric2,
    gradient: [f32; 2],
    /// What is minimised.
    cost: f32,
}

impl Normal {
    fn at(bearings: &[impl AsRef<Observation>], position: [f32; 2]) -> Self {
        let mut sums = Self::default();
        for observation in bearings.iter().map(AsRef::as_ref) {
            let Linearised {
                residual,
                gradient: [gx, gy],
                information,
            } = linearise(observation, position);
            sums.matrix = sums.matrix.plus_outer(information, [gx, gy]);
            sums.gradient[0] += information * gx * residual;
            sums.gradient[1] += information * gy * residual;
            sums.cost += information * (0.5 * residual * residual);
        }
        sums
    }
}

/// Steps after which a search is given up.
const MAX_STEPS: u32 = 40;

/// A search ends with a step of less than a thousandth of a standard deviation, here squared ...
const SETTLED: f32 = 1e-6;

/// ... or when what a step would gain is lost in the rounding of the cost, of which this is a fraction.
const ROUNDING: f32 = 1e-5;

/// The position that explains all bearings best, in metres east and north, and its covariance in square metres: by
/// Gauss-Newton steps from `start`.
///
/// For one clean source that does not move this is as good as anything can be: the yardstick for every filter here. It knows
/// nothing of a second mode, and its covariance, the inverse of the information in the bearings, is that of a normal
/// distribution. `None` of fewer than two bearings, and where they are parallel or do not meet.
pub fn gauss_newton(
    bearings: &[impl AsRef<Observation>],
    start: [f32; 2],
) -> Option<([f32; 2], Symmetric2)> {
    if bearings.len() < 2 {
        return None;
    }
    let mut position = start;
    let mut here = Normal::at(bearings, position);
    // Levenberg's damping: a fraction of the diagonal, which shortens a step that made things worse.
    let mut damping = 0.0;
    for _ in 0..MAX_STEPS {
        let damped = Symmetric2 {
            xx: here.matrix.xx * (1.0 + damping),
            yy: here.matrix.yy * (1.0 + damping),
            ..here.matrix
        };
        let [dx, dy] = damped.inverse()?.times(here.gradient);
        // The square of the undamped step in standard deviations.
        let decrement = (dx * here.gradient[0] + dy * here.gradient[1]) * (1.0 + damping);
        let next = [position[0] + dx, position[1] + dy];
        let there = Normal::at(bearings, next);
        let better = there.cost <= here.cost;
        if better {
            (position, here) = (next, there);
            damping *= 0.1;
        } else {
            damping = if damping > 0.0 { damping * 10.0 } else { 1e-3 };
        }
        if decrement < SETTLED || (!better && decrement < ROUNDING * here.cost) {
            return Some((position, here.matrix.inverse()?));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    fn towards(position: [f32; 2], target: [f32; 2]) -> Observation {
        let angle = (target[1] - position[1]).atan2(target[0] - position[0]);
        Observation::new(0, position, Bearing::from_radians(angle), 0.02).unwrap()
    }

    fn is_at([x, y]: [f32; 2], [sx, sy]: [f32; 2]) -> bool {
        (x - sx).abs() < 0.01 && (y - sy).abs() < 0.01
    }

    #[test]
    fn rays_intersect_at_the_source_in_every_quadrant() {
        for source in [
            [300.0, 400.0],
            [-300.0, 400.0],
            [-300.0, -400.0],
            [300.0, -400.0],
            [0.0, 500.0],
        ] {
            let a = towards([10.0, -20.0], source);
            let b = towards([-80.0, 30.0], source);
            let found = intersection(&a, &b, 0.02).unwrap();
            assert!(is_at(found, source), "{found:?}");
        }
    }

    #[test]
    fn parallel_and_diverging_rays_do_not_intersect() {
        let a = towards([0.0, 0.0], [0.0, 100.0]);
        let b = towards([10.0, 0.0], [10.5, 100.0]);
        assert_eq!(intersection(&a, &b, 0.02), None);
        // They would meet south of both.
        let b = towards([10.0, 0.0], [60.0, 100.0]);
        assert_eq!(intersection(&a, &b, 0.02), None);
    }

    #[test]
    fn both_receivers_must_face_the_place_where_rays_meet() {
        let taken = |position, degrees: f32| {
            let bearing = Bearing::from_radians(degrees.to_radians());
            Observation::new(0, position, bearing, 0.02).unwrap()
        };
        let (east, north) = (taken([0.0; 2], 0.0), taken([0.0; 2], 90.0));
        // To the north-west of (10, 100) is (0, 110).
        let towards = taken([10.0, 100.0], 135.0);
        let found = intersection(&north, &towards, 0.02).unwrap();
        assert!(is_at(found, [0.0, 110.0]), "{found:?}");
        assert!(is_at(
            intersection(&towards, &north, 0.02).unwrap(),
            [0.0, 110.0]
        ));
        // The lines meet ahead of the one and behind the other.
        let away = taken([100.0, 50.0], 60.0);
        assert_eq!(intersection(&east, &away, 0.02), None);
        assert_eq!(intersection(&away, &east, 0.02), None);
    }

    #[test]
    fn a_direction_turns_by_no_more_than_500_radians_a_metre() {
        let at_origin = towards([0.0; 2], [1.0, 0.0]);
        let gradient = |x| linearise(&at_origin, [x, 0.0]).gradient;
        assert_eq!(gradient(0.0)[1], 0.0);
        assert!((gradient(1e-3)[1] - 500.0).abs() < 0.1);
        assert!((gradient(10.0)[1] - 0.1).abs() < 1e-6);
    }

    #[test]
    fn random_crossings_are_at_the_source() {
        let all: [Observation; 5] =
            core::array::from_fn(|i| towards([100.0 * i as f32, 0.0], [250.0, 200.0]));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(31);
        let mut crossing =
            |all: &[Observation]| random_crossing(all, 0.02, 32, &mut rng, |_, _, c| c.is_ahead);
        for _ in 0..100 {
            assert!(is_at(crossing(&all).unwrap(), [250.0, 200.0]));
        }
        assert_eq!(crossing(&all[..1]), None);
        assert_eq!(crossing(&all[..0]), None);
    }

    #[test]
    fn exact_bearings_give_the_source_from_a_poor_start() {
        let source = [1200.0, 800.0];
        let bearings: [Observation; 6] =
            core::array::from_fn(|i| towards([300.0 * i as f32, 0.0], source));
        for start in [[400.0, 300.0], [1500.0, 1500.0], [1100.0, 900.0]] {
            let (position, _) = gauss_newton(&bearings, start).unwrap();
            assert!(is_at(position, source), "{start:?} {position:?}");
        }
    }

    #[test]
    fn the_covariance_is_the_cramer_rao_bound() {
        // Two bearings that cross at a right angle, 1 km away: 20 m in either direction.
        let bearings = [
            towards([-1000.0, 0.0], [0.0, 0.0]),
            towards([0.0, -1000.0], [0.0, 0.0]),
        ];
        let (_, Symmetric2 { xx, xy, yy }) = gauss_newton(&bearings, [50.0, 50.0]).unwrap();
        assert!((xx - 400.0).abs() < 0.1 && (yy - 400.0).abs() < 0.1 && xy.abs() < 0.1);
    }

    #[test]
    fn too_few_parallel_and_diverging_bearings_have_no_solution() {
        let one = [towards([0.0, 0.0], [0.0, 500.0])];
        let diverging = [
            towards([-10.0, 0.0], [-20.0, 100.0]),
            towards([10.0, 0.0], [20.0, 100.0]),
        ];
        assert_eq!(gauss_newton(&one, [10.0, 400.0]), None);
        assert_eq!(gauss_newton(&[one[0]; 5], [10.0, 400.0]), None);
        assert_eq!(gauss_newton(&diverging, [0.0, 50.0]), None);
    }
}
