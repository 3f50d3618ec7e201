//! The likelihood of a scan at the points of the map.

use super::comparison::{Comparison, Found, Spot};
use crate::fingerprint::{Lattice, RadioMap};
use crate::math::exp_of_weight;

/// The log-likelihood of every point, up to a common summand.
#[derive(Debug, Clone)]
pub(super) struct Field<const P: usize> {
    log_likelihoods: [f32; P],
    /// The log-likelihood of the best point.
    pub top: f32,
    /// The mean over the points of the likelihood, relative to that of the best point.
    pub mean: f32,
}

impl<const P: usize> Field<P> {
    pub const EMPTY: Self = Self {
        log_likelihoods: [0.0; P],
        top: 0.0,
        mean: 0.0,
    };

    /// Points of which the mean over a large map is taken at the least: fewer are work saved, and noise in the evidence.
    const SAMPLE: usize = 48;

    /// Compares a scan with every point.
    #[inline(never)]
    pub fn look_up_all<const B: usize>(&mut self, map: &RadioMap<'_>, scan: &Comparison<'_, B>) {
        self.look_up(map, scan, 1, 0);
    }

    /// Compares a scan with some points only, evenly over the map: for the mean. Other points at every time.
    #[inline(never)]
    pub fn sample<const B: usize>(
        &mut self,
        map: &RadioMap<'_>,
        scan: &Comparison<'_, B>,
        time: u32,
    ) {
        // Even strides would stay in some columns of a map whose rows have an even number of points.
        let stride = map.lattice().points() / Self::SAMPLE | 1;
        self.look_up(map, scan, stride, time as usize);
    }

    fn look_up<const B: usize>(
        &mut self,
        map: &RadioMap<'_>,
        scan: &Comparison<'_, B>,
        stride: usize,
        time: usize,
    ) {
        let lattice = map.lattice();
        let points = lattice.points();
        let stride = stride.max(1);
        let mut top = f32::NEG_INFINITY;
        let mut count = 0u32;
        let first = time.checked_rem(stride).unwrap_or(0);
        let each = self.log_likelihoods.iter_mut().take(points).enumerate();
        for (point, log_likelihood) in each.skip(first).step_by(stride) {
            let found = if map.is_possible(point) {
                at_point(lattice, scan, point)
            } else {
                Found::NOWHERE
            };
            *log_likelihood = found.log_likelihood;
            if found.log_likelihood > top {
                top = found.log_likelihood;
            }
            count += 1;
        }
        let mut sum = 0.0;
        let each = self.log_likelihoods.iter().take(points);
        for log_likelihood in each.skip(first).step_by(stride) {
            sum += exp_of_weight(*log_likelihood - top);
        }
        self.top = top;
        self.mean = sum / count as f32;
    }

    /// The likelihood of every point, relative to the best one.
    pub fn likelihoods(&self, lattice: &Lattice) -> impl Iterator<Item = f32> {
        let points = self.log_likelihoods.iter().take(lattice.points());
        points.map(|log_likelihood| exp_of_weight(*log_likelihood - self.top))
    }
}

#[inline(always)]
fn at_point<const B: usize>(lattice: &Lattice, scan: &Comparison<'_, B>, point: usize) -> Found {
    if lattice.is_plane() {
        let [column, row] = lattice.cell(point).map(|number| number as f32);
        match Spot::in_plane([column, row], lattice.columns(), lattice.rows()) {
            Some(spot) => scan.at::<true>(&spot, &spot),
            None => Found::NOWHERE,
        }
    } else {
        match Spot::on_line(point as f32, lattice.points()) {
            Some(spot) => scan.at::<false>(&spot, &spot),
            None => Found::NOWHERE,
        }
    }
}
