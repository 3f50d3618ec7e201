//! Sums over bearings with biases.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector2};

use super::{line::Line, scales::Scale};

/// Sums over bearings, each in its sigma, of the squares of their errors and slopes, and of what the biases make of these.
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    count: usize,
    /// Of the error, and of the slopes of the direction east and north, in 1/m.
    squares: [f64; 3],
    /// Of each of these times each bias.
    shared: Vec<[f64; 3]>,
    /// Sum of the squares of how far a slope can be from that at the centre.
    bends: f64,
    /// Of each bias times each other, row by row.
    products: Vec<f64>,
    /// What these bearings know of the biases, once turned; `None`: as all bearings.
    known: Option<Vec<f64>>,
}

impl Sums {
    /// Turns the biases of all bearings, so that these know of each independently; returns how much, and the turned biases as
    /// columns.
    pub fn turned(lines: &mut [Line], biases: usize) -> (Vec<f64>, DMatrix<f64>) {
        if biases == 0 {
            return (Vec::new(), DMatrix::zeros(0, 0));
        }
        let turns = lines.iter().flat_map(|line| line.turns.iter().copied());
        let turns = DMatrix::from_row_iterator(lines.len(), biases, turns);
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = SymmetricEigen::new(turns.tr_mul(&turns));
        let turns = turns * &eigenvectors;
        for (line, row) in lines.iter_mut().zip(turns.row_iter()) {
            line.turns = row.iter().copied().collect();
        }
        let known = eigenvalues.iter().map(|value| value.max(0.0));
        (known.collect(), eigenvectors)
    }

    /// One direction of this error in radians, whose slope at the centre of the cell is this, in radians per metre east and
    /// north, and elsewhere no further from it than `bend`.
    pub fn add(&mut self, line: &Line, error: f64, slope: Vector2<f64>, bend: f64) {
        let values = [error, slope.x, slope.y].map(|value| value / line.sigma);
        self.count += 1;
        self.bends += (bend / line.sigma).powi(2);
        for (square, value) in self.squares.iter_mut().zip(values) {
            *square += value * value;
        }
        let turns = &line.turns;
        self.shared.resize(turns.len(), [0.0; 3]);
        for (shared, turn) in self.shared.iter_mut().zip(turns) {
            for (shared, value) in shared.iter_mut().zip(values) {
                *shared += turn * value;
            }
        }
        if !turns.is_empty() {
            self.products.resize(turns.len() * turns.len(), 0.0);
            let pairs = turns.iter().flat_map(|a| turns.iter().map(move |b| a * b));
            for (product, pair) in self.products.iter_mut().zip(pairs) {
                *product += pair;
            }
        }
    }

    /// Turns the biases once more if these are not all of so many bearings: then they know other things of them.
    pub fn turn(&mut self, all: usize) {
        let biases = self.shared.len();
        if biases == 0 || self.count == all {
            return;
        }
        let products = DMatrix::from_row_slice(biases, biases, &self.products);
        let turned = SymmetricEigen::new(products);
        for k in 0..3 {
            let shared = DVector::from_iterator(biases, self.shared.iter().map(|s| s[k]));
            let shared = turned.eigenvectors.tr_mul(&shared);
            for (to, from) in self.shared.iter_mut().zip(shared.iter()) {
                to[k] = *from;
            }
        }
        self.known = Some(turned.eigenvalues.iter().map(|v| v.max(0.0)).collect());
    }

    /// The squared norm of the errors in their sigmas, without what the biases explain.
    pub fn error(&self, scale: &Scale) -> f64 {
        self.norm_squared(0, scale)
    }

    /// Means of the turned biases at scale one.
    pub fn biases(&self, scale: &Scale) -> DVector<f64> {
        let means = (self.shared.iter().zip(&scale.known))
            .map(|(shared, known)| -shared[0] / (1.0 + known));
        DVector::from_iterator(self.shared.len(), means)
    }

    /// Norms of the slopes at the centre, without what the biases explain, and of the largest differences from them.
    pub fn slopes(&self, scale: &Scale) -> (Vector2<f64>, f64) {
        let slopes = [1, 2].map(|k| self.norm_squared(k, scale).sqrt());
        (slopes.into(), self.bends.sqrt() / scale.value)
    }

    fn norm_squared(&self, k: usize, scale: &Scale) -> f64 {
        let square = scale.value * scale.value;
        let known = self.known.as_ref().unwrap_or(&scale.known);
        let explained: f64 = (self.shared.iter().zip(known))
            .map(|(shared, known)| shared[k] * shared[k] / (square + known))
            .sum();
        (self.squares[k] - explained).max(0.0) / square
    }
}
