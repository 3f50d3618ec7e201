//! The exact posterior of a source that stands still.

use std::collections::BinaryHeap;

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::{
    cell::Cell,
    likelihood::Likelihood,
    model::{Biases, Model, Prior},
    pending::Pending,
};
use foxhunt_simulation::{Sight, faults::Faults, sight::direction};

/// The posterior of the place of the source given all bearings, within a square.
///
/// The square is halved, and halved again, always the part that could hold the most: a bound on the likelihood that holds
/// everywhere in it, times its area. Parts that are small beside the likelihood's own scale are summed, by three by
/// three nodes of Gauss and Legendre. It ends when all that is left could hold no more than a millionth of what is
/// summed. So nothing is overlooked, however narrow it is.
///
/// What errs is the sum: a part is no wider than 1.5 standard deviations of the narrowest normal density that these bearings
/// can have there, nor so wide that its density changes by a factor of more than about 30. Beside uniform
/// grids, means on the tracks and in rooms are right to 1e-3 standard deviations, and these to 0.2 % (`cargo xtask papers
/// reference`).
#[derive(Debug, Clone)]
pub struct Posterior {
    /// In metres east and north.
    pub mean: [f64; 2],
    /// In square metres.
    pub covariance: Matrix2<f64>,
    /// The most likely place, in metres east and north.
    pub mode: [f64; 2],
    /// Logarithm of the density of the bearings, each in 1/rad, if the source is anywhere in the square, or with the prior's
    /// density there.
    pub log_evidence: f64,
    /// The most that the parts of the square that were not summed can hold, as a fraction of the whole.
    pub discarded: f64,
    square: Square,
    likelihood: Likelihood,
    sum: Sum,
}

/// Parts that together hold less than this fraction of the whole are not summed.
const DISCARDED: f64 = 1e-6;
/// Widest cell that is summed, in standard deviations of a normal density.
const WIDEST: f64 = 1.5;
/// Places of the nodes, in half sides of a cell, and their weights.
const NODES: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0),
];
/// Most that the log-likelihood may change between the outer nodes of a cell that is summed: what is cut off by the square's
/// side, or ends at a position, is no normal density.
const STEEPEST: f64 = 3.0;
/// So many cells are too many.
const MOST: usize = 4_000_000;

impl Posterior {
    /// From clean `sights`; `None` if they do not determine a place within eight times the extent of the receivers.
    pub fn new(sights: &[Sight]) -> Option<Self> {
        Self::with_faults(sights, &Faults::default())
    }

    /// The posterior where the rates of outliers and mirrored bearings are those of `faults`, or where all bearings have a
    /// bias of its sigma: these are known, what each bearing is and what the bias is are not. `None` if the `sights`
    /// do not determine a place within eight times the extent of the receivers.
    ///
    /// # Panics
    /// If `faults` has both: then the sum would be one over the bias, too.
    pub fn with_faults(sights: &[Sight], faults: &Faults) -> Option<Self> {
        let model = Model::with_faults(faults);
        Self::within(&Square::round(sights)?, sights, &model).filter(Self::lies_inside)
    }

    /// The posterior by the `model` of a source that is in the `square` for certain, whether the `sights` determine its place
    /// or not. `None` if that takes more than four million cells.
    ///
    /// # Panics
    /// As [`Posterior::with_faults`], or if there are biases of another number of bearings.
    pub fn within(square: &Square, sights: &[Sight], model: &Model) -> Option<Self> {
        let likelihood = Likelihood::new(sights, model);
        let (sum, discarded) = integrate(square, &likelihood)?;
        Some(Self::of(square, model, likelihood, sum, discarded))
    }

    fn of(
        square: &Square,
        model: &Model,
        likelihood: Likelihood,
        sum: Sum,
        discarded: f64,
    ) -> Self {
        let flat = match model.prior {
            Prior::Flat => 2.0 * square.side.ln(),
            Prior::Ranged { .. } => 0.0,
        };
        let mean = sum.mean();
        Self {
            mean: mean.into(),
            covariance: sum.covariance(mean),
            mode: climb(square, &likelihood, &sum).into(),
            log_evidence: sum.log() - flat,
            discarded,
            square: *square,
            likelihood,
            sum,
        }
    }

    /// The same, sooner by far where a bias goes by direction: the places that are summed are those of a posterior whose biases
    /// are as if the source were where one with the measured directions has it. Nothing bounds what is left out; but these
    /// posteriors are nearly the same (a test compares it with that of the bound).
    pub fn within_nearly(square: &Square, sights: &[Sight], model: &Model) -> Option<Self> {
        let Biases::ByDirection(biases) = &model.biases else {
            return Self::within(square, sights, model);
        };
        let mut directions: Vec<f64> = sights.iter().map(|sight| sight.bearing).collect();
        let mut last = None;
        for _ in 0..2 {
            let (turned, turns) = biases.as_if(sights, &directions);
            let model = Model {
                biases: turns,
                ..model.clone()
            };
            let posterior = Self::within(square, &turned, &model)?;
            let towards = |sight: &Sight| direction(sight.position, posterior.mean);
            directions = sights.iter().map(towards).collect();
            last = Some(posterior);
        }
        let Self {
            sum,
            likelihood: before,
            discarded,
            ..
        } = last?;
        let likelihood = Likelihood::new(sights, model);
        let sum = sum.changed(|place| likelihood.at(place) - before.at(place));
        Some(Self::of(square, model, likelihood, sum, discarded))
    }

    /// Logarithm of the density of the bearings, each in 1/rad, if the source is at this place.
    pub fn log_likelihood(&self, place: [f64; 2]) -> f64 {
        self.likelihood.at(place.into())
    }

    /// The density at a place, per square metre.
    pub fn density(&self, place: [f64; 2]) -> f64 {
        let offset = Vector2::from(place) - Vector2::from(self.square.centre);
        if offset.amax() > 0.5 * self.square.side {
            return 0.0;
        }
        (self.likelihood.with_prior(place.into()) - self.sum.log()).exp()
    }

    /// Means and covariance of the biases of the model, that of the faults last, where sigmas are as stated.
    pub fn biases(&self) -> (DVector<f64>, DMatrix<f64>) {
        let places = || self.sum.weighted().filter(|(_, weight)| *weight > 1e-7);
        let mean = |(place, weight)| self.likelihood.biases(place).0 * weight;
        let mean: DVector<f64> = places().map(mean).reduce(|a, b| a + b).unwrap_or_default();
        let covariance = |(place, weight)| {
            let (at, covariance) = self.likelihood.biases(place);
            let off = at - &mean;
            (covariance + &off * off.transpose()) * weight
        };
        let covariance = places().map(covariance).reduce(|a, b| a + b);
        (mean, covariance.unwrap_or_default())
    }

    /// Four standard deviations round the mean are within the square.
    fn lies_inside(&self) -> bool {
        let offset = Vector2::from(self.mean) - Vector2::from(self.square.centre);
        (0..2).all(|d| {
            offset[d].abs() + 4.0 * self.covariance[(d, d)].sqrt() < self.square.side / 2.0
        })
    }
}

/// Where a source may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Square {
    /// In metres east and north.
    pub centre: [f64; 2],
    /// In metres.
    pub side: f64,
}

impl Square {
    /// Eight times as wide as the diagonal of the box round the receivers; `None` if they are all at one place.
    pub fn round(sights: &[Sight]) -> Option<Self> {
        let mut low = Vector2::from(sights.first()?.position);
        let mut high = low;
        for sight in sights {
            let place = Vector2::from(sight.position);
            low = low.inf(&place);
            high = high.sup(&place);
        }
        let side = 8.0 * (high - low).norm();
        let centre = ((low + high) / 2.0).into();
        (side > 0.0).then_some(Self { centre, side })
    }
}

/// The nodes that are summed.
#[derive(Debug, Clone, Default)]
struct Sum {
    places: Vec<Vector2<f64>>,
    /// Logarithms of likelihood times area.
    logs: Vec<f64>,
    /// The largest of them, and the sum in its unit.
    best: f64,
    total: f64,
}

/// Sums all but what a millionth says; and says what the rest is at most.
fn integrate(square: &Square, likelihood: &Likelihood) -> Option<(Sum, f64)> {
    let whole = Cell {
        centre: square.centre.into(),
        half: Vector2::repeat(square.side / 2.0),
    };
    let mut sum = Sum {
        best: f64::NEG_INFINITY,
        ..Sum::default()
    };
    let mut heap = BinaryHeap::from([Pending::new(whole, likelihood)]);
    for _ in 0..MOST {
        let Some(largest) = heap.pop() else {
            return Some((sum, 0.0));
        };
        // No other cell can hold more than this one.
        let rest = largest.log_mass + (heap.len() as f64 + 1.0).ln() - sum.log();
        if rest <= DISCARDED.ln() {
            return Some((sum, rest.exp()));
        }
        let Pending { cell, widths, .. } = largest;
        let axis = if widths.max() > WIDEST {
            widths.imax()
        } else {
            let nodes = Nodes::new(&cell, likelihood);
            let change = nodes.change();
            if change.max() <= STEEPEST {
                sum.add(&nodes);
                continue;
            }
            change.imax()
        };
        heap.extend(cell.split(axis).map(|part| Pending::new(part, likelihood)));
    }
    None
}

/// The nodes of a cell, column by column.
struct Nodes {
    places: [Vector2<f64>; 9],
    /// The log-likelihood there.
    logs: [f64; 9],
    /// Parts of the cell's area.
    areas: [f64; 9],
}

impl Nodes {
    fn new(cell: &Cell, likelihood: &Likelihood) -> Self {
        let pairs: [_; 9] = std::array::from_fn(|k| [NODES[k / 3], NODES[k % 3]]);
        let places = pairs
            .map(|[(x, _), (y, _)]| cell.centre + cell.half.component_mul(&Vector2::new(x, y)));
        Self {
            places,
            logs: places.map(|place| likelihood.with_prior(place)),
            areas: pairs.map(|[(_, across), (_, along)]| cell.area() * across * along),
        }
    }

    /// How much the log-likelihood changes along each axis through the middle.
    fn change(&self) -> Vector2<f64> {
        let [_, west, _, south, _, north, _, east, _] = self.logs;
        Vector2::new(east - west, north - south).abs()
    }
}

impl Sum {
    fn add(&mut self, nodes: &Nodes) {
        for ((place, log), area) in nodes.places.iter().zip(nodes.logs).zip(nodes.areas) {
            let log = log + area.ln();
            if log > self.best {
                self.total *= (self.best - log).exp();
                self.best = log;
            }
            self.total += (log - self.best).exp();
            self.places.push(*place);
            self.logs.push(log);
        }
    }

    /// With this added to the log-likelihood of each place.
    fn changed(mut self, by: impl Fn(Vector2<f64>) -> f64) -> Self {
        for (log, place) in self.logs.iter_mut().zip(&self.places) {
            // What was next to nothing stays so.
            if *log > self.best - 40.0 {
                *log += by(*place);
            }
        }
        self.best = self.logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.total = self.logs.iter().map(|log| (log - self.best).exp()).sum();
        self
    }

    /// Logarithm of the sum.
    fn log(&self) -> f64 {
        self.best + self.total.ln()
    }

    /// Each place with its probability.
    fn weighted(&self) -> impl Iterator<Item = (Vector2<f64>, f64)> {
        let log = self.log();
        let weights = self.logs.iter().map(move |l| (l - log).exp());
        self.places.iter().copied().zip(weights)
    }

    fn mean(&self) -> Vector2<f64> {
        self.weighted().map(|(place, weight)| place * weight).sum()
    }

    fn covariance(&self, mean: Vector2<f64>) -> Matrix2<f64> {
        self.weighted()
            .map(|(place, weight)| (place - mean) * (place - mean).transpose() * weight)
            .sum()
    }
}

/// The maximum that is reached from the most likely node, by steps along the axes that get shorter.
fn climb(square: &Square, likelihood: &Likelihood, sum: &Sum) -> Vector2<f64> {
    let highest = |places: &[Vector2<f64>]| {
        let logs = places
            .iter()
            .map(|place| (likelihood.with_prior(*place), *place));
        logs.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((mut log, mut place)) = highest(&sum.places) else {
        return square.centre.into();
    };
    let corners =
        [-0.5, 0.5].map(|half| Vector2::from(square.centre).add_scalar(half * square.side));
    let mut step = square.side / 1024.0;
    while step > 1e-9 * square.side {
        let steps = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
        let around = steps.map(|s| (place + Vector2::from(s)).sup(&corners[0]).inf(&corners[1]));
        match highest(&around) {
            Some((higher, next)) if higher > log => (log, place) = (higher, next),
            _ => step *= 0.5,
        }
    }
    place
}
