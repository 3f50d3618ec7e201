//! The likelihood of a scan at the points of the map, and between them.

use super::comparison::{Comparison, Found, Past, Slope};
use super::floor::Floor;
use super::offset::OffsetBelief;
use crate::fingerprint::{Lattice, RadioMap};
use crate::math::exp_of_weight;

/// What a scan says of the points about the particles, floor by floor.
///
/// It is computed for each point, not for each particle: there are fewer points about a cloud than particles in it, and a
/// particle then takes only an interpolation. Where a particle was when it heard what is remembered is not the same for
/// all that are at a point: that is what the slopes are for.
#[derive(Debug, Clone)]
pub(super) struct Field<const P: usize> {
    points: [Point; P],
    /// How much the scan adds to the precision of the offset, per dB^2: the sum over the points that were compared, and their
    /// number.
    precision: f32,
    compared: u16,
    /// Over the map, if nothing is remembered.
    mean: Mean,
}

/// What a scan says of a point.
#[derive(Debug, Clone, Copy)]
struct Point {
    log_likelihood: f32,
    slope: Slope,
    /// The correction of the mean of the offset, if the tag has one, and the probability that it has one.
    shift: f32,
    probability: f32,
    /// Of the particles that are nearest to it; or a mark.
    weight: f32,
}

impl Point {
    const EMPTY: Self = Self {
        log_likelihood: 0.0,
        slope: [0.0; 2],
        shift: 0.0,
        probability: 0.0,
        weight: 0.0,
    };

    #[inline(always)]
    fn set(&mut self, found: &Found, slope: &Slope) {
        self.log_likelihood = found.log_likelihood;
        self.slope = *slope;
        self.shift = found.shift;
        self.probability = found.probability;
    }
}

/// The mean of likelihoods relative to the largest, as they come.
#[derive(Debug, Clone, Copy)]
struct Mean {
    top: f32,
    sum: f32,
    count: u16,
}

impl Mean {
    const EMPTY: Self = Self {
        top: f32::NEG_INFINITY,
        sum: 0.0,
        count: 0,
    };

    #[inline(always)]
    fn add(&mut self, log_likelihood: f32) {
        if log_likelihood > self.top {
            self.sum *= exp_of_weight(self.top - log_likelihood);
            self.top = log_likelihood;
        }
        // Nothing for NaN: both may be minus infinity.
        self.sum += exp_of_weight(log_likelihood - self.top);
        self.count = self.count.saturating_add(1);
    }
}

impl<const P: usize> Field<P> {
    pub const EMPTY: Self = Self {
        points: [Point::EMPTY; P],
        precision: 0.0,
        compared: 0,
        mean: Mean {
            top: 0.0,
            ..Mean::EMPTY
        },
    };

    /// Points of which the mean over a large map is taken at the least: fewer are work saved, and noise in the evidence.
    const SAMPLE: usize = 16;

    /// Forgets the last scan.
    pub fn begin(&mut self) {
        (self.precision, self.compared, self.mean) = (0.0, 0, Mean::EMPTY);
    }

    /// The log-likelihood of the best point, if nothing is remembered.
    pub fn top(&self) -> f32 {
        self.mean.top
    }

    /// The mean over the map of the likelihood, relative to that of the best point, if nothing is remembered.
    pub fn mean(&self) -> f32 {
        self.mean.sum / f32::from(self.mean.count)
    }

    /// Compares a scan with every point of a floor, by nothing that is remembered.
    #[inline(never)]
    pub fn look_up_all<const B: usize>(
        &mut self,
        floor: u8,
        map: &RadioMap<'_>,
        scan: &Comparison<'_, B>,
    ) {
        let points = map.lattice().points();
        let mut mean = self.mean;
        let mut precision = self.precision;
        let of_floor = self.points.iter_mut().skip(usize::from(floor) * points);
        for (number, point) in of_floor.enumerate().take(points) {
            let found = if map.is_possible(number) {
                scan.anew_at(number)
            } else {
                Found::NOWHERE
            };
            point.set(&found, &[0.0; 2]);
            precision += found.precision;
            mean.add(found.log_likelihood);
        }
        (self.precision, self.mean, self.compared) = (precision, mean, mean.count);
    }

    /// Adds a floor to the mean over the map, by points that are spread evenly: others at every time.
    #[inline(never)]
    pub fn sample<const B: usize>(
        &mut self,
        map: &RadioMap<'_>,
        scan: &Comparison<'_, B>,
        time: u32,
    ) {
        let points = map.lattice().points();
        // Even strides would stay in some columns of a map whose rows have an even number of points.
        let stride = (points / Self::SAMPLE) | 1;
        let mut mean = self.mean;
        let mut point = (time as usize).checked_rem(stride).unwrap_or(0);
        while point < points {
            if map.is_complete() || map.is_possible(point) {
                mean.add(scan.anew_at(point).log_likelihood);
            } else {
                mean.add(f32::NEG_INFINITY);
            }
            point += stride;
        }
        self.mean = mean;
    }

    /// Marks the cells that have particles.
    #[inline(always)]
    pub fn mark(&mut self, cells: &[u16]) {
        for point in &mut self.points {
            point.weight = 0.0;
        }
        for cell in cells {
            if let Some(point) = self.points.get_mut(usize::from(*cell)) {
                point.weight = 1.0;
            }
        }
    }

    /// Compares a scan with the corners of the marked cells of a floor, where particles moved by about so many steps since what
    /// is remembered, in the mean over its ages.
    #[inline(never)]
    pub fn look_up_marked<const B: usize>(
        &mut self,
        floor: u8,
        lattice: &Lattice,
        scan: &Comparison<'_, B>,
        moved: [f32; 2],
    ) {
        let before = usize::from(floor) * lattice.points();
        let is_plane = lattice.is_plane();
        let [columns, rows] = if is_plane {
            [lattice.columns(), lattice.rows()]
        } else {
            [lattice.points(), 1]
        };
        let (mut precision, mut count) = (self.precision, self.compared);
        let mut first = 0;
        for row in 0..rows {
            let (below, across) = back(row, rows, Past::RECENT * moved[1]);
            let old_row = nearest_back(row, rows, Past::OLD * moved[1]);
            for column in 0..columns {
                let number = first + column;
                if !self.is_corner(before + number, columns) {
                    continue;
                }
                let (left, along) = back(column, columns, Past::RECENT * moved[0]);
                let old_column = nearest_back(column, columns, Past::OLD * moved[0]);
                let past = Past {
                    first: below * columns + left,
                    fractions: [along, across],
                    old: old_row * columns + old_column,
                };
                let (found, slope) = if is_plane {
                    scan.at_point::<true>(number, &past)
                } else {
                    scan.at_point::<false>(number, &past)
                };
                precision += found.precision;
                count = count.saturating_add(1);
                if let Some(point) = self.points.get_mut(before + number) {
                    point.set(&found, &slope);
                }
            }
            first += columns;
        }
        (self.precision, self.compared) = (precision, count);
    }

    /// Whether one of the cells that a point is a corner of is marked.
    #[inline(always)]
    fn is_corner(&self, point: usize, columns: usize) -> bool {
        let is_marked = |cell: Option<usize>| {
            let cell = cell.and_then(|cell| self.points.get(cell));
            cell.is_some_and(|cell| cell.weight > 0.0)
        };
        is_marked(Some(point))
            || is_marked(point.checked_sub(1))
            || is_marked(point.checked_sub(columns))
            || is_marked(point.checked_sub(columns + 1))
    }

    /// The log-likelihood on a map of one row or one column, in a cell, a fraction of it beyond its first point, after a move
    /// that is by so much larger than that of the others.
    #[inline(always)]
    pub fn on_line(&self, cell: u16, fraction: f32, further: f32) -> f32 {
        let pair = self.points.get(usize::from(cell)..);
        match pair.and_then(|rest| rest.first_chunk()) {
            Some([a, b]) => {
                let nearest = if fraction < 0.5 { a } else { b };
                mix(a, b, fraction) + further * nearest.slope[0]
            }
            None => f32::NEG_INFINITY,
        }
    }

    /// The same on a map of several rows and columns.
    #[inline(always)]
    pub fn in_plane(&self, cell: u16, columns: usize, [s, t]: [f32; 2], further: [f32; 2]) -> f32 {
        let first = usize::from(cell);
        let pair = |first: usize| self.points.get(first..).and_then(|rest| rest.first_chunk());
        let (Some([a, b]), Some([c, d])) = (pair(first), pair(first + columns)) else {
            return f32::NEG_INFINITY;
        };
        let [near, far] = if s < 0.5 { [a, c] } else { [b, d] };
        let nearest = if t < 0.5 { near } else { far };
        let [below, above] = [mix(a, b, s), mix(c, d, s)];
        let [along, across] = nearest.slope;
        below + t * (above - below) + (further[0] * along + further[1] * across)
    }

    /// Teaches the belief about the offset what particles at these places think of it, whose weights add up to `total`: each as
    /// the point that is nearest to it, of `all` on all floors.
    #[inline(never)]
    pub fn teach<const N: usize, F: Floor>(
        &mut self,
        belief: &mut OffsetBelief,
        lattice: &Lattice,
        ([x, y], floors, weights): (&[[f32; N]; 2], &[F; N], &[f32; N]),
        all: usize,
        total: f32,
    ) {
        if !belief.is_estimated() {
            return;
        }
        let on_floor = lattice.points();
        let points = self.points.get_mut(..all).unwrap_or_default();
        for point in points.iter_mut() {
            point.weight = 0.0;
        }
        let places = x.iter().zip(y).zip(floors);
        for (weight, ((x, y), floor)) in weights.iter().zip(places) {
            let before = usize::from(floor.number()) * on_floor;
            if let Some(point) = points.get_mut(before + lattice.nearest_to_steps([*x, *y])) {
                point.weight += weight;
            }
        }
        let opinions = points
            .iter()
            .map(|point| (point.weight, [point.probability, point.shift]));
        let precision = self.precision / f32::from(self.compared.max(1));
        belief.learn(precision, total, opinions);
    }

    /// The likelihood of each of the first so many points, relative to the best one.
    pub fn likelihoods(&self, points: usize) -> impl Iterator<Item = f32> {
        let points = self.points.iter().take(points);
        points.map(|point| exp_of_weight(point.log_likelihood - self.mean.top))
    }
}

/// The point and the fraction of a step beyond it where a tag was, so many steps before, that is at a point of a line; within
/// the line.
#[inline(always)]
fn back(point: usize, points: usize, moved: f32) -> (usize, f32) {
    let last = points.saturating_sub(1);
    let place = point as f32 - moved;
    // Saturates; NaN becomes 0.
    let first = (place as usize).min(last.saturating_sub(1));
    let fraction = place - first as f32;
    (first, fraction.clamp(0.0, 1.0))
}

/// The point nearest to it.
#[inline(always)]
fn nearest_back(point: usize, points: usize, moved: f32) -> usize {
    // Saturates; NaN becomes 0.
    let nearest = (point as f32 - moved + 0.5) as usize;
    nearest.min(points.saturating_sub(1))
}

/// Interpolates between `a` and `b`.
#[inline(always)]
fn mix(a: &Point, b: &Point, fraction: f32) -> f32 {
    a.log_likelihood + fraction * (b.log_likelihood - a.log_likelihood)
}
