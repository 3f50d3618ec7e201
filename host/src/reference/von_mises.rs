//! Maximum likelihood under von Mises errors, in f64.

use nalgebra::{Matrix2, Vector2};

use super::Maximum;
use foxhunt_simulation::Sight;

/// The place that is most likely if the errors of all `sights` are von Mises distributed with one concentration, which is
/// estimated from the residuals, and its asymptotic covariance: Lenth, "On finding the source of a signal", Technometrics 23
/// (1981). By Gauss-Newton from `start`. `None` if the sights do not determine a place.
pub fn von_mises(sights: &[Sight], start: [f64; 2]) -> Option<Maximum> {
    let mut place = Vector2::from(start);
    for _ in 0..100 {
        let mut hessian = Matrix2::zeros();
        let mut gradient = Vector2::zeros();
        for sight in sights {
            let ray = place - Vector2::from(sight.position);
            let across = Vector2::new(-ray.y, ray.x) / ray.norm_squared();
            hessian += across * across.transpose();
            gradient += across * sight.residual(place.into()).sin();
        }
        let step = hessian.try_inverse()? * gradient;
        if !step.norm().is_finite() {
            return None;
        }
        place += step;
        if step.norm() < 1e-9 * (1.0 + place.norm()) {
            break;
        }
    }
    let mut information = Matrix2::zeros();
    let mut cosines = 0.0;
    for sight in sights {
        let ray = place - Vector2::from(sight.position);
        let across = Vector2::new(-ray.y, ray.x) / ray.norm_squared();
        // The paper multiplies the expected by the measured direction, both over the distance.
        let (sin, cos) = sight.bearing.sin_cos();
        let measured = Vector2::new(-sin, cos) / ray.norm();
        information += 0.5 * (across * measured.transpose() + measured * across.transpose());
        cosines += sight.residual(place.into()).cos();
    }
    // The inverse of the concentration, by Lenth's series in the mean cosine.
    let c = cosines / sights.len() as f64;
    let s = 1.0 - c;
    let spread = 2.0 * s + s * s * (0.48794 - 0.82905 * c - 1.3915 * c * c) / c;
    Some(Maximum {
        place: place.into(),
        covariance: spread * information.try_inverse()?,
    })
}
