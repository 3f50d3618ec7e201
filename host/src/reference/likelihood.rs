//! The likelihood of a source's place, and how large it can be anywhere in a cell.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Vector2};

use super::{
    cell::Cell,
    line::{Line, View},
    model::{Model, Prior},
    scales::Scale,
    sums::Sums,
};
use crate::Sight;

/// What holds everywhere in a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// The logarithm of likelihood times prior is nowhere larger.
    pub log: f64,
    /// Along either axis, a normal density of these bearings curves down by no more than this, per square metre: the sum of
    /// the squares of the largest slopes of the directions, each in the sigmas of its bearing. A jump of the slope counts as
    /// if it were spread over half of the cell. Where the scale of the sigmas is not known, it is the mean over the scales,
    /// each as likely as its bound says.
    pub curvature: Vector2<f64>,
}

/// The log-likelihood of all bearings, and the prior.
#[derive(Debug, Clone)]
pub(super) struct Likelihood {
    lines: Vec<Line>,
    scales: Vec<Scale>,
    /// The biases that the lines know of independently, as columns.
    turned: DMatrix<f64>,
    /// Whether each bearing may be direct, mirrored or an outlier.
    mixed: bool,
    /// Of bearings without errors, at scale one and without biases.
    peak: f64,
    prior: Prior,
}

impl Likelihood {
    /// # Panics
    /// If there are both a bias and outliers or mirrored bearings.
    pub fn new(sights: &[Sight], model: &Model) -> Self {
        let faults = &model.faults;
        let mixed = faults.outlier_rate + faults.mirrored_rate > 0.0;
        let turns = model.turns(sights.len());
        let count = turns.first().map_or(0, Vec::len);
        assert!(!(mixed && count > 0), "either a bias or outliers");
        let mut lines: Vec<Line> = (sights.iter().zip(turns))
            .map(|(sight, turns)| Line::new(sight, faults, turns))
            .collect();
        let (known, turned) = Sums::turned(&mut lines, count);
        Self {
            peak: lines.iter().map(|line| line.peaks[0]).sum(),
            scales: Scale::all(model.scale_sigma, lines.len(), &known),
            lines,
            turned,
            mixed,
            prior: model.prior,
        }
    }

    /// At a place.
    pub fn at(&self, place: Vector2<f64>) -> f64 {
        let views = self.lines.iter().map(|line| View::of_place(line, place));
        let views: Vec<View> = views.collect();
        if self.mixed {
            return Scale::sum(&self.scales, |scale| mixed(&views, scale));
        }
        let sums = errors(&views);
        Scale::sum(&self.scales, |scale| {
            self.normal(sums.error(scale).sqrt(), scale)
        })
    }

    /// Means and covariance of the biases if the source is at a place and sigmas are as stated.
    pub fn biases(&self, place: Vector2<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let views = self.lines.iter().map(|line| View::of_place(line, place));
        let sums = errors(&views.collect::<Vec<View>>());
        let Some(scale) = self.scales.get(self.scales.len() / 2) else {
            return (DVector::zeros(0), DMatrix::zeros(0, 0));
        };
        let variances = scale.known.iter().map(|known| 1.0 / (1.0 + known));
        let variances = DVector::from_iterator(scale.known.len(), variances);
        let covariance = DMatrix::from_diagonal(&variances);
        (
            &self.turned * sums.biases(scale),
            &self.turned * covariance * self.turned.transpose(),
        )
    }

    /// With the prior.
    pub fn with_prior(&self, place: Vector2<f64>) -> f64 {
        self.at(place) + self.prior.log(place)
    }

    /// In a cell.
    ///
    /// From a bearing's position the cell appears within an interval of directions: the bearing is nowhere in the cell more
    /// likely than at the direction of the interval that suits it best. The bound lets each bearing have a place of its own,
    /// and each scale its own places.
    ///
    /// If there are biases the bound is one on the norm of the errors, each in its sigma and without what the biases explain:
    /// that of the centre, less that of the largest difference from it. Bearings that any direction in the cell would suit
    /// are left out, which makes the norm no larger.
    pub fn bound(&self, cell: &Cell) -> Bound {
        let radius = cell.half.norm();
        let mut all = Sums::default();
        let mut kept = Sums::default();
        let mut folds = Vector2::zeros();
        let mut views = Vec::with_capacity(self.lines.len());
        for line in &self.lines {
            let (view, slope, bend) = View::of_cell(line, cell);
            all.add(line, view.error, slope, bend);
            folds += view.fold() * slope.abs().add_scalar(bend);
            if !line.turns.is_empty() && view.says_something() {
                kept.add(line, view.error, slope, bend);
            }
            views.push(view);
        }
        let biased = self.lines.first().is_some_and(|l| !l.turns.is_empty());
        kept.turn(views.len());
        let direct: f64 = views.iter().map(View::least).map(|z| z * z).sum();
        let highest = |scale: &Scale| {
            if self.mixed {
                mixed(&views, scale)
            } else if biased {
                let (slope, bend) = kept.slopes(scale);
                let change = slope.dot(&cell.half) + 0.5 * radius * bend;
                let norm = kept.error(scale).sqrt() - change;
                self.normal(norm.max(0.0), scale)
            } else {
                self.normal(direct.sqrt() / scale.value, scale)
            }
        };
        let (log, probabilities) = Scale::bound(&self.scales, highest);
        let curvature = |scale: &Scale| {
            let (slope, bend) = all.slopes(scale);
            slope.map(|slope| (slope + bend).powi(2))
                + folds.component_div(&cell.half) / scale.value.powi(2)
        };
        let likely = self.scales.iter().zip(probabilities);
        let likely = likely.filter(|(_, probability)| *probability > 1e-9);
        let mean: Vector2<f64> = likely.map(|(scale, p)| curvature(scale) * p).sum();
        let (highest, bend) = self.prior.bound(cell);
        Bound {
            log: log + highest,
            curvature: mean.add_scalar(bend),
        }
    }

    /// Of bearings the errors of which have this norm, in their sigmas and without what biases explain.
    fn normal(&self, norm: f64, scale: &Scale) -> f64 {
        self.peak + scale.peak - 0.5 * norm * norm
    }
}

/// Sums over the errors of all bearings.
fn errors(views: &[View<'_>]) -> Sums {
    let mut sums = Sums::default();
    for view in views {
        sums.add(view.line, view.error, Vector2::zeros(), 0.0);
    }
    sums
}

/// Of bearings each of which is direct, mirrored or an outlier.
fn mixed(views: &[View<'_>], scale: &Scale) -> f64 {
    let (mut log, mut product) = (0.0, 1.0);
    for view in views {
        let least = view.least() / scale.value;
        let behind = (PI - view.error.abs() - view.slack).max(0.0);
        let from_behind = behind / (view.line.sigma * scale.value);
        let [direct, mirrored, outlier] = view.line.peaks;
        let logs = [
            direct - scale.log - 0.5 * least * least,
            mirrored - scale.log - 0.5 * from_behind * from_behind,
            outlier,
        ];
        let best = logs[0].max(logs[1]).max(logs[2]);
        log += best;
        // The best is a factor of one, and what is far below it none.
        product *= (logs.iter())
            .map(|log| log - best)
            .map(|log| if log > -40.0 { log.exp() } else { 0.0 })
            .sum::<f64>();
        if product > 1e200 {
            log += product.ln();
            product = 1.0;
        }
    }
    log + product.ln()
}
