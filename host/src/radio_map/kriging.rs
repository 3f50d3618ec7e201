//! The strength of beacons between the places where they were surveyed.

use nalgebra::{DMatrix, DVector};

use super::cells::{Cells, distance};

/// A Gaussian process over the plane for each beacon: kriging with an exponential covariance, which suits shadowing, about
/// a trend that falls with the logarithm of the distance from the source, where its place is known, and is constant where
/// not. All beacons share the covariance: a single one has too few places to tell.
#[derive(Debug, Clone)]
pub(super) struct Kriging {
    places: Vec<[f64; 2]>,
    shape: Shape,
    /// Variance of the values, that of their noise among it.
    scale: f64,
    beacons: Vec<Beacon>,
    /// Inverse covariance of the values, for a scale of 1.
    inverse: DMatrix<f64>,
    /// Places that are left out together, and the inverse of their part of the inverse covariance.
    blocks: Vec<(Vec<usize>, DMatrix<f64>)>,
    /// How well they predict each block from all others: the mean logarithm of the density.
    pub score: f64,
}

#[derive(Debug, Clone)]
struct Beacon {
    source: Option<[f64; 2]>,
    trend: DVector<f64>,
    /// The inverse covariance times what is left of the values without the trend.
    weights: DVector<f64>,
}

/// What the fields of all beacons have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Distance over which the covariance falls to 1 / e, in metres.
    pub length_m: f64,
    /// Fraction of the variance that is noise of the values.
    pub noise: f64,
}

impl Shape {
    /// Of the field itself at two places, for a scale of 1.
    fn covariance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        (1.0 - self.noise) * (-distance(a, b) / self.length_m).exp()
    }
}

/// What the trend is a sum of.
fn basis(source: Option<[f64; 2]>, place: [f64; 2]) -> DVector<f64> {
    let mut basis = vec![1.0];
    // Within a metre or so the level no longer rises.
    basis.extend(source.map(|source| 5.0 * (distance(source, place).powi(2) + 1.0).log10()));
    basis.into()
}

impl Kriging {
    /// Lengths that are tried, in distances between neighbours.
    const LENGTHS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
    /// Fractions of noise that are tried.
    const NOISE: [f64; 5] = [0.02, 0.1, 0.2, 0.35, 0.5];
    /// So many shapes are tried.
    pub const SHAPES: usize = Self::LENGTHS.len() * Self::NOISE.len();

    /// The shape that predicts each block of places best from all others.
    pub fn fit(
        cells: &Cells,
        sources: &[Option<[f64; 2]>],
        blocks: &[Vec<usize>],
        mut tried: impl FnMut(),
    ) -> Option<Self> {
        let neighbour = cells.neighbour_m();
        let shapes = Self::LENGTHS.iter().flat_map(|length| {
            Self::NOISE.iter().map(move |noise| Shape {
                length_m: length * neighbour,
                noise: *noise,
            })
        });
        let mut best: Option<Self> = None;
        for shape in shapes {
            let fit = Self::with(cells, sources, shape, blocks);
            if let Some(fit) = fit
                && best.as_ref().is_none_or(|best| fit.score > best.score)
            {
                best = Some(fit);
            }
            tried();
        }
        best
    }

    /// Of this shape.
    pub fn with(
        cells: &Cells,
        sources: &[Option<[f64; 2]>],
        shape: Shape,
        blocks: &[Vec<usize>],
    ) -> Option<Self> {
        let places = &cells.places;
        let n = places.len();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j {
                shape.noise + cells.noise[i]
            } else {
                0.0
            };
            shape.covariance(places[i], places[j]) + noise
        });
        let inverse = covariance.cholesky()?.inverse();
        let blocks: Vec<(Vec<usize>, DMatrix<f64>)> = blocks
            .iter()
            .map(|block| {
                let part = DMatrix::from_fn(block.len(), block.len(), |i, j| {
                    inverse[(block[i], block[j])]
                });
                Some((block.clone(), part.cholesky()?.inverse()))
            })
            .collect::<Option<_>>()?;
        let mut beacons = Vec::new();
        let (mut count, mut squares, mut logarithms) = (0.0, 0.0, 0.0);
        for (values, source) in cells.values.iter().zip(sources) {
            let beacon = Beacon::fit(places, values, *source, &inverse)?;
            for (block, covariance) in &blocks {
                let errors = covariance * select(&beacon.weights, block);
                for (i, error) in errors.iter().enumerate() {
                    count += 1.0;
                    squares += error * error / covariance[(i, i)];
                    logarithms += covariance[(i, i)].ln();
                }
            }
            beacons.push(beacon);
        }
        // The likeliest. Values that are all the same leave no scale of their own: almost none.
        let count = f64::max(count, 1.0);
        let scale = (squares / count).max(1e-2);
        Some(Self {
            places: places.clone(),
            shape,
            scale,
            beacons,
            inverse,
            blocks,
            score: -0.5 * (scale.ln() + (logarithms + squares / scale) / count),
        })
    }

    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// The variance of the fields themselves, in dB^2: what the error is where nobody has been.
    pub fn variance(&self) -> f64 {
        self.scale * (1.0 - self.shape.noise)
    }

    fn covariances(&self, place: [f64; 2]) -> DVector<f64> {
        let to_places = self.places.iter();
        let to_places = to_places.map(|other| self.shape.covariance(place, *other));
        DVector::from_iterator(self.places.len(), to_places)
    }

    /// The mean of each beacon at a place, and the variance of that in dB^2, without the noise of a value there.
    pub fn at(&self, place: [f64; 2]) -> (Vec<f64>, f64) {
        let covariances = self.covariances(place);
        let explained = (&self.inverse * &covariances).dot(&covariances);
        let beacons = self.beacons.iter();
        let means = beacons.map(|beacon| beacon.trend(place) + covariances.dot(&beacon.weights));
        (means.collect(), self.left(explained))
    }

    /// The same by the places outside of a block.
    pub fn without(&self, block: usize, place: [f64; 2]) -> (Vec<f64>, f64) {
        let (block, inverse) = &self.blocks[block];
        let mut covariances = self.covariances(place);
        for left_out in block {
            covariances[*left_out] = 0.0;
        }
        let gains = &self.inverse * &covariances;
        let of_block = select(&gains, block);
        let corrections = inverse * &of_block;
        let explained = gains.dot(&covariances) - corrections.dot(&of_block);
        let mean = |beacon: &Beacon| {
            beacon.trend(place) + covariances.dot(&beacon.weights)
                - corrections.dot(&select(&beacon.weights, block))
        };
        (
            self.beacons.iter().map(mean).collect(),
            self.left(explained),
        )
    }

    fn left(&self, explained: f64) -> f64 {
        self.scale * (1.0 - self.shape.noise - explained).max(0.0)
    }
}

impl Beacon {
    fn fit(
        places: &[[f64; 2]],
        values: &[f64],
        source: Option<[f64; 2]>,
        inverse: &DMatrix<f64>,
    ) -> Option<Self> {
        // A slope takes three places that are not all as far away.
        let trends = [source.filter(|_| places.len() > 2), None];
        let (source, design, weighted, known) = trends.into_iter().find_map(|source| {
            let rows: Vec<_> = places
                .iter()
                .map(|place| basis(source, *place).transpose())
                .collect();
            let design = DMatrix::from_rows(&rows);
            let weighted = inverse * &design;
            let known = (design.transpose() * &weighted).try_inverse()?;
            Some((source, design, weighted, known))
        })?;
        // Generalised least squares.
        let values = DVector::from_column_slice(values);
        let trend = &known * weighted.transpose() * &values;
        let weights = inverse * (&values - &design * &trend);
        Some(Self {
            source,
            trend,
            weights,
        })
    }

    fn trend(&self, place: [f64; 2]) -> f64 {
        basis(self.source, place).dot(&self.trend)
    }
}

fn select(of: &DVector<f64>, numbers: &[usize]) -> DVector<f64> {
    DVector::from_iterator(numbers.len(), numbers.iter().map(|number| of[*number]))
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

    fn cells(places: &[[f64; 2]], value: impl Fn([f64; 2]) -> f64) -> Cells {
        Cells {
            places: places.to_vec(),
            values: vec![places.iter().map(|place| value(*place)).collect()],
            heard: vec![vec![true; places.len()]],
            noise: vec![0.0; places.len()],
            of_place: (0..places.len()).collect(),
        }
    }

    fn fit(
        places: &[[f64; 2]],
        source: Option<[f64; 2]>,
        value: impl Fn([f64; 2]) -> f64,
    ) -> Kriging {
        let cells = cells(places, value);
        Kriging::fit(&cells, &[source], &cells.blocks(), || ()).unwrap()
    }

    #[test]
    fn a_smooth_field_is_found_between_its_places_and_forgotten_far_away() {
        let truth = |[x, y]: [f64; 2]| -60.0 + 8.0 * (0.3 * x).sin() + 5.0 * (0.2 * y).cos();
        let field = fit(&lattice(10), None, truth);
        for [x, y] in lattice(9) {
            let place = [x + 1.0, y + 1.0];
            let (means, variance) = field.at(place);
            // Values 2 m around differ by up to 5.
            assert!((means[0] - truth(place)).abs() < 1.0, "{place:?} {means:?}");
            assert!(variance < 20.0, "{variance}");
        }
        let (means, variance) = field.at([1e4, 1e4]);
        assert!((means[0] - field.beacons[0].trend[0]).abs() < 1e-6);
        assert!((variance - field.variance()).abs() < 1e-6);
    }

    #[test]
    fn far_from_all_places_the_level_falls_with_the_distance() {
        let source = [5.0, 5.0];
        let truth = |place| -40.0 - 10.0 * (distance(source, place).powi(2) + 1.0).log10();
        let field = fit(&lattice(6), Some(source), truth);
        let far = [40.0, 60.0];
        assert!((field.at(far).0[0] - truth(far)).abs() < 1e-6);
    }

    #[test]
    fn one_value_is_the_field() {
        let field = fit(&[[1.0, 2.0]], Some([0.0, 0.0]), |_| -70.0);
        assert!((field.at([1.0, 2.0]).0[0] + 70.0).abs() < 1e-9);
    }

    #[test]
    fn leaving_a_block_out_is_what_it_says() {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.5, 1.0], [4.0, 0.5], [3.0, -2.0]];
        let value = |[x, y]: [f64; 2]| -50.0 - 3.0 * x + y * y;
        let shape = Shape {
            length_m: 2.0,
            noise: 0.1,
        };
        let all = cells(&places, value);
        let blocks = [vec![0, 2], vec![1], vec![3, 4]];
        let with = Kriging::with(&all, &[None], shape, &blocks).unwrap();
        for (number, block) in blocks.iter().enumerate() {
            let kept: Vec<usize> = (0..5).filter(|n| !block.contains(n)).collect();
            let kept: Vec<[f64; 2]> = kept.iter().map(|n| places[*n]).collect();
            let mut alone = Kriging::with(&cells(&kept, value), &[None], shape, &[]).unwrap();
            // The trend is that of all places.
            let trend = &with.beacons[0].trend;
            let rest: Vec<f64> = kept.iter().map(|p| value(*p) - trend[0]).collect();
            alone.beacons[0].weights = &alone.inverse * DVector::from_vec(rest);
            alone.beacons[0].trend = trend.clone();
            alone.scale = with.scale;
            for place in [[0.5, 0.5], places[block[0]]] {
                let (a, b) = (with.without(number, place), alone.at(place));
                assert!((a.0[0] - b.0[0]).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9);
            }
        }
    }
}
