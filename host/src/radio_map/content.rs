//! What a map says of its points, before it is rounded to bytes.

use foxhunt::fingerprint::Lattice;
use foxhunt_simulation::random::{generator, normal};

use super::{
    cells::{Cells, nearest},
    kriging::Kriging,
    recipe::{Choices, Recipe},
    site::SiteSurvey,
};

/// What a map says of its points.
pub(super) struct Content {
    pub lattice: Lattice,
    /// By point, the mean of every beacon in dBm, and the standard deviation of the error of that in dB.
    pub points: Vec<(Vec<f64>, f64)>,
    /// By point: whether a tag can be there.
    pub possible: Vec<bool>,
    /// By point, then by beacon: whether it was heard in the cell nearest to it.
    pub heard: Vec<Vec<bool>>,
}

impl Content {
    pub fn new(
        survey: &SiteSurvey,
        lattice: &Lattice,
        (cells, kriging): (&Cells, &Kriging),
        choices: &Choices,
        recipe: &Recipe,
    ) -> Self {
        let place = |point| lattice.position(point).map(f64::from);
        let point = |point| {
            let (means, variance) = kriging.at(place(point));
            (means, (variance + choices.sigma_db.powi(2)).sqrt())
        };
        let near = |point| {
            recipe.reach_m.is_none_or(|reach| {
                nearest(&survey.survey().places, place(point)).is_some_and(|(_, d)| d <= reach)
            })
        };
        let heard = |point| {
            let cell = nearest(&cells.places, place(point)).map_or(0, |(cell, _)| cell);
            cells.heard.iter().map(|heard| heard[cell]).collect()
        };
        Self {
            lattice: *lattice,
            points: (0..lattice.points()).map(point).collect(),
            possible: (0..lattice.points()).map(near).collect(),
            heard: (0..lattice.points()).map(heard).collect(),
        }
    }

    /// Where a point is.
    pub fn place(&self, point: usize) -> [f64; 2] {
        self.lattice.position(point).map(f64::from)
    }

    /// By point: the root mean square error of a look there, in metres, whose levels have this variance.
    pub fn look(&self, variance: f64) -> Vec<f64> {
        /// Points that are looked at: of a large map not all.
        const MOST: usize = 1024;
        let points = self.points.len();
        let every = points.div_ceil(MOST);
        let mut errors = vec![0.0; points];
        for point in (0..points).step_by(every) {
            let (levels, sigma) = &self.points[point];
            let levels: Vec<Option<f64>> = levels.iter().map(|level| Some(*level)).collect();
            let weights = posterior(&self.lattice, &levels, |other| {
                let (means, of_other) = &self.points[other];
                // Each of both may be wrong.
                (
                    means.clone(),
                    0.5 * (sigma * sigma + of_other * of_other) + variance,
                )
            });
            let [x, y] = self.place(point);
            let square = weights.iter().enumerate().map(|(other, weight)| {
                let [px, py] = self.place(other);
                weight * ((px - x).powi(2) + (py - y).powi(2))
            });
            let error = square.sum::<f64>().sqrt();
            for near in errors.iter_mut().skip(point).take(every) {
                *near = error;
            }
        }
        errors
    }

    /// The root mean square error of looks without noise, in metres, where tags can be: at levels that are wrong as the map is
    /// expected to be.
    pub fn at_rest(&self) -> f64 {
        /// Looks, of which each takes time in proportion to the points.
        const LOOKS: usize = 1024;
        let places: Vec<usize> = (0..self.points.len())
            .filter(|point| self.possible[*point])
            .collect();
        let Some(most) = places.len().checked_sub(1) else {
            return 0.0;
        };
        let mut rng = generator(0, 0);
        let mut squares = 0.0;
        for look in 0..LOOKS {
            let point = places[(look as f64 / LOOKS as f64 * most as f64).round() as usize];
            let (means, sigma) = &self.points[point];
            let levels: Vec<Option<f64>> = (means.iter().zip(&self.heard[point]))
                .map(|(mean, heard)| heard.then(|| mean + sigma * normal(&mut rng)))
                .collect();
            let weights = posterior(&self.lattice, &levels, |other| {
                let (means, sigma) = &self.points[other];
                (means.clone(), sigma * sigma)
            });
            squares += self.variance(&places, &weights);
        }
        (squares / LOOKS as f64).sqrt()
    }

    /// The variance of places that have these weights, by point, in square metres.
    fn variance(&self, places: &[usize], weights: &[f64]) -> f64 {
        let mut sums = [0.0; 4];
        for point in places {
            let (weight, [x, y]) = (weights[*point], self.place(*point));
            let terms = [1.0, x, y, x * x + y * y];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += weight * term;
            }
        }
        let [total, x, y, squares] = sums;
        (squares - (x * x + y * y) / total) / total
    }
}

/// The posterior of a look over the points, by the levels that were heard; `point` tells the means there and the variance of
/// their differences.
pub(super) fn posterior(
    lattice: &Lattice,
    levels: &[Option<f64>],
    point: impl Fn(usize) -> (Vec<f64>, f64),
) -> Vec<f64> {
    let cost = |number: usize| {
        let (means, variance) = point(number);
        let pairs = levels.iter().zip(&means);
        let heard = pairs.filter_map(|(level, mean)| Some(((*level)? - mean).powi(2)));
        let (count, squares) = heard.fold((0.0, 0.0), |(n, sum), square| (n + 1.0, sum + square));
        squares / variance + count * variance.ln()
    };
    let costs: Vec<f64> = (0..lattice.points()).map(cost).collect();
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let weights: Vec<f64> = costs.iter().map(|c| (-0.5 * (c - least)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}
