//! One bearing, from a place or from all of a cell.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector2;

use super::cell::Cell;
use foxhunt_simulation::{Sight, faults::Faults};

/// A bearing, as its likelihood needs it.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub position: Vector2<f64>,
    bearing: f64,
    along: Vector2<f64>,
    pub sigma: f64,
    /// How far each bias turns it, in its sigma.
    pub turns: Vec<f64>,
    /// Logarithms of the densities, in 1/rad, of a direct and of a mirrored bearing without error, and of an outlier, each
    /// times the rate of its kind.
    pub peaks: [f64; 3],
}

impl Line {
    /// Of a bearing that each bias turns so far, in radians.
    pub fn new(sight: &Sight, faults: &Faults, mut turns: Vec<f64>) -> Self {
        turns.iter_mut().for_each(|turn| *turn /= sight.sigma);
        let direct = 1.0 - faults.outlier_rate - faults.mirrored_rate;
        let peak = 1.0 / (TAU.sqrt() * sight.sigma);
        let densities = [
            direct * peak,
            faults.mirrored_rate * peak,
            faults.outlier_rate / TAU,
        ];
        Self {
            position: sight.position.into(),
            bearing: sight.bearing,
            along: Vector2::new(sight.bearing.cos(), sight.bearing.sin()),
            sigma: sight.sigma,
            turns,
            peaks: densities.map(f64::ln),
        }
    }

    /// Direction of a ray less the bearing, in (-pi, pi].
    pub fn error(&self, ray: Vector2<f64>) -> f64 {
        self.along.perp(&ray).atan2(self.along.dot(&ray))
    }
}

/// A bearing as it is seen from a place, or from all of a cell.
pub(super) struct View<'a> {
    pub line: &'a Line,
    /// In radians, at the place or the centre of the cell.
    pub error: f64,
    /// How far the error in the cell can be from that at its centre, in radians.
    pub slack: f64,
}

impl<'a> View<'a> {
    /// Direction of the place, or of the centre of the cell, in radians counter-clockwise from east.
    pub fn direction(&self) -> f64 {
        self.line.bearing + self.error
    }

    pub fn of_place(line: &'a Line, place: Vector2<f64>) -> Self {
        Self {
            line,
            error: line.error(place - line.position),
            slack: 0.0,
        }
    }

    /// With the slope of the direction at the centre of the cell, in radians per metre east and north, and how far it can be
    /// from that elsewhere.
    pub fn of_cell(line: &'a Line, cell: &Cell) -> (Self, Vector2<f64>, f64) {
        let radius = cell.half.norm();
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
        (Self { line, error, slack }, slope, bend)
    }

    /// The smallest error in the cell, in sigmas.
    pub fn least(&self) -> f64 {
        (self.error.abs() - self.slack).max(0.0) / self.line.sigma
    }

    /// How much the log-likelihood's derivative by the error jumps somewhere in the cell: where what is far to the left
    /// becomes far to the right, or a mirrored bearing becomes likelier than a direct one. There are no jumps among outliers.
    pub fn fold(&self) -> f64 {
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

    /// The error may go through half of the circle within the cell, and is nowhere small.
    pub fn wraps(&self) -> bool {
        self.error.abs() + self.slack >= PI && self.slack < FRAC_PI_2
    }

    /// The error does not go through all of the circle's half within the cell, nor through zero unless it is small.
    pub fn says_something(&self) -> bool {
        let error = self.error.abs();
        self.slack <= error.max(self.line.sigma) && error + self.slack < PI
    }
}
