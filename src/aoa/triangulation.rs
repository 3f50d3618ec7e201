//! Where two bearings meet.

use super::Observation;
use crate::math::sin_cos;
use crate::random::{Rng, uniform};

/// Where the rays of two observations intersect, or `None` when they are nearly parallel (the sine of their
/// angle below `least_sine`) or meet behind a receiver.
///
/// By cross products: unlike the quotient of tangents of Du et al. (2016), eq. 22 and 23, it has no singular
/// direction.
pub fn intersection(a: &Observation, b: &Observation, least_sine: f32) -> Option<[f32; 2]> {
    let crossing = crossing(a, b, least_sine)?;
    (crossing.along_a > 0.0 && crossing.along_b > 0.0).then_some(crossing.position)
}

/// Where the lines of two bearings meet.
pub(super) struct Crossing {
    pub(super) position: [f32; 2],
    /// Metres from the receivers, negative behind them.
    along_a: f32,
    along_b: f32,
}

pub(super) fn crossing(a: &Observation, b: &Observation, least_sine: f32) -> Option<Crossing> {
    let (sin_a, cos_a) = sin_cos(a.bearing().radians());
    let (sin_b, cos_b) = sin_cos(b.bearing().radians());
    let cross = cos_a * sin_b - sin_a * cos_b;
    if cross.abs() < least_sine.max(1e-6) {
        return None;
    }
    let (dx, dy) = (
        b.position()[0] - a.position()[0],
        b.position()[1] - a.position()[1],
    );
    let along_a = (dx * sin_b - dy * cos_b) / cross;
    let along_b = (dx * sin_a - dy * cos_a) / cross;
    let position = [
        a.position()[0] + along_a * cos_a,
        a.position()[1] + along_a * sin_a,
    ];
    Some(Crossing {
        position,
        along_a,
        along_b,
    })
}

/// The intersection of a random pair of bearings: a draw from a cloud that holds the source, to start a filter
/// from (Du et al. 2016, eq. 22 and 23, which pairs bearings a fixed gap apart).
///
/// Pairs are drawn until their rays meet at an angle whose sine is at least `least_sine`, at most 32 times.
pub fn random_intersection<R: Rng + ?Sized>(
    observations: &[impl AsRef<Observation>],
    least_sine: f32,
    rng: &mut R,
) -> Option<[f32; 2]> {
    const TRIES: u32 = 32;
    let n = observations.len() as f32;
    for _ in 0..TRIES {
        let a = observations.get((uniform(rng) * n) as usize);
        let b = observations.get((uniform(rng) * n) as usize);
        if let Some((a, b)) = a.zip(b)
            && let Some(point) = intersection(a.as_ref(), b.as_ref(), least_sine)
        {
            return Some(point);
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

    #[test]
    fn rays_meet_at_the_source_in_every_quadrant() {
        for target in [
            [300.0, 400.0],
            [-300.0, 400.0],
            [-300.0, -400.0],
            [300.0, -400.0],
            [0.0, 500.0],
        ] {
            let a = towards([10.0, -20.0], target);
            let b = towards([-80.0, 30.0], target);
            let [x, y] = intersection(&a, &b, 0.02).unwrap();
            assert!(
                (x - target[0]).abs() < 0.01 && (y - target[1]).abs() < 0.01,
                "{x} {y}"
            );
        }
    }

    #[test]
    fn parallel_rays_and_rays_that_part_do_not_meet() {
        let a = towards([0.0, 0.0], [0.0, 100.0]);
        let b = towards([10.0, 0.0], [10.5, 100.0]);
        assert_eq!(intersection(&a, &b, 0.02), None);
        // They would meet south of both.
        let b = towards([10.0, 0.0], [60.0, 100.0]);
        assert_eq!(intersection(&a, &b, 0.02), None);
    }

    #[test]
    fn random_intersections_lie_at_the_source() {
        let all: [Observation; 5] =
            core::array::from_fn(|i| towards([100.0 * i as f32, 0.0], [250.0, 200.0]));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(31);
        for _ in 0..100 {
            let [x, y] = random_intersection(&all, 0.02, &mut rng).unwrap();
            assert!((x - 250.0).abs() < 0.01 && (y - 200.0).abs() < 0.01);
        }
        assert_eq!(random_intersection(&all[..1], 0.02, &mut rng), None);
        assert_eq!(random_intersection(&all[..0], 0.02, &mut rng), None);
    }
}
