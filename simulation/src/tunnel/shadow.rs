//! Shadowing: a random field that stays where it is.

use alloc::vec::Vec;

use rand::Rng;

use crate::random::normal;

/// Metres between the points of the grid on which a field is drawn.
const SPACING: f64 = 0.5;

/// A Gaussian random field with covariance `sigma^2 exp(-(|dx| + |dy|) / correlation)`: an
/// Ornstein-Uhlenbeck process along either axis.
#[derive(Debug, Clone)]
pub struct Shadow {
    columns: usize,
    rows: usize,
    /// In dB, row by row.
    values: Vec<f64>,
}

impl Shadow {
    /// Draws a field over the rectangle from the origin to `extent`.
    pub fn draw(extent: [f64; 2], sigma: f64, correlation: f64, rng: &mut impl Rng) -> Self {
        let [columns, rows] = extent.map(|metres| libm::ceil(metres / SPACING) as usize + 1);
        let kept = libm::exp(-SPACING / correlation);
        let fresh = libm::sqrt(1.0 - kept * kept);
        let mut values: Vec<f64> = (0..columns * rows).map(|_| sigma * normal(rng)).collect();
        // White noise becomes a stationary process along x, and the rows of that one along y.
        for n in 0..values.len() {
            if n % columns > 0 {
                values[n] = kept * values[n - 1] + fresh * values[n];
            }
        }
        for n in columns..values.len() {
            values[n] = kept * values[n - columns] + fresh * values[n];
        }
        Self {
            columns,
            rows,
            values,
        }
    }

    /// The field at `place`, bilinear between the points of the grid; outside, that of the nearest edge.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let cell = |metres: f64, points: usize| {
            let position = (metres / SPACING).clamp(0.0, (points - 1) as f64);
            let first = (position as usize).min(points.saturating_sub(2));
            (first, position - first as f64)
        };
        let (column, u) = cell(place[0], self.columns);
        let (row, v) = cell(place[1], self.rows);
        let value = |c: usize, r: usize| {
            self.values[r.min(self.rows - 1) * self.columns + c.min(self.columns - 1)]
        };
        (1.0 - v) * ((1.0 - u) * value(column, row) + u * value(column + 1, row))
            + v * ((1.0 - u) * value(column, row + 1) + u * value(column + 1, row + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::generator;

    #[test]
    fn the_covariance_is_separable_and_exponential() {
        // Products of pairs of places over many fields, against sigma^2 exp(-distance / 5).
        let places = [[20.0, 1.0], [20.0, 3.5], [22.5, 1.0], [25.0, 3.0]];
        const RUNS: u64 = 4000;
        let mut products = [[0.0; 4]; 4];
        for run in 0..RUNS {
            let field = Shadow::draw([40.0, 3.5], 4.0, 5.0, &mut generator(5, run));
            let values = places.map(|place| field.at(place));
            for (row, a) in products.iter_mut().zip(values) {
                for (cell, b) in row.iter_mut().zip(values) {
                    *cell += a * b / RUNS as f64;
                }
            }
        }
        for (row, a) in products.iter().zip(places) {
            for (product, b) in row.iter().zip(places) {
                let distance = (a[0] - b[0]).abs() + (a[1] - b[1]).abs();
                let expected = 16.0 * (-distance / 5.0).exp();
                // The sigma of such a product is below 16 sqrt(2); four of the mean's are allowed, so one
                // seed in some thousand fails.
                let allowed = 4.0 * 16.0 * (2.0 / RUNS as f64).sqrt();
                assert!((product - expected).abs() < allowed, "{product} {expected}");
            }
        }
    }

    #[test]
    fn between_the_points_it_is_linear_and_beyond_the_edge_constant() {
        let field = Shadow::draw([10.0, 3.5], 4.0, 5.0, &mut generator(6, 0));
        let middle = 0.5 * (field.at([2.0, 1.0]) + field.at([2.5, 1.0]));
        assert!((field.at([2.25, 1.0]) - middle).abs() < 1e-12);
        assert_eq!(field.at([-3.0, 9.0]), field.at([0.0, 3.5]));
        // A field of a single point is that point.
        let point = Shadow::draw([0.0, 0.0], 4.0, 5.0, &mut generator(6, 0));
        assert_eq!(point.at([1.0, 1.0]), point.at([0.0, 0.0]));
    }
}
