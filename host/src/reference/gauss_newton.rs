//! Maximum likelihood in f64.

use nalgebra::{Matrix2, Vector2};

use foxhunt_simulation::Sight;

/// A maximum of the likelihood.
#[derive(Debug, Clone, Copy)]
pub struct Maximum {
    /// Where it is, in metres east and north.
    pub place: [f64; 2],
    /// Inverse of the Gauss-Newton Hessian there, in square metres.
    pub covariance: Matrix2<f64>,
}

/// The maximum of the Gaussian likelihood of all `sights` that is reached from `start`: Gauss-Newton
/// with step halving. `None` if the sights do not determine a place.
pub fn gauss_newton(sights: &[Sight], start: [f64; 2]) -> Option<Maximum> {
    let cost = |place: Vector2<f64>| -> f64 {
        sights
            .iter()
            .map(|s| (s.residual(place.into()) / s.sigma).powi(2))
            .sum()
    };
    let normal_equations = |place: Vector2<f64>| {
        let mut hessian = Matrix2::zeros();
        let mut gradient = Vector2::zeros();
        for sight in sights {
            let ray = place - Vector2::from(sight.position);
            let across = Vector2::new(-ray.y, ray.x) / (sight.sigma * ray.norm_squared());
            hessian += across * across.transpose();
            gradient += across * (sight.residual(place.into()) / sight.sigma);
        }
        (hessian, gradient)
    };

    let mut place = Vector2::from(start);
    for _ in 0..100 {
        let (hessian, gradient) = normal_equations(place);
        let mut step = hessian.try_inverse()? * gradient;
        let before = cost(place);
        for _ in 0..30 {
            // Not `>`: a NaN must be halved too.
            if cost(place + step) <= before {
                break;
            }
            step *= 0.5;
        }
        if !step.norm().is_finite() {
            return None;
        }
        place += step;
        if step.norm() < 1e-9 * (1.0 + place.norm()) {
            break;
        }
    }
    Some(Maximum {
        place: place.into(),
        covariance: normal_equations(place).0.try_inverse()?,
    })
}
