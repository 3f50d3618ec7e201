//! The likelihood of a source's place, and how large it can be anywhere in a cell.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector2;

use crate::{Sight, faults::Faults};

/// A rectangle whose sides point east and north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub centre: Vector2<f64>,
    /// Half of its sides.
    pub half: Vector2<f64>,
}

impl Cell {
    pub fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// Its halves, cut across this axis.
    pub fn split(mut self, axis: usize) -> [Self; 2] {
        self.half[axis] *= 0.5;
        [-1.0, 1.0].map(|side| {
            let mut part = self;
            part.centre[axis] += side * self.half[axis];
            part
        })
    }
}

/// What holds everywhere in a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// The log-likelihood is nowhere larger.
    pub log: f64,
    /// Along either axis, a normal density of these bearings curves down by no more than this, per square metre: the sum of
    /// the squares of the largest slopes of the directions, each in the sigmas of its bearing. A jump of the slope counts as
    /// if it were spread over half of the cell.
    pub curvature: Vector2<f64>,
}

/// The log-likelihood of all bearings.
#[derive(Debug, Clone)]
pub(super) struct Likelihood {
    lines: Vec<Line>,
    bias_sigma: f64,
    /// Of bearings without errors, if all have a bias.
    biased_peak: f64,
}

/// A bearing, as its likelihood needs it.
#[derive(Debug, Clone)]
struct Line {
    position: Vector2<f64>,
    along: Vector2<f64>,
    sigma: f64,
    /// Logarithms of the densities, in 1/rad, of a direct and of a mirrored bearing without error, and of an outlier, each
    /// times the rate of its kind.
    peaks: [f64; 3],
}

impl Likelihood {
    /// # Panics
    /// If there are both a bias and outliers or mirrored bearings.
    pub fn new(sights: &[Sight], faults: &Faults) -> Self {
        let mixed = faults.outlier_rate + faults.mirrored_rate > 0.0;
        assert!(
            !(mixed && faults.bias_sigma > 0.0),
            "either a bias or outliers"
        );
        let lines: Vec<Line> = sights.iter().map(|s| Line::new(s, faults)).collect();
        let known: f64 = lines.iter().map(|line| 1.0 / line.sigma.powi(2)).sum();
        Self {
            biased_peak: lines.iter().map(|line| line.peaks[0]).sum::<f64>()
                - 0.5 * (1.0 + faults.bias_sigma.powi(2) * known).ln(),
            lines,
            bias_sigma: faults.bias_sigma,
        }
    }

    /// At a place.
    pub fn at(&self, place: Vector2<f64>) -> f64 {
        let views = self.lines.iter().map(|line| View {
            line,
            error: line.error(place - line.position),
            slack: 0.0,
        });
        match self.bias_sigma {
            0.0 => mixed(views),
            _ => self.biased(views, 0.0),
        }
    }

    /// In a cell.
    ///
    /// From a bearing's position the cell appears within an interval of directions: the bearing is nowhere in the cell more
    /// likely than at the direction of the interval that suits it best. The bound lets each bearing have a place of its own.
    ///
    /// If all have a bias the bound is one on the norm of the errors, each in its sigma and without what the bias explains:
    /// that of the centre, less that of the largest difference from it. Bearings that any direction in the cell would suit
    /// are left out, which makes the norm no larger.
    pub fn bound(&self, cell: &Cell) -> Bound {
        let radius = cell.half.norm();
        let mut all = Slopes::default();
        let mut kept = Slopes::default();
        let mut folds = Vector2::zeros();
        let views = self.lines.iter().map(|line| {
            let ray = cell.centre - line.position;
            let (range, error) = (ray.norm(), line.error(ray));
            let across = Vector2::new(-ray.y, ray.x) / range;
            // The cell lies in a rectangle along the ray of these half sides.
            let width = across.abs().dot(&cell.half);
            let nearest = range - across.yx().abs().dot(&cell.half);
            let (slack, slope, bend) = if nearest > 0.0 {
                let bend = radius / (nearest * nearest);
                (f64::min(width / nearest, PI), across / range, bend)
            } else {
                // The position may be in the cell, which appears all around it.
                (PI, Vector2::zeros(), PI / radius)
            };
            let view = View { line, error, slack };
            all.add(line.sigma, slope, bend);
            folds += view.fold() * slope.abs().add_scalar(bend);
            if view.says_something() {
                kept.add(line.sigma, slope, bend);
            }
            view
        });
        let views: Vec<View> = views.collect();
        let log = if self.bias_sigma > 0.0 {
            let (slope, bend) = kept.norms(self.bias_sigma);
            let change = slope.dot(&cell.half) + 0.5 * radius * bend;
            self.biased(views.into_iter().filter(View::says_something), change)
        } else {
            mixed(views.into_iter())
        };
        let (slope, bend) = all.norms(self.bias_sigma);
        Bound {
            log,
            curvature: slope.map(|slope| (slope + bend).powi(2)) + folds.component_div(&cell.half),
        }
    }

    /// Of bearings with one bias, which is integrated out, where the norm of the errors may be less by a `change`.
    fn biased<'a>(&self, views: impl Iterator<Item = View<'a>>, change: f64) -> f64 {
        let (mut known, mut shared, mut square) = (0.0, 0.0, 0.0);
        for View { line, error, .. } in views {
            let z = error / line.sigma;
            known += 1.0 / (line.sigma * line.sigma);
            shared += z / line.sigma;
            square += z * z;
        }
        let explained = shared * shared / (1.0 / self.bias_sigma.powi(2) + known);
        let norm = ((square - explained).max(0.0).sqrt() - change).max(0.0);
        self.biased_peak - 0.5 * norm * norm
    }
}

/// A bearing as it is seen from a place, or from all of a cell.
struct View<'a> {
    line: &'a Line,
    /// In radians, at the place or the centre of the cell.
    error: f64,
    /// How far the error in the cell can be from that at its centre, in radians.
    slack: f64,
}

impl View<'_> {
    /// How much the log-likelihood's derivative by the error jumps somewhere in the cell: where what is far to the left
    /// becomes far to the right, or a mirrored bearing becomes likelier than a direct one. There are no jumps among outliers.
    fn fold(&self) -> f64 {
        let [_, mirrored, outlier] = self.line.peaks;
        let fold = if mirrored > f64::NEG_INFINITY {
            FRAC_PI_2
        } else {
            PI
        };
        let crossed = (self.error.abs() - fold).abs() <= self.slack;
        if crossed && outlier == f64::NEG_INFINITY {
            2.0 * fold / self.line.sigma.powi(2)
        } else {
            0.0
        }
    }

    /// The error does not go through all of the circle's half within the cell, nor through zero unless it is small.
    fn says_something(&self) -> bool {
        let error = self.error.abs();
        self.slack <= error.max(self.line.sigma) && error + self.slack < PI
    }
}

/// How the directions of a cell's places, each in the sigmas of its bearing, change across it.
#[derive(Default)]
struct Slopes {
    known: f64,
    /// Sums over the slopes at the centre: of their squares, and of each over its sigma.
    squares: Vector2<f64>,
    shared: Vector2<f64>,
    /// Sum of the squares of how far a slope can be from that at the centre.
    bends: f64,
}

impl Slopes {
    /// One direction, whose slope at the centre of the cell is this, in radians per metre east and north, and elsewhere no
    /// further from it than `bend`.
    fn add(&mut self, sigma: f64, slope: Vector2<f64>, bend: f64) {
        let slope = slope / sigma;
        self.known += 1.0 / (sigma * sigma);
        self.squares += slope.component_mul(&slope);
        self.shared += slope / sigma;
        self.bends += (bend / sigma).powi(2);
    }

    /// Norms of the slopes at the centre, without what a bias of this sigma explains, and of the largest differences from
    /// them.
    fn norms(&self, bias_sigma: f64) -> (Vector2<f64>, f64) {
        let precision = 1.0 / (bias_sigma * bias_sigma) + self.known;
        let explained = self.shared.component_mul(&self.shared) / precision;
        let norms = (self.squares - explained).map(|square| square.max(0.0).sqrt());
        (norms, self.bends.sqrt())
    }
}

/// Of bearings each of which is direct, mirrored or an outlier.
fn mixed<'a>(views: impl Iterator<Item = View<'a>>) -> f64 {
    let (mut log, mut product) = (0.0, 1.0);
    for View { line, error, slack } in views {
        let least = (error.abs() - slack).max(0.0) / line.sigma;
        let from_behind = (PI - error.abs() - slack).max(0.0) / line.sigma;
        let [direct, mirrored, outlier] = line.peaks;
        let logs = [
            direct - 0.5 * least * least,
            mirrored - 0.5 * from_behind * from_behind,
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

impl Line {
    fn new(sight: &Sight, faults: &Faults) -> Self {
        let direct = 1.0 - faults.outlier_rate - faults.mirrored_rate;
        let peak = 1.0 / (TAU.sqrt() * sight.sigma);
        let densities = [
            direct * peak,
            faults.mirrored_rate * peak,
            faults.outlier_rate / TAU,
        ];
        Self {
            position: sight.position.into(),
            along: Vector2::new(sight.bearing.cos(), sight.bearing.sin()),
            sigma: sight.sigma,
            peaks: densities.map(f64::ln),
        }
    }

    /// Direction of a ray less the bearing, in (-pi, pi].
    fn error(&self, ray: Vector2<f64>) -> f64 {
        self.along.perp(&ray).atan2(self.along.dot(&ray))
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::{simulate, tracks::Track};

    /// The bound holds at random places of random cells, large and small, near the receivers and far, and is tight where a
    /// cell is small.
    #[test]
    fn nothing_in_a_cell_is_above_its_bound() {
        let mut rng = simulate::generator(21, 0);
        for faults in super::super::tests::faults() {
            let mut sights = simulate::bearings(&Track::a2(), &mut rng);
            faults.spoil(&mut sights, &mut rng);
            let likelihood = Likelihood::new(&sights, &faults);
            for _ in 0..3000 {
                let mut any = |size: f64| [0, 1].map(|_| size * rng.random_range(-1.0..1.0));
                let half = any(6.0).map(f64::exp2);
                let size = any(6.0)[0].exp2();
                let cell = Cell {
                    centre: Vector2::from(any(3000.0)),
                    half: Vector2::from(half) * size,
                };
                let bound = likelihood.bound(&cell);
                for _ in 0..10 {
                    let place = cell.centre + cell.half.component_mul(&Vector2::from(any(1.0)));
                    assert!(likelihood.at(place) <= bound.log + 1e-9, "{cell:?}");
                }
                let point = Cell {
                    half: Vector2::repeat(1e-9),
                    ..cell
                };
                let off = likelihood.bound(&point).log - likelihood.at(point.centre);
                assert!(off.abs() < 1e-3, "{off}");
            }
        }
    }
}
