//! How good any unbiased estimate can be.

use nalgebra::{Matrix2, Vector2};

use foxhunt_simulation::Sight;

/// The Cramer-Rao bound on the covariance of an estimate of a `source` that the `sights` are taken on,
/// in square metres: the inverse of the sum of u u^T / (sigma r)^2, u across the line of sight and r
/// its length. `None` if they do not determine the source.
pub fn cramer_rao(sights: &[Sight], source: [f64; 2]) -> Option<Matrix2<f64>> {
    cramer_rao_of_biased(sights, source, 0.0)
}

/// The bound of [`cramer_rao`] where all bearings have one more unknown in common: a bias of that sigma, in radians.
pub fn cramer_rao_of_biased(sights: &[Sight], source: [f64; 2], bias: f64) -> Option<Matrix2<f64>> {
    let mut information = Matrix2::zeros();
    let mut shared = Vector2::zeros();
    let mut known = 0.0;
    for sight in sights {
        let ray = Vector2::from(source) - Vector2::from(sight.position);
        let across = Vector2::new(-ray.y, ray.x) / (sight.sigma * ray.norm_squared());
        information += across * across.transpose();
        shared += across / sight.sigma;
        known += 1.0 / (sight.sigma * sight.sigma);
    }
    if bias > 0.0 {
        information -= shared * shared.transpose() / (1.0 / (bias * bias) + known);
    }
    information.try_inverse()
}

#[cfg(test)]
mod tests {
    use foxhunt_simulation::random;

    use super::*;
    use crate::{simulate, tracks::Track};

    #[test]
    fn bound_of_the_published_tracks() {
        let sigma = |track: Track| {
            let sights = simulate::bearings(&track, &mut random::generator(0, 0));
            cramer_rao(&sights, track.source).unwrap().trace().sqrt()
        };
        assert!((sigma(Track::a1()) - 6.86).abs() < 0.005);
        assert!((sigma(Track::a2()) - 2.86).abs() < 0.005);
        assert!((sigma(Track::b2()) - 12.8).abs() < 0.05);
    }

    /// Nothing gets better by not knowing, and one direction gets worse: the difference is of rank one, but for rounding.
    #[test]
    fn a_bias_costs_one_direction() {
        let sights = simulate::bearings(&Track::a2(), &mut random::generator(8, 0));
        let source = Track::a2().source;
        let straight = cramer_rao(&sights, source).unwrap();
        let biased = cramer_rao_of_biased(&sights, source, 0.05).unwrap();
        let worse = (biased - straight).symmetric_eigenvalues();
        assert!(worse.min() > -1e-9 * straight.norm() && worse.max() > 0.01 * straight.norm());
    }
}
