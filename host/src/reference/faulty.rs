//! The exact posterior where bearings are outliers, mirrored or biased.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix2, Vector2};

use super::posterior::{FINE, FIRST, Grid, Posterior};
use crate::{Sight, faults::Faults};

/// A cell that is this far below the best, in log-likelihood, everywhere in it.
const HOPELESS: f64 = 14.0;
/// Errors beyond so many sigmas count as outliers alone.
const BEYOND: f64 = 9.0;

impl Posterior {
    /// The posterior where the rates of outliers and mirrored bearings are those of `faults`, or where all bearings have a
    /// bias of its sigma: these are known, what each bearing is and what the bias is are not. `None` if the `sights`
    /// do not determine a place within eight times the extent of the receivers.
    ///
    /// Summed over a grid, as [`Posterior::new`]; a cell is dropped by the largest likelihood that a place within it
    /// can have.
    ///
    /// # Panics
    /// If there are both a bias and outliers or mirrored bearings: that would take a sum over the bias, too.
    pub fn with_faults(sights: &[Sight], faults: &Faults) -> Option<Self> {
        let mixed = faults.outlier_rate + faults.mirrored_rate > 0.0;
        assert!(
            !(mixed && faults.bias_sigma > 0.0),
            "either a bias or outliers"
        );
        let lines: Vec<Line> = sights
            .iter()
            .map(|sight| Line::new(sight, faults))
            .collect();
        let log_likelihood = |place, half| {
            if mixed {
                mixture(&lines, place, half)
            } else {
                biased(&lines, faults.bias_sigma, place, half)
            }
        };

        let grid = Grid::round(sights)?;
        let mut half = grid.side / f64::from(FIRST) / 2.0;
        let mut cells = grid.cells();
        for _ in 0..40 {
            let log: Vec<f64> = cells
                .iter()
                .map(|cell| log_likelihood(*cell, 0.0))
                .collect();
            let posterior = Self::moments(&cells, &log);
            let short = posterior.covariance.symmetric_eigenvalues().min();
            if 2.0 * half <= FINE * short.max(0.0).sqrt() {
                return posterior.lies_inside(&grid).then_some(posterior);
            }
            let best = log.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            cells.retain(|cell| best - log_likelihood(*cell, half) < HOPELESS);
            half /= 2.0;
            cells = Grid::split(&cells, half);
            if cells.len() > 4_000_000 {
                return None;
            }
        }
        None
    }
}

/// The bound of [`cramer_rao`](super::cramer_rao) where all bearings have one more unknown in common: a bias of that
/// sigma, in radians.
pub fn cramer_rao_of_biased(sights: &[Sight], source: [f64; 2], bias: f64) -> Option<Matrix2<f64>> {
    let mut information = Matrix2::zeros();
    let mut shared = Vector2::zeros();
    let mut known = 0.0;
    for sight in sights {
        let ray = Vector2::from(source) - Vector2::from(sight.position);
        let across = Vector2::new(-ray.y, ray.x) / (sight.sigma * ray.norm_squared());
        information += across * across.transpose();
        shared += across / sight.sigma;
        known += 1.0 / (sight.sigma * sight.sigma);
    }
    if bias > 0.0 {
        information -= shared * shared.transpose() / (1.0 / (bias * bias) + known);
    }
    information.try_inverse()
}

/// A bearing, as its likelihood needs it.
struct Line {
    position: Vector2<f64>,
    along: Vector2<f64>,
    sigma: f64,
    /// Odds of being direct, and mirrored, rather than an outlier, where there is no error.
    odds: [f64; 2],
}

impl Line {
    fn new(sight: &Sight, faults: &Faults) -> Self {
        let peak = TAU.sqrt() / (sight.sigma * faults.outlier_rate);
        // Without any outliers the density of a uniform one is a unit that is of no account.
        let peak = if faults.outlier_rate > 0.0 { peak } else { 1.0 };
        Self {
            position: sight.position.into(),
            along: Vector2::new(sight.bearing.cos(), sight.bearing.sin()),
            sigma: sight.sigma,
            odds: [
                1.0 - faults.outlier_rate - faults.mirrored_rate,
                faults.mirrored_rate,
            ]
            .map(|rate| rate * peak),
        }
    }

    /// Offset of a place along and across the bearing, and the angle under which half of a cell's diagonal appears.
    fn offset(&self, place: Vector2<f64>, half: f64) -> ([f64; 2], f64) {
        let ray = place - self.position;
        let sine = std::f64::consts::SQRT_2 * half / ray.norm();
        let slack = if sine < 1.0 { sine.asin() } else { PI };
        ([ray.dot(&self.along), self.along.perp(&ray)], slack)
    }
}

/// Up to a constant: the largest in the cell that reaches `half` to either side of `place`.
fn mixture(lines: &[Line], place: Vector2<f64>, half: f64) -> f64 {
    let mut log = 0.0;
    for lines in lines.chunks(16) {
        let mut product = 1.0;
        for line in lines {
            let outlier = if line.odds[0] + line.odds[1] > 1.0 + 1e-9 {
                1.0
            } else {
                0.0
            };
            let ([along, across], slack) = line.offset(place, half);
            let reach = BEYOND * line.sigma + slack;
            // Most places are beyond the reach of most bearings: no arc tangent for them.
            let mut likelihood = outlier;
            if reach > FRAC_PI_2 || across.abs() < reach.tan() * along.abs() || outlier == 0.0 {
                let error = across.atan2(along).abs();
                for (odds, error) in line.odds.iter().zip([error, PI - error]) {
                    let z = (error - slack).max(0.0) / line.sigma;
                    likelihood += odds * (-0.5 * z * z).exp();
                }
            }
            product *= likelihood;
        }
        log += product.max(1e-300).ln();
    }
    log
}

/// The same of bearings with one bias, which is integrated out.
fn biased(lines: &[Line], bias: f64, place: Vector2<f64>, half: f64) -> f64 {
    let (mut s0, mut s1, mut s2, mut slacks) = (0.0, 0.0, 0.0, 0.0);
    for line in lines {
        let ([along, across], slack) = line.offset(place, half);
        let (z, spread) = (across.atan2(along) / line.sigma, slack / line.sigma);
        s0 += 1.0 / (line.sigma * line.sigma);
        s1 += z / line.sigma;
        s2 += z * z;
        slacks += spread * spread;
    }
    let shared = if bias > 0.0 {
        s1 * s1 / (1.0 / (bias * bias) + s0)
    } else {
        0.0
    };
    // A norm of the errors: within the cell at least itself less that of the slacks.
    let norm = ((s2 - shared).max(0.0).sqrt() - f64::sqrt(slacks)).max(0.0);
    -0.5 * norm * norm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{simulate, tracks::Track};

    fn near(a: &Posterior, b: &Posterior) {
        let sigma = b.covariance.trace().sqrt();
        for d in 0..2 {
            assert!((a.mean[d] - b.mean[d]).abs() < 0.01 * sigma);
        }
        assert!((a.covariance - b.covariance).norm() < 0.02 * b.covariance.norm());
    }

    #[test]
    fn without_faults_it_is_the_posterior() {
        for run in 0..10 {
            let sights = simulate::bearings(&Track::a1(), &mut simulate::generator(7, run));
            let plain = Posterior::new(&sights).unwrap();
            near(
                &Posterior::with_faults(&sights, &Faults::default()).unwrap(),
                &plain,
            );
            // A rate so small makes no difference, and neither does such a bias.
            let next_to_none = Faults {
                outlier_rate: 1e-5,
                mirrored_rate: 1e-5,
                bias_sigma: 0.0,
            };
            near(
                &Posterior::with_faults(&sights, &next_to_none).unwrap(),
                &plain,
            );
            let straight = Faults {
                bias_sigma: 1e-5,
                ..Faults::default()
            };
            near(&Posterior::with_faults(&sights, &straight).unwrap(), &plain);
        }
    }

    #[test]
    fn the_bound_of_biased_bearings_is_that_of_one_more_unknown() {
        let sights = simulate::bearings(&Track::a2(), &mut simulate::generator(8, 0));
        let source = Track::a2().source;
        let [straight, none, biased] = [
            super::super::cramer_rao(&sights, source),
            cramer_rao_of_biased(&sights, source, 0.0),
            cramer_rao_of_biased(&sights, source, 0.05),
        ]
        .map(Option::unwrap);
        assert!((straight - none).norm() < 1e-9 * straight.norm());
        // Nothing gets better by not knowing, and one direction gets worse: the difference is of rank one, but for
        // rounding. A narrow posterior is the bound.
        let worse = (biased - straight).symmetric_eigenvalues();
        assert!(worse.min() > -1e-9 * straight.norm() && worse.max() > 0.01 * straight.norm());
        let posterior = Posterior::with_faults(
            &sights,
            &Faults {
                bias_sigma: 0.05,
                ..Faults::default()
            },
        );
        let ratio = posterior.unwrap().covariance.trace() / biased.trace();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn mirrored_bearings_say_as_much_as_direct_ones() {
        let sights = simulate::bearings(&Track::a2(), &mut simulate::generator(8, 0));
        let mut turned = sights.clone();
        let half = Faults {
            mirrored_rate: 0.5,
            ..Faults::default()
        };
        half.spoil(&mut turned, &mut simulate::generator(9, 0));
        assert_ne!(turned, sights);
        near(
            &Posterior::with_faults(&turned, &half).unwrap(),
            &Posterior::new(&sights).unwrap(),
        );
    }

    #[test]
    fn a_bias_is_found_if_it_is_known_of() {
        let track = Track::a2();
        let mut sights = simulate::bearings(&track, &mut simulate::generator(10, 0));
        for sight in &mut sights {
            sight.bearing += 0.1;
        }
        let off = |posterior: Posterior| {
            (posterior.mean[0] - track.source[0]).hypot(posterior.mean[1] - track.source[1])
        };
        let biased = Faults {
            bias_sigma: 0.1,
            ..Faults::default()
        };
        assert!(off(Posterior::new(&sights).unwrap()) > 20.0);
        assert!(off(Posterior::with_faults(&sights, &biased).unwrap()) < 12.0);
    }
}
