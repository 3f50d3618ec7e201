//! Sums over bearings with biases.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector2};

use super::scales::Scale;

/// What some bearings know of biases, each in its own sigma, if the scale is one.
#[derive(Debug, Clone)]
pub(super) struct Known {
    /// How much they know of biases of which they know independently.
    values: Vec<f64>,
    /// Those biases, as columns.
    biases: DMatrix<f64>,
}

impl Known {
    /// From the sums over the bearings of each bias times each other, row by row, in the sigmas of the bearings.
    fn new(count: usize, products: &[f64]) -> Self {
        if count == 0 {
            return Self {
                values: Vec::new(),
                biases: DMatrix::zeros(0, 0),
            };
        }
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = SymmetricEigen::new(DMatrix::from_row_slice(count, count, products));
        Self {
            values: eigenvalues.iter().map(|value| value.max(0.0)).collect(),
            biases: eigenvectors,
        }
    }

    /// Of bearings with these turns.
    pub fn of<'a>(turns: impl Iterator<Item = &'a [f64]>) -> Self {
        let mut sums = Sums::default();
        for turns in turns {
            sums.add(1.0, turns, 0.0, Vector2::zeros(), 0.0);
        }
        sums.known()
    }

    /// Half the logarithm of the determinant of the errors' covariance with biases, against that without; where no turns are
    /// off by more than `change`, as a norm, the least it can be.
    pub fn determinant(&self, scale: &Scale, change: f64) -> f64 {
        let known = self.values.iter().map(|value| {
            let least = (value.sqrt() - change).max(0.0) / scale.value;
            (least * least).ln_1p()
        });
        0.5 * known.sum::<f64>()
    }
}

/// Sums over bearings, each in its sigma, of the squares of their errors and slopes, and of what the biases make of these.
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    /// Of the error, and of the slopes of the direction east and north, in 1/m.
    squares: [f64; 3],
    /// Of each of these times each bias.
    shared: Vec<[f64; 3]>,
    /// Sum of the squares of how far a slope can be from that at the centre.
    bends: f64,
    /// Of each bias times each other, row by row.
    products: Vec<f64>,
}

impl Sums {
    /// One direction of this error in radians, whose slope at the centre of the cell is this, in radians per metre east and
    /// north, and elsewhere no further from it than `bend`. Each bias turns it by so many sigmas.
    pub fn add(&mut self, sigma: f64, turns: &[f64], error: f64, slope: Vector2<f64>, bend: f64) {
        let values = [error, slope.x, slope.y].map(|value| value / sigma);
        self.bends += (bend / sigma).powi(2);
        for (square, value) in self.squares.iter_mut().zip(values) {
            *square += value * value;
        }
        self.shared.resize(turns.len(), [0.0; 3]);
        for (shared, turn) in self.shared.iter_mut().zip(turns) {
            for (shared, value) in shared.iter_mut().zip(values) {
                *shared += turn * value;
            }
        }
        self.products.resize(turns.len() * turns.len(), 0.0);
        let pairs = turns.iter().flat_map(|a| turns.iter().map(move |b| a * b));
        for (product, pair) in self.products.iter_mut().zip(pairs) {
            *product += pair;
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.shared.is_empty()
    }

    /// What these bearings know of the biases.
    pub fn known(&self) -> Known {
        Known::new(self.shared.len(), &self.products)
    }

    /// The sums over the biases of which the bearings know independently.
    pub fn turned(mut self, known: Known) -> Turned {
        for k in 0..3 {
            let shared = self.shared.iter().map(|shared| shared[k]);
            let shared = DVector::from_iterator(self.shared.len(), shared);
            let shared = known.biases.tr_mul(&shared);
            for (to, from) in self.shared.iter_mut().zip(shared.iter()) {
                to[k] = *from;
            }
        }
        Turned { sums: self, known }
    }
}

/// Sums over bearings that know of each bias independently.
pub(super) struct Turned {
    sums: Sums,
    pub known: Known,
}

impl Turned {
    /// The norm of the errors in their sigmas, without what the biases explain.
    pub fn error(&self, scale: &Scale) -> f64 {
        self.norm(0, scale)
    }

    /// Norms of the slopes at the centre, without what the biases explain, and of the largest differences from them.
    pub fn slopes(&self, scale: &Scale) -> (Vector2<f64>, f64) {
        let slopes = [1, 2].map(|k| self.norm(k, scale));
        (slopes.into(), self.sums.bends.sqrt() / scale.value)
    }

    /// Means and covariance of the biases at scale one.
    pub fn biases(&self) -> (DVector<f64>, DMatrix<f64>) {
        let Known { values, biases } = &self.known;
        let count = values.len();
        let pairs = self.sums.shared.iter().zip(values);
        let means = pairs.map(|(shared, known)| -shared[0] / (1.0 + known));
        let means = DVector::from_iterator(count, means);
        let variances = values.iter().map(|known| 1.0 / (1.0 + known));
        let variances = DMatrix::from_diagonal(&DVector::from_iterator(count, variances));
        (biases * means, biases * variances * biases.transpose())
    }

    fn norm(&self, k: usize, scale: &Scale) -> f64 {
        let square = scale.value * scale.value;
        let pairs = self.sums.shared.iter().zip(&self.known.values);
        let explained: f64 = pairs
            .map(|(shared, known)| shared[k] * shared[k] / (square + known))
            .sum();
        (self.sums.squares[k] - explained).max(0.0).sqrt() / scale.value
    }
}
