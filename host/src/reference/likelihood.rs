//! The likelihood of a source's place, and how large it can be anywhere in a cell.

use std::{borrow::Cow, f64::consts::PI};

use nalgebra::{DMatrix, DVector, Vector2};

use super::{
    cell::Cell,
    kept::Kept,
    line::{Line, View},
    model::{Biases, ByDirection, Model, Prior},
    scales::Scale,
    sums::{Known, Sums, Turned},
};
use foxhunt_simulation::Sight;

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
    /// What they know of biases that do not depend on the place.
    known: Known,
    by_direction: Option<ByDirection>,
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
        let by_direction = match &model.biases {
            Biases::ByDirection(one) => Some(one.clone()),
            Biases::None | Biases::Turns(_) => None,
        };
        let biased = turns.iter().any(|turns| !turns.is_empty());
        assert!(!(mixed && biased), "either a bias or outliers");
        assert!(
            by_direction.is_none() || !(mixed || biased),
            "a bias by direction alone"
        );
        let lines: Vec<Line> = (sights.iter().zip(turns))
            .map(|(sight, turns)| Line::new(sight, faults, turns))
            .collect();
        Self {
            peak: lines.iter().map(|line| line.peaks[0]).sum(),
            scales: Scale::all(model.scale_sigma, lines.len()),
            known: Known::of(lines.iter().map(|line| line.turns.as_slice())),
            lines,
            by_direction,
            mixed,
            prior: model.prior,
        }
    }

    /// At a place.
    pub fn at(&self, place: Vector2<f64>) -> f64 {
        let views = self.lines.iter().map(|line| View::of_place(line, place));
        if self.mixed {
            let views: Vec<View> = views.collect();
            return Scale::sum(&self.scales, |scale| mixed(&views, scale));
        }
        let sums = self.sums(views);
        Scale::sum(&self.scales, |scale| {
            self.normal(sums.error(scale), sums.known.determinant(scale, 0.0), scale)
        })
    }

    /// Means and covariance of the biases if the source is at a place and sigmas are as stated.
    pub fn biases(&self, place: Vector2<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let views = self.lines.iter().map(|line| View::of_place(line, place));
        let (means, covariance) = self.sums(views).biases();
        match &self.by_direction {
            Some(ByDirection { mean, root, .. }) => {
                (mean + root * means, root * covariance * root.transpose())
            }
            None => (means, covariance),
        }
    }

    /// Over the errors of all bearings.
    fn sums<'a>(&self, views: impl Iterator<Item = View<'a>>) -> Turned {
        let mut sums = Sums::default();
        for (k, view) in views.enumerate() {
            let (turns, mean) = self.turns(k, &view);
            let error = view.error + mean;
            sums.add(view.line.sigma, &turns, error, Vector2::zeros(), 0.0);
        }
        self.turned(sums)
    }

    /// How far each bias turns a bearing, in its sigma, and all of them in the mean, in radians.
    fn turns<'a>(&self, k: usize, view: &View<'a>) -> (Cow<'a, [f64]>, f64) {
        let Some(biases) = &self.by_direction else {
            return (Cow::Borrowed(&view.line.turns), 0.0);
        };
        let heading = biases.headings.get(k).copied().unwrap_or(0.0);
        let (mut turns, mean) = biases.turns(view.direction() - heading);
        turns.iter_mut().for_each(|turn| *turn /= view.line.sigma);
        (Cow::Owned(turns), mean)
    }

    /// Of all bearings.
    fn turned(&self, sums: Sums) -> Turned {
        let known = match self.by_direction {
            Some(_) => sums.known(),
            None => self.known.clone(),
        };
        sums.turned(known)
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
    /// are left out, which makes the norm no larger; of a few that turn from far left to far right within it, both are tried.
    /// A norm that is f where turns are T and errors y is at least (f - d) /
    /// (1 + D) where these are off by no more than D and d, as norms: with the biases that are best there the one at the
    /// centre is no more than d + D f larger.
    pub fn bound(&self, cell: &Cell) -> Bound {
        let radius = cell.half.norm();
        let (mut all, mut kept) = (Sums::default(), Kept::default());
        let mut folds = Vector2::zeros();
        let mut turned = 0.0;
        let largest = self.by_direction.as_ref().map(ByDirection::largest);
        let ([most, steepest], steepest_mean) = largest.unwrap_or_default();
        let mut views = Vec::with_capacity(self.lines.len());
        for (k, line) in self.lines.iter().enumerate() {
            let (view, slope, bend) = View::of_cell(line, cell);
            let (turns, mean) = self.turns(k, &view);
            all.add(line.sigma, &turns, view.error + mean, slope, bend);
            folds += view.fold() * slope.abs().add_scalar(bend);
            let turn = f64::min(2.0 * most, steepest * view.slack) / line.sigma;
            turned += turn * turn;
            if !turns.is_empty() {
                let moved = (1.0 + steepest_mean) * view.slack / line.sigma;
                kept.add(&view, turns, mean, (slope, bend), [turn, moved]);
            }
            views.push(view);
        }
        let all = self.turned(all);
        let known = self.by_direction.is_none().then_some(&self.known);
        let (patterns, changes) = (kept.patterns(known), kept.changes());
        let direct: f64 = views.iter().map(View::least).map(|z| z * z).sum();
        let highest = |scale: &Scale| {
            if self.mixed {
                return mixed(&views, scale);
            }
            let determinant = all.known.determinant(scale, turned.sqrt());
            let least = |kept: &Turned| match &self.by_direction {
                Some(_) => {
                    let [turned, moved] = changes.map(|change| change / scale.value);
                    (kept.error(scale) - moved) / (1.0 + turned)
                }
                None => {
                    let (slope, bend) = kept.slopes(scale);
                    kept.error(scale) - slope.dot(&cell.half) - 0.5 * radius * bend
                }
            };
            let norm = match &patterns[..] {
                [] if self.is_biased() => 0.0,
                [] => direct.sqrt() / scale.value,
                all => all.iter().map(least).fold(f64::INFINITY, f64::min),
            };
            self.normal(norm.max(0.0), determinant, scale)
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

    fn is_biased(&self) -> bool {
        let turned = |line: &Line| !line.turns.is_empty();
        self.by_direction.is_some() || self.lines.first().is_some_and(turned)
    }

    /// Of bearings the errors of which have this norm, in their sigmas and without what biases explain, and covariance this
    /// determinant.
    fn normal(&self, norm: f64, determinant: f64, scale: &Scale) -> f64 {
        self.peak + scale.peak - determinant - 0.5 * norm * norm
    }
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
