//! The strength of a beacon between the places where it was surveyed.

use nalgebra::{DMatrix, DVector};

/// A Gaussian process over the plane: kriging with an exponential covariance, which suits shadowing, about a trend
/// that falls with the logarithm of the distance from the source, where its place is known, and is constant where not.
///
/// Its length and how much of the variance is noise are those that predict each place best from all others.
#[derive(Debug, Clone)]
pub struct Field {
    places: Vec<[f64; 2]>,
    source: Option<[f64; 2]>,
    length: f64,
    /// Of the field itself, without noise.
    variance: f64,
    trend: DVector<f64>,
    /// Inverse covariance of the values, and the same times what is left of the values without the trend.
    inverse: DMatrix<f64>,
    weights: DVector<f64>,
    /// By place: its value less what all others predict, the trend among it.
    left_out: Vec<f64>,
    log_score: f64,
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// What the trend is a sum of.
fn basis(source: Option<[f64; 2]>, place: [f64; 2]) -> DVector<f64> {
    let mut basis = vec![1.0];
    // Within a metre or so the level no longer rises.
    basis.extend(source.map(|source| 5.0 * (distance(source, place).powi(2) + 1.0).log10()));
    basis.into()
}

impl Field {
    /// Fits the values, one for each place, of a beacon at `source`, if that is known. `None` if there is none.
    pub fn fit(places: &[[f64; 2]], values: &[f64], source: Option<[f64; 2]>) -> Option<Self> {
        /// Lengths, in distances between neighbours.
        const LENGTHS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
        /// Shares of noise in the variance of the values.
        const NOISE: [f64; 4] = [0.02, 0.1, 0.3, 0.6];
        if places.is_empty() {
            return None;
        }
        // A slope takes three places that are not all as far away.
        let source = source.filter(|_| places.len() > 2);
        let design = design(source, places);
        let normal = (design.transpose() * &design).try_inverse();
        let (source, design, normal) = match normal {
            Some(normal) => (source, design, normal),
            None => (
                None,
                self::design(None, places),
                DMatrix::identity(1, 1) / places.len().max(1) as f64,
            ),
        };
        let y = DVector::from_column_slice(values);
        let residuals = &y - &design * (normal * design.transpose() * &y);
        // Values that are all the same leave no scale of their own: 1 dB.
        let variance = (residuals.norm_squared() / values.len() as f64).max(1.0);
        let neighbour = nearest_neighbour(places)?;
        let fits = LENGTHS.iter().flat_map(|length| {
            NOISE.iter().filter_map(move |share| {
                let [field, noise] = [variance * (1.0 - share), variance * share];
                Self::with(places, values, source, length * neighbour, field, noise)
            })
        });
        fits.max_by(|a, b| a.log_score.total_cmp(&b.log_score))
    }

    fn with(
        places: &[[f64; 2]],
        values: &[f64],
        source: Option<[f64; 2]>,
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
        let design = design(source, places);
        // Generalised least squares.
        let weighted = &inverse * &design;
        let known = (design.transpose() * &weighted).try_inverse()?;
        let trend = &known * weighted.transpose() * &values;
        let weights = &inverse * (&values - &design * &trend);
        // Predicting each place from all others, in closed form (Rasmussen and Williams 2006, eq. 5.10 to 5.12), with
        // the trend estimated from the others as well: its part is projected out of the inverse.
        let projected = &inverse - &weighted * known * weighted.transpose();
        // With no more places than the trend has summands, nothing is left to predict from.
        let free = n > trend.len();
        let precisions = (0..n).map(|i| if free { projected[(i, i)] } else { 1.0 / noise });
        let left_out: Vec<f64> = weights
            .iter()
            .zip(precisions.clone())
            .map(|(w, p)| w / p)
            .collect();
        let score =
            |(error, precision): (&f64, f64)| 0.5 * (precision.ln() - error.powi(2) * precision);
        Some(Self {
            places: places.to_vec(),
            source,
            length,
            variance,
            trend,
            log_score: left_out.iter().zip(precisions).map(score).sum(),
            inverse,
            weights,
            left_out,
        })
    }

    /// Mean and variance of the field at a place, without the noise of a value there.
    pub fn at(&self, place: [f64; 2]) -> (f64, f64) {
        let to_places = self
            .places
            .iter()
            .map(|other| self.variance * (-distance(place, *other) / self.length).exp());
        let covariance = DVector::from_iterator(self.places.len(), to_places);
        let trend = basis(self.source, place).dot(&self.trend);
        let mean = trend + covariance.dot(&self.weights);
        let explained = (&self.inverse * &covariance).dot(&covariance);
        (mean, (self.variance - explained).max(0.0))
    }

    /// By place: its value less what all others predict.
    pub fn left_out(&self) -> &[f64] {
        &self.left_out
    }
}

/// The basis at every place, by row.
fn design(source: Option<[f64; 2]>, places: &[[f64; 2]]) -> DMatrix<f64> {
    let rows: Vec<_> = places
        .iter()
        .map(|place| basis(source, *place).transpose())
        .collect();
    DMatrix::from_rows(&rows)
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
        let field = Field::fit(&places, &values, None).unwrap();
        for i in 0..81 {
            let place = [f64::from(i % 9) * 2.0 + 1.0, f64::from(i / 9) * 2.0 + 1.0];
            let (mean, variance) = field.at(place);
            // Values 2 m around differ by up to 5.
            assert!((mean - truth(place)).abs() < 1.0, "{place:?} {mean}");
            assert!(variance < 20.0, "{variance}");
        }
        let (mean, variance) = field.at([1e4, 1e4]);
        assert!((mean - field.trend[0]).abs() < 1e-6);
        assert!((variance - field.variance).abs() < 1e-6);
    }

    #[test]
    fn one_value_is_the_field() {
        let field = Field::fit(&[[1.0, 2.0]], &[-70.0], None).unwrap();
        assert!((field.at([1.0, 2.0]).0 + 70.0).abs() < 1e-9);
        assert!(Field::fit(&[], &[], None).is_none());
    }

    #[test]
    fn leaving_one_out_is_what_it_says() {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.5, 1.0], [4.0, 0.5], [3.0, -2.0]];
        let values = [-50.0, -55.0, -61.0, -58.0, -66.0];
        for source in [None, Some([-1.0, 1.0])] {
            let fit = |places: &[_], values: &[_]| {
                Field::with(places, values, source, 2.0, 16.0, 1.0).unwrap()
            };
            let field = fit(&places, &values);
            for left_out in 0..places.len() {
                let without = |n: &usize| *n != left_out;
                let others: Vec<usize> = (0..places.len()).filter(without).collect();
                let places_of: Vec<[f64; 2]> = others.iter().map(|n| places[*n]).collect();
                let values_of: Vec<f64> = others.iter().map(|n| values[*n]).collect();
                let (mean, _) = fit(&places_of, &values_of).at(places[left_out]);
                assert!((field.left_out()[left_out] - (values[left_out] - mean)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn far_from_all_places_the_level_falls_with_the_distance() {
        let source = [5.0, 5.0];
        let truth = |place| -40.0 - 10.0 * (distance(source, place).powi(2) + 1.0).log10();
        let places: Vec<[f64; 2]> = (0..36)
            .map(|i| [f64::from(i % 6) * 2.0, f64::from(i / 6) * 2.0])
            .collect();
        let values: Vec<f64> = places.iter().map(|place| truth(*place)).collect();
        let field = Field::fit(&places, &values, Some(source)).unwrap();
        let far = [40.0, 60.0];
        assert!((field.at(far).0 - truth(far)).abs() < 1e-6);
    }
}
