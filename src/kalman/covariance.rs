//! A covariance, held as its Cholesky factor.

use crate::math::vector::plus_scaled;
use crate::math::{ln, sqrt};
use crate::snapshot::{Error, Reader, Value, Writer};

/// A symmetric positive semidefinite matrix of `D` rows, held as a lower triangular factor `L` with
/// `matrix = L L^T`: by construction it cannot lose either property.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Covariance<const D: usize> {
    /// The columns of the factor. Zero above the diagonal, on which nothing is negative.
    columns: [[f32; D]; D],
}

/// The columns of the factor.
impl<const D: usize> Value for Covariance<D> {
    const SIZE: usize = 4 * D * D;

    fn write(&self, to: &mut Writer<'_>) {
        to.column(self.columns.as_flattened());
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        let mut columns = [[0.0; D]; D];
        from.column(columns.as_flattened_mut())?;
        Ok(Self { columns })
    }
}

impl<const D: usize> Covariance<D> {
    /// No uncertainty at all.
    pub const ZERO: Self = Self {
        columns: [[0.0; D]; D],
    };

    /// Of independent dimensions with these standard deviations.
    pub const fn diagonal(sigmas: [f32; D]) -> Self {
        let mut columns = [[0.0; D]; D];
        let mut k = 0;
        while k < D {
            columns[k][k] = sigmas[k].abs();
            k += 1;
        }
        Self { columns }
    }

    /// Of a matrix, of which the lower triangle counts. `None` when it is not finite, or more negative in some direction
    /// than rounding explains.
    pub fn new(matrix: &[[f32; D]; D]) -> Option<Self> {
        /// Fraction of a variance that the rounding of a matrix in f32 may cost.
        const ROUNDING: f32 = 4e-7;
        let mut columns = [[0.0; D]; D];
        // What is left of the lower triangle after the columns found so far: rest[row][column].
        let mut rest = *matrix;
        for (k, column) in columns.iter_mut().enumerate() {
            let (Some(pivot), Some(variance)) = (at(&rest, k, k), at(matrix, k, k)) else {
                continue;
            };
            let lost = ROUNDING * D as f32 * variance;
            if !(pivot >= -lost && pivot <= f32::MAX) {
                return None;
            }
            if pivot <= lost {
                continue;
            }
            let root = sqrt(pivot);
            for (l, row) in column.iter_mut().zip(&rest).skip(k) {
                *l = row.get(k).copied().unwrap_or(0.0) / root;
            }
            for (row, l) in rest.iter_mut().zip(*column) {
                for (entry, other) in row.iter_mut().zip(*column) {
                    *entry -= l * other;
                }
            }
        }
        Some(Self { columns }).filter(Self::is_finite)
    }

    /// Adds `vector vector^T`: another independent source of noise, which moves the state along `vector`.
    ///
    /// By a Givens rotation for each column, which is stable whatever the vector.
    pub fn add(&mut self, mut vector: [f32; D]) {
        for (k, column) in self.columns.iter_mut().enumerate() {
            let rotation = Rotation::onto(column, &vector, k);
            rotation.turn(column, &mut vector, k);
        }
    }

    /// With another independent noise added.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        for column in other.columns {
            self.add(column);
        }
        self
    }

    /// The matrix itself.
    pub fn matrix(&self) -> [[f32; D]; D] {
        let mut matrix = [[0.0; D]; D];
        for column in &self.columns {
            for (row, a) in matrix.iter_mut().zip(column) {
                for (entry, b) in row.iter_mut().zip(column) {
                    *entry += a * b;
                }
            }
        }
        matrix
    }

    /// The standard deviation of every dimension.
    pub fn sigmas(&self) -> [f32; D] {
        let mut squares = [0.0; D];
        for column in &self.columns {
            for (square, l) in squares.iter_mut().zip(column) {
                *square += l * l;
            }
        }
        squares.map(sqrt)
    }

    /// The columns of the factor; the sum of their outer products is the matrix.
    pub const fn columns(&self) -> &[[f32; D]; D] {
        &self.columns
    }

    /// From columns that came from [`Covariance::columns`].
    pub(crate) fn from_columns(columns: [[f32; D]; D]) -> Self {
        Self { columns }
    }

    /// `L vector`: turns independent standard normals into a vector of this covariance.
    pub fn colour(&self, vector: [f32; D]) -> [f32; D] {
        let mut sum = [0.0; D];
        for (column, v) in self.columns.iter().zip(vector) {
            sum = plus_scaled(sum, v, *column);
        }
        sum
    }

    /// `L^-1 vector`: the vector in sigmas. Not finite when the matrix is singular.
    pub fn whiten(&self, mut vector: [f32; D]) -> [f32; D] {
        let mut white = [0.0; D];
        for (k, (column, w)) in self.columns.iter().zip(&mut white).enumerate() {
            if let (Some(l), Some(v)) = (column.get(k), vector.get(k)) {
                *w = v / l;
            }
            vector = plus_scaled(vector, -*w, *column);
        }
        white
    }

    /// Half the natural logarithm of the determinant; minus infinity when the matrix is singular.
    #[inline(never)]
    pub fn half_ln_determinant(&self) -> f32 {
        self.pivots().map(ln).sum()
    }

    pub(super) fn is_finite(&self) -> bool {
        self.columns.iter().flatten().all(|l| l.is_finite())
    }

    pub(super) fn is_singular(&self) -> bool {
        self.pivots().any(|l| l == 0.0)
    }

    /// The diagonal of the factor.
    fn pivots(&self) -> impl Iterator<Item = f32> {
        let columns = self.columns.iter().enumerate();
        columns.filter_map(|(k, column)| column.get(k).copied())
    }
}

fn at<const D: usize>(rows: &[[f32; D]; D], row: usize, column: usize) -> Option<f32> {
    rows.get(row).and_then(|row| row.get(column)).copied()
}

/// A rotation of two vectors into each other.
#[derive(Clone, Copy)]
pub(super) struct Rotation {
    cos: f32,
    sin: f32,
}

impl Rotation {
    /// The one after which `vector` has no component `k`, and the column has all of it.
    #[inline(always)]
    pub(super) fn onto<const D: usize>(column: &[f32; D], vector: &[f32; D], k: usize) -> Self {
        let a = column.get(k).copied().unwrap_or(0.0);
        let b = vector.get(k).copied().unwrap_or(0.0);
        if b == 0.0 {
            return Self { cos: 1.0, sin: 0.0 };
        }
        let length = sqrt(a * a + b * b);
        Self {
            cos: a / length,
            sin: b / length,
        }
    }

    /// Turns both, from component `first` on.
    #[inline(always)]
    pub(super) fn turn<const D: usize>(
        self,
        column: &mut [f32; D],
        vector: &mut [f32; D],
        first: usize,
    ) {
        for (l, v) in column.iter_mut().zip(vector).skip(first) {
            (*l, *v) = (self.cos * *l + self.sin * *v, self.cos * *v - self.sin * *l);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

    #[test]
    fn the_factor_gives_the_matrix_back() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(31);
        for _ in 0..1000 {
            let vectors: [[f32; 4]; 6] =
                core::array::from_fn(|_| core::array::from_fn(|_| normal(&mut rng)));
            let mut added = Covariance::ZERO;
            let mut matrix = [[0.0; 4]; 4];
            for vector in vectors {
                added.add(vector);
                for i in 0..4 {
                    for j in 0..4 {
                        matrix[i][j] += vector[i] * vector[j];
                    }
                }
            }
            let decomposed = Covariance::new(&matrix).unwrap();
            for factor in [added, decomposed] {
                for (row, expected) in factor.matrix().iter().zip(&matrix) {
                    for (entry, expected) in row.iter().zip(expected) {
                        assert!((entry - expected).abs() < 1e-5, "{entry} {expected}");
                    }
                }
            }
            let v = vectors[0];
            let back = added.colour(added.whiten(v));
            assert!(back.iter().zip(v).all(|(a, b)| (a - b).abs() < 1e-3));
        }
    }

    #[test]
    fn a_flat_matrix_is_a_covariance_and_an_indefinite_one_is_not() {
        let flat = Covariance::new(&[[1.0, 2.0], [2.0, 4.0]]).unwrap();
        assert_eq!(flat.matrix(), [[1.0, 2.0], [2.0, 4.0]]);
        assert!(flat.is_singular());
        assert_eq!(flat.half_ln_determinant(), f32::NEG_INFINITY);
        assert!(Covariance::new(&[[0.0; 3]; 3]).is_some());
        for bad in [
            [[1.0, 0.0], [0.0, -1.0]],
            [[1.0, 2.0], [2.0, 1.0]],
            [[1.0, f32::NAN], [f32::NAN, 1.0]],
            [[f32::INFINITY, 0.0], [0.0, 1.0]],
            [[f32::NAN, 0.0], [0.0, 1.0]],
        ] {
            assert_eq!(Covariance::new(&bad), None, "{bad:?}");
        }
    }

    #[test]
    fn determinant_and_sigmas_of_a_known_matrix() {
        let covariance = Covariance::new(&[[4.0, 2.0], [2.0, 10.0]]).unwrap();
        assert!((covariance.half_ln_determinant() - 6f32.ln()).abs() < 1e-6);
        assert_eq!(covariance.sigmas(), [2.0, 10f32.sqrt()]);
        assert_eq!(Covariance::diagonal([2.0, -3.0]).sigmas(), [2.0, 3.0]);
    }
}
