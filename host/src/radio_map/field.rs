//! The strength of a beacon between the places where it was surveyed.

use nalgebra::{DMatrix, DVector};

/// A Gaussian process over the plane: ordinary kriging with an exponential covariance, which suits shadowing.
///
/// Its length and how much of the variance is noise are those that predict each place best from all others.
#[derive(Debug, Clone)]
pub struct Field {
    places: Vec<[f64; 2]>,
    length: f64,
    /// Of the field itself, without noise.
    variance: f64,
    trend: f64,
    /// Inverse covariance of the values, and the same times what is left of the values without the trend.
    inverse: DMatrix<f64>,
    weights: DVector<f64>,
    log_score: f64,
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Field {
    /// Fits the values, one for each place. `None` if there is none.
    pub fn fit(places: &[[f64; 2]], values: &[f64]) -> Option<Self> {
        /// Lengths, in distances between neighbours.
        const LENGTHS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
        /// Shares of noise in the variance of the values.
        const NOISE: [f64; 4] = [0.02, 0.1, 0.3, 0.6];
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        // Values that are all the same leave no scale of their own: 1 dB.
        let variance = (squares / n).max(1.0);
        let neighbour = nearest_neighbour(places)?;
        let fits = LENGTHS.iter().flat_map(|length| {
            NOISE.iter().filter_map(move |share| {
                let [field, noise] = [variance * (1.0 - share), variance * share];
                Self::with(places, values, length * neighbour, field, noise)
            })
        });
        fits.max_by(|a, b| a.log_score.total_cmp(&b.log_score))
    }

    fn with(
        places: &[[f64; 2]],
        values: &[f64],
        length: f64,
        variance: f64,
        noise: f64,
    ) -> Option<Self> {
        let n = places.len();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j { noise } else { 0.0 };
            variance * (-distance(places[i], places[j]) / length).exp() + noise
        });
        let inverse = covariance.cholesky()?.inverse();
        let values = DVector::from_column_slice(values);
        let trend = (&inverse * &values).sum() / inverse.sum();
        let weights = &inverse * values.add_scalar(-trend);
        // Predicting each place from all others, in closed form (Rasmussen and Williams 2006, eq. 5.10 to 5.12).
        let score = |i: usize| {
            let precision = inverse[(i, i)];
            0.5 * (precision.ln() - weights[i].powi(2) / precision)
        };
        Some(Self {
            places: places.to_vec(),
            length,
            variance,
            trend,
            log_score: (0..n).map(score).sum(),
            inverse,
            weights,
        })
    }

    /// Mean and variance of the field at a place, without the noise of a value there.
    pub fn at(&self, place: [f64; 2]) -> (f64, f64) {
        let to_places = self
            .places
            .iter()
            .map(|other| self.variance * (-distance(place, *other) / self.length).exp());
        let covariance = DVector::from_iterator(self.places.len(), to_places);
        let mean = self.trend + covariance.dot(&self.weights);
        let explained = (&self.inverse * &covariance).dot(&covariance);
        (mean, (self.variance - explained).max(0.0))
    }
}

/// The median distance of a place to the next one, in metres; 1 for a single place, `None` for none.
pub fn nearest_neighbour(places: &[[f64; 2]]) -> Option<f64> {
    let nearest = |place: &[f64; 2]| {
        let others = places.iter().map(|other| distance(*place, *other));
        others.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = places.iter().map(nearest).collect();
    distances.sort_by(f64::total_cmp);
    let median = *distances.get(distances.len() / 2)?;
    Some(if median.is_finite() { median } else { 1.0 })
}

/// The index of the nearest place and how far away it is.
pub fn nearest(places: &[[f64; 2]], place: [f64; 2]) -> Option<(usize, f64)> {
    let distances = places.iter().map(|other| distance(*other, place));
    distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_field_is_found_between_its_places_and_forgotten_far_away() {
        let truth = |[x, y]: [f64; 2]| -60.0 + 8.0 * (0.3 * x).sin() + 5.0 * (0.2 * y).cos();
        let places: Vec<[f64; 2]> = (0..100)
            .map(|i| [f64::from(i % 10) * 2.0, f64::from(i / 10) * 2.0])
            .collect();
        let values: Vec<f64> = places.iter().map(|place| truth(*place)).collect();
        let field = Field::fit(&places, &values).unwrap();
        for i in 0..81 {
            let place = [f64::from(i % 9) * 2.0 + 1.0, f64::from(i / 9) * 2.0 + 1.0];
            let (mean, variance) = field.at(place);
            // Values 2 m around differ by up to 5.
            assert!((mean - truth(place)).abs() < 1.0, "{place:?} {mean}");
            assert!(variance < 20.0, "{variance}");
        }
        let (mean, variance) = field.at([1e4, 1e4]);
        assert!((mean - field.trend).abs() < 1e-6);
        assert!((variance - field.variance).abs() < 1e-6);
    }

    #[test]
    fn one_value_is_the_field() {
        let field = Field::fit(&[[1.0, 2.0]], &[-70.0]).unwrap();
        assert!((field.at([1.0, 2.0]).0 + 70.0).abs() < 1e-9);
        assert!(Field::fit(&[], &[]).is_none());
    }

    #[test]
    fn leaving_one_out_is_what_it_says() {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.5, 1.0], [4.0, 0.5]];
        let values = [-50.0, -55.0, -61.0, -58.0];
        let field = Field::with(&places, &values, 2.0, 16.0, 1.0).unwrap();
        // With the same trend, from the three others.
        let mut score = 0.0;
        for left_out in 0..4 {
            let others: Vec<usize> = (0..4).filter(|i| *i != left_out).collect();
            let k = |a: usize, b: usize| 16.0 * (-distance(places[a], places[b]) / 2.0).exp();
            let inner = DMatrix::from_fn(3, 3, |i, j| {
                k(others[i], others[j]) + if i == j { 1.0 } else { 0.0 }
            });
            let to = DVector::from_fn(3, |i, _| k(others[i], left_out));
            let rest = DVector::from_fn(3, |i, _| values[others[i]] - field.trend);
            let inverse = inner.try_inverse().unwrap();
            let mean = field.trend + (&inverse * rest).dot(&to);
            let variance = 17.0 - (&inverse * &to).dot(&to);
            score -= 0.5 * (variance.ln() + (values[left_out] - mean).powi(2) / variance);
        }
        assert!((field.log_score - score).abs() < 1e-9);
    }
}
