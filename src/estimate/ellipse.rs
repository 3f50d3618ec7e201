//! Ellipses in the plane.

use super::Symmetric2;
use crate::math::{atan2, ln, sin_cos, sqrt};
use crate::random::two_sided_quantile;

/// An ellipse in the plane, and the region of a given probability of a two-dimensional normal distribution. A segment
/// where the distribution is one-dimensional.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ellipse {
    /// Its centre.
    pub centre: [f32; 2],
    /// Half of its longest diameter, in the unit of the centre.
    pub semi_major: f32,
    /// Half of its shortest diameter, in the unit of the centre. Zero for a segment.
    pub semi_minor: f32,
    /// Direction of the longest diameter: radians counter-clockwise from the first axis, in (-pi/2, pi/2].
    pub orientation: f32,
}

impl Ellipse {
    /// Half of the width of a segment, as a fraction of half of its length: how far from the line
    /// [`Ellipse::contains`] tolerates a point.
    pub const TOLERANCE: f32 = 0.01;

    /// The smallest region that a normal distribution gives the probability `probability`: from 0, a point, up to
    /// all but 1e-7.
    ///
    /// The semi-axes are the standard deviations along the axes times the square root of the quantile of the chi-squared
    /// distribution: with two degrees of freedom, `-2 ln(1 - probability)`, which is 2.45 sigma for 95 %; with one degree
    /// where the distribution lies on a line, which is 1.96 sigma.
    pub fn of_normal(centre: [f32; 2], covariance: Symmetric2, probability: f32) -> Self {
        let outside = 1.0 - probability.clamp(0.0, 1.0 - 1e-7);
        let square = if covariance.is_singular() {
            let radius = two_sided_quantile(outside);
            radius * radius
        } else {
            -2.0 * ln(outside)
        };
        Self::of_radius(centre, &covariance, square)
    }

    /// The ellipse whose semi-axes are so many standard deviations along the axes of a normal distribution.
    pub fn of_sigmas(centre: [f32; 2], covariance: Symmetric2, sigmas: f32) -> Self {
        Self::of_radius(centre, &covariance, sigmas * sigmas)
    }

    /// By the square of the Mahalanobis distance of its outline.
    #[inline(never)]
    fn of_radius(centre: [f32; 2], covariance: &Symmetric2, square: f32) -> Self {
        let Symmetric2 { xx, xy, yy } = *covariance;
        // Rounding may push the small eigenvalue of a flat ellipse below zero; by the determinant it loses
        // fewer digits than by the difference.
        let major = covariance.largest_eigenvalue();
        let minor = if covariance.is_singular() {
            0.0
        } else {
            covariance.determinant() / major
        };
        Self {
            centre,
            semi_major: sqrt(square * major),
            semi_minor: sqrt(square * minor),
            orientation: 0.5 * atan2(xy, 0.5 * (xx - yy)),
        }
    }

    /// Whether `point` lies inside. A segment holds what is no farther from it than [`Ellipse::TOLERANCE`].
    pub fn contains(&self, point: [f32; 2]) -> bool {
        let (sin, cos) = sin_cos(self.orientation);
        let (dx, dy) = (point[0] - self.centre[0], point[1] - self.centre[1]);
        let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let (major, minor) = (self.semi_major, self.semi_minor);
        if minor == 0.0 {
            return along.abs() <= major && across.abs() <= Self::TOLERANCE * major;
        }
        // In products: the shorter axis may be very short.
        let (u, v) = (along * minor, across * major);
        along.abs() <= major && u * u + v * v <= (major * minor) * (major * minor)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

    #[test]
    fn ellipse_of_a_known_covariance() {
        // Eigenvalues 9 and 4, the longer axis 30 degrees from the first.
        let (sin, cos) = (0.5f32, 0.75f32.sqrt());
        let covariance = [
            [9.0 * cos * cos + 4.0 * sin * sin, 5.0 * sin * cos],
            [5.0 * sin * cos, 9.0 * sin * sin + 4.0 * cos * cos],
        ];
        let ellipse = Ellipse::of_normal([10.0, 20.0], covariance.into(), 0.95);
        let radius = 5.991_465f32.sqrt();
        assert!((ellipse.semi_major - 3.0 * radius).abs() < 1e-4);
        assert!((ellipse.semi_minor - 2.0 * radius).abs() < 1e-4);
        assert!((ellipse.orientation - core::f32::consts::FRAC_PI_6).abs() < 1e-5);
        assert!(ellipse.contains([10.0 + 2.9 * radius * cos, 20.0 + 2.9 * radius * sin]));
        assert!(!ellipse.contains([10.0 - 2.1 * radius * sin, 20.0 + 2.1 * radius * cos]));
    }

    #[test]
    fn ellipse_holds_its_probability_of_a_normal_cloud() {
        // 100,000 points: three standard errors of the fraction are 0.2 %, 0.5 % and 0.4 %.
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(22);
        for (probability, tolerance) in [(0.95, 0.0021), (0.5, 0.0048), (0.8, 0.0038)] {
            let ellipse =
                Ellipse::of_normal([1.0, -2.0], [[4.0, 1.2], [1.2, 1.0]].into(), probability);
            let inside = (0..100_000)
                .filter(|_| {
                    let (u, v) = (normal(&mut rng), normal(&mut rng));
                    ellipse.contains([1.0 + 2.0 * u, -2.0 + 0.6 * u + 0.8 * v])
                })
                .count();
            assert!((inside as f32 / 1e5 - probability).abs() < tolerance);
        }
    }

    #[test]
    fn a_line_has_segments_of_the_right_length_in_every_direction() {
        for degrees in [0u8, 10, 45, 80, 90, 135, 170] {
            let (sin, cos) = f32::from(degrees).to_radians().sin_cos();
            let on_line = |t: f32| [100.0 + t * cos, 200.0 + t * sin];
            let (variance, centre) = (4.0, on_line(0.0));
            let covariance = [
                [variance * cos * cos, variance * sin * cos],
                [variance * sin * cos, variance * sin * sin],
            ];
            for (probability, sigmas) in [(0.95, 1.96), (0.6827, 1.0), (0.5, 0.6745), (0.0, 0.0)] {
                let segment = Ellipse::of_normal(centre, covariance.into(), probability);
                assert_eq!(segment.semi_minor, 0.0, "{degrees}");
                assert!(
                    (segment.semi_major - 2.0 * sigmas).abs() < 1e-3,
                    "{segment:?}"
                );
            }
            let segment = Ellipse::of_normal(centre, covariance.into(), 0.95);
            for t in [-3.91, -2.0, -0.01, 0.0, 1.0, 3.0, 3.91] {
                assert!(segment.contains(on_line(t)), "{degrees} {t}");
                let [x, y] = on_line(t);
                assert!(segment.contains([x - 0.03 * sin, y + 0.03 * cos]));
                assert!(!segment.contains([x - 0.05 * sin, y + 0.05 * cos]));
            }
            assert!(!segment.contains(on_line(3.93)) && !segment.contains(on_line(-3.93)));
            assert_eq!(
                Ellipse::of_sigmas(centre, covariance.into(), 1.0).semi_minor,
                0.0
            );
            let one = Ellipse::of_sigmas(centre, covariance.into(), 1.0).semi_major;
            assert!((one - 2.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_thin_ellipse_is_no_segment() {
        // A sigma of 1 km along and 1 m across, at 30 degrees.
        let (sin, cos) = (0.5f32, 0.75f32.sqrt());
        let covariance = [
            [1e6 * cos * cos + sin * sin, (1e6 - 1.0) * sin * cos],
            [(1e6 - 1.0) * sin * cos, 1e6 * sin * sin + cos * cos],
        ];
        let ellipse = Ellipse::of_normal([0.0, 0.0], covariance.into(), 0.95);
        assert!((ellipse.semi_major - 2447.7).abs() < 1.0, "{ellipse:?}");
        assert!((ellipse.semi_minor - 2.45).abs() < 0.5, "{ellipse:?}");
    }

    #[test]
    fn degenerate_covariances_give_no_nan() {
        let ellipse = Ellipse::of_normal([0.0, 0.0], [[1.0, 1.0], [1.0, 1.0]].into(), 0.95);
        assert!(ellipse.contains([0.0, 0.0]) && ellipse.contains([1.38, 1.38]));
        assert!(!ellipse.contains([1.0, -1.0]));
        let point = Ellipse::of_normal([5.0, 5.0], Symmetric2::ZERO, 0.95);
        assert!(point.contains([5.0, 5.0]) && !point.contains([5.0, 5.001]));
        for probability in [0.0, 1.0, 7.0] {
            let ellipse =
                Ellipse::of_normal([0.0, 0.0], [[1.0, 0.0], [0.0, 0.0]].into(), probability);
            assert!(ellipse.semi_major.is_finite() && ellipse.contains([0.0, 0.0]));
        }
        // All but 2^-23, the least that f32 leaves of one: the root of 46 ln 2.
        let most = Ellipse::of_normal([0.0, 0.0], Symmetric2::isotropic(1.0), 1.0);
        assert!((most.semi_major - 5.646_7).abs() < 1e-3, "{most:?}");
    }
}
