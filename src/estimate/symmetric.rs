//! Symmetric matrices of two rows.

use crate::math::sqrt;
use crate::snapshot::value;

/// A symmetric matrix of two rows: a covariance in the plane, or the inverse of one.
///
/// ```
/// use foxhunt::estimate::Symmetric2;
///
/// let covariance = Symmetric2 { xx: 4.0, xy: 0.0, yy: 1.0 };
/// assert_eq!(covariance.largest_eigenvalue(), 4.0);
/// // (1, 1) is one half of a sigma away along x, one along y.
/// assert_eq!(covariance.mahalanobis_squared([1.0, 1.0]), 1.25);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Symmetric2 {
    /// The entry of the first row and column.
    pub xx: f32,
    /// Either entry off the diagonal.
    pub xy: f32,
    /// The entry of the second row and column.
    pub yy: f32,
}

impl Symmetric2 {
    /// No extent at all.
    pub const ZERO: Self = Self::isotropic(0.0);

    /// The same variance in every direction.
    pub const fn isotropic(variance: f32) -> Self {
        Self {
            xx: variance,
            xy: 0.0,
            yy: variance,
        }
    }

    /// The matrix, row by row.
    pub const fn rows(&self) -> [[f32; 2]; 2] {
        [[self.xx, self.xy], [self.xy, self.yy]]
    }

    /// The sum of two matrices: of covariances, that of the sum of independent errors.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            xy: self.xy + other.xy,
            yy: self.yy + other.yy,
        }
    }

    /// With `factor` times the outer product of a vector with itself added.
    #[must_use]
    pub fn plus_outer(&self, factor: f32, [x, y]: [f32; 2]) -> Self {
        Self {
            xx: self.xx + factor * x * x,
            xy: self.xy + factor * x * y,
            yy: self.yy + factor * y * y,
        }
    }

    /// `factor` times the matrix.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        Self {
            xx: factor * self.xx,
            xy: factor * self.xy,
            yy: factor * self.yy,
        }
    }

    /// The matrix times a vector.
    pub fn times(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [self.xx * x + self.xy * y, self.xy * x + self.yy * y]
    }

    /// The determinant.
    pub fn determinant(&self) -> f32 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// Whether the matrix is not positive definite as far as f32 can tell: a distribution then lies on a line.
    pub fn is_singular(&self) -> bool {
        // The determinant of rounded numbers is worth no more than this.
        const ROUNDING: f32 = 1e-6;
        let determinant = self.determinant();
        !(determinant > ROUNDING * self.xx * self.yy && determinant.is_normal())
    }

    /// The inverse; `None` if the matrix is singular.
    pub fn inverse(&self) -> Option<Self> {
        let determinant = self.determinant();
        (!self.is_singular()).then(|| Self {
            xx: self.yy / determinant,
            xy: -self.xy / determinant,
            yy: self.xx / determinant,
        })
    }

    /// The larger eigenvalue: the variance along the longest axis of a distribution.
    pub fn largest_eigenvalue(&self) -> f32 {
        let half_difference = 0.5 * (self.xx - self.yy);
        0.5 * (self.xx + self.yy) + sqrt(half_difference * half_difference + self.xy * self.xy)
    }

    /// The square of a vector's length in sigmas; not finite if the matrix is singular.
    pub fn mahalanobis_squared(&self, offset: [f32; 2]) -> f32 {
        self.adjugate_form(offset) / self.determinant()
    }

    /// Whether a vector is shorter than so many sigmas. False for any if the matrix is singular.
    pub fn is_within(&self, offset: [f32; 2], sigmas: f32) -> bool {
        self.adjugate_form(offset) < sigmas * sigmas * self.determinant()
    }

    /// The square of a vector's length in sigmas, times the determinant.
    fn adjugate_form(&self, [x, y]: [f32; 2]) -> f32 {
        self.yy * x * x - 2.0 * self.xy * x * y + self.xx * y * y
    }
}

/// By rows, of which the entry below the diagonal does not count.
impl From<[[f32; 2]; 2]> for Symmetric2 {
    fn from([[xx, xy], [_, yy]]: [[f32; 2]; 2]) -> Self {
        Self { xx, xy, yy }
    }
}

value!(Symmetric2 { xx, xy, yy });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_eigenvalue_and_distance_belong_together() {
        // Eigenvalues 9 and 4, the first at 45 degrees.
        let matrix = Symmetric2::isotropic(4.0).plus_outer(2.5, [1.0, 1.0]);
        assert_eq!(matrix.rows(), [[6.5, 2.5], [2.5, 6.5]]);
        assert_eq!(matrix.largest_eigenvalue(), 9.0);
        assert_eq!(matrix.determinant(), 36.0);
        let inverse = matrix.inverse().unwrap();
        let vector = [3.0, -1.0];
        let [x, y] = inverse.times(matrix.times(vector));
        assert!((x - 3.0).abs() < 1e-5 && (y + 1.0).abs() < 1e-5);
        let [a, b] = inverse.times(vector);
        let square = matrix.mahalanobis_squared(vector);
        assert!((square - (3.0 * a - b)).abs() < 1e-5);
        assert!(matrix.is_within(vector, 1.001 * square.sqrt()));
        assert!(!matrix.is_within(vector, 0.999 * square.sqrt()));
        let half = matrix.scaled(0.5);
        assert_eq!(half.plus(&half), matrix);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_inverse() {
        for singular in [
            Symmetric2::ZERO,
            Symmetric2::ZERO.plus_outer(1.0, [0.3, 0.7]),
            Symmetric2::from([[1.0, 2.0], [2.0, 1.0]]),
            Symmetric2::isotropic(f32::NAN),
        ] {
            assert_eq!(singular.inverse(), None);
            assert!(!singular.is_within([0.0, 0.0], 3.0));
        }
    }
}
