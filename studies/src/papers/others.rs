//! What is known to be done with bearings of which some are outliers, all of them at once.

use foxhunt_simulation::Sight;
use nalgebra::{Matrix2, Vector2};

/// The least cost by Huber's function with that limit, in sigmas, from 144 starts all over the room; where there is
/// no limit, by least squares of the angles.
pub fn huber(sights: &[Sight], limit: f64) -> (Vector2<f64>, Matrix2<f64>) {
    let cost = |place: Vector2<f64>| -> f64 {
        let one = |sight: &Sight| {
            let u = (sight.residual(place.into()) / sight.sigma).abs();
            if u < limit {
                0.5 * u * u
            } else {
                limit * (u - 0.5 * limit)
            }
        };
        sights.iter().map(one).sum()
    };
    let starts = (0..144).map(|k| Vector2::new(f64::from(k % 12), f64::from(k / 12)) * 2.0);
    let ends = starts.map(|start| {
        let mut place = start - Vector2::repeat(11.0);
        let mut information = Matrix2::identity();
        for _ in 0..60 {
            information = Matrix2::zeros();
            let mut gradient = Vector2::zeros();
            for sight in sights {
                let ray = place - Vector2::from(sight.position);
                let across = Vector2::new(-ray.y, ray.x) / (ray.norm_squared() + 1e-6);
                let residual = sight.residual(place.into());
                let u = (residual / sight.sigma).abs();
                let weight = (limit / u).min(1.0) / sight.sigma.powi(2);
                information += across * across.transpose() * weight;
                gradient += across * residual * weight;
            }
            let Some(inverse) = information.try_inverse() else {
                break;
            };
            let mut step = inverse * gradient;
            for _ in 0..12 {
                // Not `>`: a NaN must be halved too.
                if cost(place + step) <= cost(place) {
                    break;
                }
                step *= 0.5;
            }
            place += step;
            let length = step.norm();
            if length <= 1e-7 || length.is_nan() {
                break;
            }
        }
        (place, information)
    });
    let best = ends.min_by(|(a, _), (b, _)| cost(*a).total_cmp(&cost(*b)));
    let (place, information) = best.expect("there are starts");
    let covariance = information.try_inverse();
    (place, covariance.unwrap_or_else(Matrix2::zeros))
}

/// The point with the least squares of distances from all lines of bearing.
pub fn nearest_to_lines(sights: &[Sight]) -> Vector2<f64> {
    let (mut matrix, mut vector) = (Matrix2::zeros(), Vector2::zeros());
    for sight in sights {
        let normal = Vector2::new(-sight.bearing.sin(), sight.bearing.cos());
        matrix += normal * normal.transpose();
        vector += normal * normal.dot(&Vector2::from(sight.position));
    }
    matrix.try_inverse().unwrap_or_else(Matrix2::zeros) * vector
}
