//! How good any unbiased estimate can be.

use nalgebra::{Matrix2, Vector2};

use crate::Sight;

/// The Cramer-Rao bound on the covariance of an estimate of a `source` that the `sights` are taken on,
/// in square metres: the inverse of the sum of u u^T / (sigma r)^2, u across the line of sight and r
/// its length. `None` if they do not determine the source.
pub fn cramer_rao(sights: &[Sight], source: [f64; 2]) -> Option<Matrix2<f64>> {
    let information: Matrix2<f64> = sights
        .iter()
        .map(|sight| {
            let ray = Vector2::from(source) - Vector2::from(sight.position);
            let across = Vector2::new(-ray.y, ray.x) / (sight.sigma * ray.norm_squared());
            across * across.transpose()
        })
        .sum();
    information.try_inverse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{simulate, tracks::Track};

    #[test]
    fn bound_of_the_published_tracks() {
        let sigma = |track: Track| {
            let sights = simulate::bearings(&track, &mut simulate::generator(0, 0));
            cramer_rao(&sights, track.source).unwrap().trace().sqrt()
        };
        assert!((sigma(Track::a1()) - 6.86).abs() < 0.005);
        assert!((sigma(Track::a2()) - 2.86).abs() < 0.005);
        assert!((sigma(Track::b2()) - 12.8).abs() < 0.05);
    }
}
