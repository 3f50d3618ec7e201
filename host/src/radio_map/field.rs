//! The strength of a beacon between the places where it was surveyed.

use nalgebra::{DMatrix, DVector};

/// A Gaussian process over the plane: kriging with an exponential covariance, which suits shadowing, about a trend
/// that falls with the logarithm of the distance from the source, where its place is known, and is constant where not.
#[derive(Debug, Clone)]
pub struct Field {
    places: Vec<[f64; 2]>,
    source: Option<[f64; 2]>,
    shape: Shape,
    /// Variance of the values, that of their noise among it.
    scale: f64,
    trend: DVector<f64>,
    /// Inverse covariance of the values, for a scale of 1, and the same times what is left of the values without the trend.
    inverse: DMatrix<f64>,
    weights: DVector<f64>,
    /// By place: its value less what all others predict, the trend among it; and how sure they are, for a scale of 1.
    left_out: Vec<(f64, f64)>,
}

/// Values at places, of a beacon.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// Metres.
    pub places: Vec<[f64; 2]>,
    /// One for each place.
    pub values: Vec<f64>,
    /// Where the beacon is, if that is known.
    pub source: Option<[f64; 2]>,
}

/// What fields have in common.
#[derive(Debug, Clone, Copy)]
struct Shape {
    /// Distance over which the covariance falls to 1 / e, in metres.
    length: f64,
    /// Fraction of the variance that is noise.
    noise: f64,
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

/// The basis at every place, by row.
fn design(source: Option<[f64; 2]>, places: &[[f64; 2]]) -> DMatrix<f64> {
    let rows: Vec<_> = places
        .iter()
        .map(|place| basis(source, *place).transpose())
        .collect();
    DMatrix::from_rows(&rows)
}

impl Field {
    /// Fits a field to each series; `None` for those without a place.
    ///
    /// Their length, and how much of the variance is noise, are those that predict each place best from all others, in all
    /// series together: a single one has too few places to tell.
    pub fn fit(series: &[Series]) -> Vec<Option<Self>> {
        /// Lengths, in distances between neighbours.
        const LENGTHS: [f64; 9] = [1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.0, 16.0];
        /// Fractions of noise in the variance of the values.
        const NOISE: [f64; 6] = [0.02, 0.1, 0.2, 0.33, 0.5, 0.7];
        let places: Vec<[f64; 2]> = series.iter().flat_map(|s| s.places.clone()).collect();
        let neighbour = nearest_neighbour(&places).unwrap_or(1.0);
        let shapes = LENGTHS.iter().flat_map(|length| {
            NOISE.iter().map(move |noise| Shape {
                length: length * neighbour,
                noise: *noise,
            })
        });
        let fits = shapes.map(|shape| Self::with(series, shape));
        fits.max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(Vec::new(), |(fields, _)| fields)
    }

    /// Fits a field of that shape to each series, and says how well they predict each place from all others: the logarithm
    /// of the density.
    fn with(series: &[Series], shape: Shape) -> (Vec<Option<Self>>, f64) {
        let mut fields: Vec<Option<Self>> =
            series.iter().map(|s| Self::unscaled(s, shape)).collect();
        let left_out = fields.iter().flatten().flat_map(|field| &field.left_out);
        let (mut count, mut squares, mut score) = (0.0, 0.0, 0.0);
        for (error, precision) in left_out {
            count += 1.0;
            squares += error * error * precision;
            score += 0.5 * precision.ln();
        }
        // The likeliest. Values that are all the same leave no scale of their own: almost none.
        let scale = (squares / f64::max(count, 1.0)).max(1e-6);
        for field in fields.iter_mut().flatten() {
            field.scale = scale;
        }
        (fields, score - 0.5 * (squares / scale + count * scale.ln()))
    }

    fn unscaled(series: &Series, shape: Shape) -> Option<Self> {
        let Series { places, values, .. } = series;
        let n = places.len();
        if n == 0 {
            return None;
        }
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j { shape.noise } else { 0.0 };
            shape.covariance(places[i], places[j]) + noise
        });
        let inverse = covariance.cholesky()?.inverse();
        // A slope takes three places that are not all as far away.
        let trends = [series.source.filter(|_| n > 2), None];
        let (source, design, weighted, known) = trends.into_iter().find_map(|source| {
            let design = design(source, places);
            let weighted = &inverse * &design;
            let known = (design.transpose() * &weighted).try_inverse()?;
            Some((source, design, weighted, known))
        })?;
        // Generalised least squares.
        let values = DVector::from_column_slice(values);
        let trend = &known * weighted.transpose() * &values;
        let weights = &inverse * (&values - &design * &trend);
        // Predicting each place from all others, in closed form (Rasmussen and Williams 2006, eq. 5.10 to 5.12), with
        // the trend estimated from the others as well: its part is projected out of the inverse.
        let projected = &inverse - &weighted * known * weighted.transpose();
        // With no more places than the trend has summands there is nothing to predict from.
        let predicted = if n > trend.len() { n } else { 0 };
        let left_out = (0..predicted).map(|i| {
            let precision = projected[(i, i)];
            (weights[i] / precision, precision)
        });
        Some(Self {
            left_out: left_out.collect(),
            places: places.clone(),
            source,
            shape,
            scale: 1.0,
            trend,
            inverse,
            weights,
        })
    }

    /// Mean and variance of the field at a place, without the noise of a value there.
    pub fn at(&self, place: [f64; 2]) -> (f64, f64) {
        let to_places = self.places.iter();
        let to_places = to_places.map(|other| self.shape.covariance(place, *other));
        let covariance = DVector::from_iterator(self.places.len(), to_places);
        let trend = basis(self.source, place).dot(&self.trend);
        let mean = trend + covariance.dot(&self.weights);
        let explained = (&self.inverse * &covariance).dot(&covariance);
        let variance = 1.0 - self.shape.noise - explained;
        (mean, self.scale * variance.max(0.0))
    }

    /// By place: its value less what all others predict. Of none, if there are too few.
    pub fn left_out(&self) -> impl Iterator<Item = f64> {
        self.left_out.iter().map(|(error, _)| *error)
    }
}

impl Shape {
    /// Of the field itself at two places, for a scale of 1.
    fn covariance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        (1.0 - self.noise) * (-distance(a, b) / self.length).exp()
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

    fn lattice(side: u8) -> Vec<[f64; 2]> {
        let coordinates = move |i| f64::from(i) * 2.0;
        (0..side)
            .flat_map(|x| (0..side).map(move |y| [coordinates(x), coordinates(y)]))
            .collect()
    }

    fn fit(
        places: &[[f64; 2]],
        source: Option<[f64; 2]>,
        value: impl Fn([f64; 2]) -> f64,
    ) -> Field {
        let series = Series {
            places: places.to_vec(),
            values: places.iter().map(|place| value(*place)).collect(),
            source,
        };
        Field::fit(&[series]).remove(0).unwrap()
    }

    #[test]
    fn a_smooth_field_is_found_between_its_places_and_forgotten_far_away() {
        let truth = |[x, y]: [f64; 2]| -60.0 + 8.0 * (0.3 * x).sin() + 5.0 * (0.2 * y).cos();
        let field = fit(&lattice(10), None, truth);
        for [x, y] in lattice(9) {
            let place = [x + 1.0, y + 1.0];
            let (mean, variance) = field.at(place);
            // Values 2 m around differ by up to 5.
            assert!((mean - truth(place)).abs() < 1.0, "{place:?} {mean}");
            assert!(variance < 20.0, "{variance}");
        }
        let (mean, variance) = field.at([1e4, 1e4]);
        assert!((mean - field.trend[0]).abs() < 1e-6);
        assert!((variance - field.scale * (1.0 - field.shape.noise)).abs() < 1e-6);
    }

    #[test]
    fn far_from_all_places_the_level_falls_with_the_distance() {
        let source = [5.0, 5.0];
        let truth = |place| -40.0 - 10.0 * (distance(source, place).powi(2) + 1.0).log10();
        let field = fit(&lattice(6), Some(source), truth);
        let far = [40.0, 60.0];
        assert!((field.at(far).0 - truth(far)).abs() < 1e-6);
    }

    #[test]
    fn one_value_is_the_field() {
        let field = fit(&[[1.0, 2.0]], Some([0.0, 0.0]), |_| -70.0);
        assert!((field.at([1.0, 2.0]).0 + 70.0).abs() < 1e-9);
        assert!(Field::fit(&[Series::default()]).iter().all(Option::is_none));
        assert!(Field::fit(&[]).is_empty());
    }

    #[test]
    fn leaving_one_out_is_what_it_says() {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.5, 1.0], [4.0, 0.5], [3.0, -2.0]];
        let values = [-50.0, -55.0, -61.0, -58.0, -66.0];
        let shape = Shape {
            length: 2.0,
            noise: 0.1,
        };
        for source in [None, Some([-1.0, 1.0])] {
            let of = |numbers: &[usize]| Series {
                places: numbers.iter().map(|n| places[*n]).collect(),
                values: numbers.iter().map(|n| values[*n]).collect(),
                source,
            };
            let all = Field::unscaled(&of(&[0, 1, 2, 3, 4]), shape).unwrap();
            for (left_out, error) in all.left_out().enumerate() {
                let others: Vec<usize> = (0..5).filter(|n| *n != left_out).collect();
                let (mean, _) = Field::unscaled(&of(&others), shape)
                    .unwrap()
                    .at(places[left_out]);
                assert!((error - (values[left_out] - mean)).abs() < 1e-9);
            }
        }
    }
}
