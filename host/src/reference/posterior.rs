//! The exact posterior of a source that stands still.

use nalgebra::{Matrix2, Vector2};

use crate::Sight;

/// Mean and covariance of the place of the source given all bearings, under a flat prior and
/// Gaussian bearing errors.
///
/// Summed over a grid that is refined where the posterior is. So that a coarse grid does not step
/// over a peak narrower than its cells, a bearing's sigma is widened by the angle under which a
/// cell appears; cells that are hopeless even then are dropped and the others split in four, until
/// they are small against the posterior itself.
#[derive(Debug, Clone, Copy)]
pub struct Posterior {
    /// In metres east and north.
    pub mean: [f64; 2],
    /// In square metres.
    pub covariance: Matrix2<f64>,
}

/// A cell that is this far below the best, in log-likelihood, holds less than 1e-7 of the peak.
const HOPELESS: f64 = 18.0;
/// Width of a final cell in standard deviations along the posterior's short axis. The midpoint sums of
/// a Gaussian are already good to 1e-8 at 1.
pub(super) const FINE: f64 = 0.5;
/// Cells along one side of the first grid.
pub(super) const FIRST: i32 = 64;
/// Side of the first grid, in diagonals of the box round the receivers.
const REACH: f64 = 8.0;

impl Posterior {
    /// From all `sights`; `None` if they do not determine a place within eight times the extent of
    /// the receivers.
    pub fn new(sights: &[Sight]) -> Option<Self> {
        let grid = Grid::round(sights)?;
        let mut half = grid.side / f64::from(FIRST) / 2.0;
        let mut cells = grid.cells();

        for _ in 0..40 {
            let log: Vec<f64> = cells
                .iter()
                .map(|&cell| log_likelihood(sights, cell, half))
                .collect();
            let short = Self::moments(&cells, &log)
                .covariance
                .symmetric_eigenvalues()
                .min();
            if 2.0 * half <= FINE * short.max(0.0).sqrt() {
                let log: Vec<f64> = cells
                    .iter()
                    .map(|&cell| log_likelihood(sights, cell, 0.0))
                    .collect();
                let posterior = Self::moments(&cells, &log);
                return posterior.lies_inside(&grid).then_some(posterior);
            }
            let best = maximum(&log);
            half /= 2.0;
            let mut hopeful = log.iter().map(|log| best - *log < HOPELESS);
            cells.retain(|_| hopeful.next() == Some(true));
            cells = Grid::split(&cells, half);
            if cells.len() > 4_000_000 {
                return None;
            }
        }
        None
    }

    pub(super) fn moments(cells: &[Vector2<f64>], log: &[f64]) -> Self {
        let best = maximum(log);
        let weights = || log.iter().map(|log| (log - best).exp());
        let total: f64 = weights().sum();
        let mean = cells
            .iter()
            .zip(weights())
            .map(|(cell, weight)| cell * weight)
            .sum::<Vector2<f64>>()
            / total;
        let covariance = cells
            .iter()
            .zip(weights())
            .map(|(cell, weight)| (cell - mean) * (cell - mean).transpose() * weight)
            .sum::<Matrix2<f64>>()
            / total;
        Self {
            mean: mean.into(),
            covariance,
        }
    }

    /// Four standard deviations round the mean are within the grid.
    pub(super) fn lies_inside(&self, grid: &Grid) -> bool {
        let offset = Vector2::from(self.mean) - grid.centre;
        (0..2).all(|d| offset[d].abs() + 4.0 * self.covariance[(d, d)].sqrt() < grid.side / 2.0)
    }
}

/// The square that is searched.
pub(super) struct Grid {
    centre: Vector2<f64>,
    pub(super) side: f64,
}

impl Grid {
    /// Round the receivers; `None` if they are all at one place.
    pub(super) fn round(sights: &[Sight]) -> Option<Self> {
        let mut low = Vector2::from(sights.first()?.position);
        let mut high = low;
        for sight in sights {
            let place = Vector2::from(sight.position);
            low = low.inf(&place);
            high = high.sup(&place);
        }
        let side = REACH * (high - low).norm();
        let centre = (low + high) / 2.0;
        (side > 0.0).then_some(Self { centre, side })
    }

    /// The centres of the first cells.
    pub(super) fn cells(&self) -> Vec<Vector2<f64>> {
        let half = self.side / f64::from(FIRST) / 2.0;
        let step = |n: i32| f64::from(2 * n - FIRST + 1) * half;
        (0..FIRST * FIRST)
            .map(|k| self.centre + Vector2::new(step(k % FIRST), step(k / FIRST)))
            .collect()
    }

    /// Each in four, whose sides are twice `half`.
    pub(super) fn split(cells: &[Vector2<f64>], half: f64) -> Vec<Vector2<f64>> {
        let corners =
            [[-half, -half], [half, -half], [-half, half], [half, half]].map(Vector2::from);
        cells
            .iter()
            .flat_map(|cell| corners.map(|corner| cell + corner))
            .collect()
    }
}

fn maximum(log: &[f64]) -> f64 {
    log.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Up to a constant; `half` is half the width of the cell round `place`.
fn log_likelihood(sights: &[Sight], place: Vector2<f64>, half: f64) -> f64 {
    let term = |sight: &Sight| {
        let range = (place - Vector2::from(sight.position)).norm();
        let variance = sight.sigma.powi(2) + (half / range).powi(2).min(10.0);
        sight.residual(place.into()).powi(2) / variance
    };
    -0.5 * sights.iter().map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        reference::{cramer_rao, gauss_newton},
        simulate,
        tracks::Track,
    };

    /// Where the posterior is narrow it is Gaussian: mean and covariance are the maximum's.
    #[test]
    fn narrow_posterior_is_the_maximum_likelihood() {
        let mut track = Track::a2();
        track.sigma = 1e-4;
        let sights = simulate::bearings(&track, &mut simulate::generator(1, 0));
        let posterior = Posterior::new(&sights).unwrap();
        let maximum = gauss_newton(&sights, [1000.0, 1000.0]).unwrap();
        let bound = cramer_rao(&sights, track.source).unwrap();
        let sigma = bound.trace().sqrt();
        for d in 0..2 {
            assert!((posterior.mean[d] - maximum.place[d]).abs() < 0.01 * sigma);
        }
        assert!((posterior.covariance - bound).norm() < 0.02 * bound.norm());
    }

    #[test]
    fn parallel_bearings_have_no_posterior() {
        let sight = |x| Sight {
            time_ms: 1000 * x as u32,
            position: [x, 0.0],
            bearing: 0.0,
            sigma: 0.02,
        };
        assert!(Posterior::new(&[sight(0.0), sight(1.0)]).is_none());
    }
}
