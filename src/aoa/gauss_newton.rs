//! The position that explains all bearings best, by Gauss-Newton steps.
//!
//! For one clean source that does not move this is as good as anything can be: the yardstick for every
//! filter here. It knows nothing of a second mode, and its covariance is that of a normal distribution.

use core::fmt;

use super::Observation;
use crate::estimate::Symmetric2;
use crate::math::{atan2, sin_cos, sqrt, wrap};

/// How the errors of bearings are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Errors {
    /// Normal, with the sigma of each observation.
    Gaussian,
    /// Von Mises, with one unknown concentration that is estimated from the residuals: only the ratios of the
    /// sigmas count. Lenth, "On finding the source of a signal", Technometrics 23 (1981).
    VonMises,
}

/// A position and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solution {
    /// Metres east and north.
    pub position: [f32; 2],
    /// Square metres; the inverse of the information in the bearings.
    pub covariance: Symmetric2,
}

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SolveError {
    /// Two bearings make a position, and three a von Mises concentration.
    TooFewBearings,
    /// The bearings are parallel as far as f32 can tell.
    Parallel,
    /// No minimum within [`MAX_STEPS`] steps: the bearings do not meet.
    NotConverged,
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooFewBearings => "too few bearings",
            Self::Parallel => "the bearings are parallel",
            Self::NotConverged => "the bearings do not meet",
        })
    }
}

impl core::error::Error for SolveError {}

/// Steps after which a search is given up.
pub const MAX_STEPS: u32 = 40;

/// A search ends with a step of less than a thousandth of a standard deviation, here squared ...
const SETTLED: f32 = 1e-6;

/// ... or when what a step would gain is lost in the rounding of the cost, of which this is a fraction.
const ROUNDING: f32 = 1e-5;

/// What one bearing says about a position: its error there, and the derivative of its direction.
pub(super) struct Linearised {
    /// Measured less expected direction, in radians.
    pub(super) residual: f32,
    /// Derivative of the expected direction, in radians a metre.
    gradient: [f32; 2],
    /// 1 / sigma^2
    pub(super) information: f32,
}

/// Closer to a receiver than this many metres, the direction of a source turns with every step.
const NEAREST_M: f32 = 1e-3;

// Once in flash: it holds an arc tangent, and its callers are many.
#[inline(never)]
pub(super) fn linearise(observation: &Observation, position: [f32; 2]) -> Linearised {
    let [dx, dy] = [
        position[0] - observation.position()[0],
        position[1] - observation.position()[1],
    ];
    let square = dx * dx + dy * dy + NEAREST_M * NEAREST_M;
    Linearised {
        residual: wrap(observation.bearing().radians() - atan2(dy, dx)),
        gradient: [-dy / square, dx / square],
        information: observation.information(),
    }
}

/// Sums over all bearings at one position.
#[derive(Default)]
struct Normal {
    matrix: Symmetric2,
    gradient: [f32; 2],
    /// What is minimised.
    cost: f32,
}

impl Normal {
    fn at(observations: &[impl AsRef<Observation>], errors: Errors, position: [f32; 2]) -> Self {
        let mut sums = Self::default();
        for observation in observations.iter().map(AsRef::as_ref) {
            let Linearised {
                residual,
                gradient: [gx, gy],
                information,
            } = linearise(observation, position);
            let (pull, cost) = match errors {
                Errors::Gaussian => (residual, 0.5 * residual * residual),
                Errors::VonMises => {
                    // 1 - cos would lose the digits of a small error.
                    let half = sin_cos(0.5 * residual).0;
                    let sin = sin_cos(residual).0;
                    (sin, 2.0 * half * half)
                }
            };
            sums.matrix.xx += information * gx * gx;
            sums.matrix.xy += information * gx * gy;
            sums.matrix.yy += information * gy * gy;
            sums.gradient[0] += information * gx * pull;
            sums.gradient[1] += information * gy * pull;
            sums.cost += information * cost;
        }
        sums
    }
}

/// Searches for the best position from `start`, in metres east and north.
///
/// # Errors
/// When there are too few bearings, they are parallel, or the search does not settle; see [`SolveError`].
pub fn solve(
    observations: &[impl AsRef<Observation>],
    errors: Errors,
    start: [f32; 2],
) -> Result<Solution, SolveError> {
    let needed = match errors {
        Errors::Gaussian => 2,
        Errors::VonMises => 3,
    };
    if observations.len() < needed {
        return Err(SolveError::TooFewBearings);
    }
    let mut position = start;
    let mut here = Normal::at(observations, errors, position);
    // Levenberg's damping: a fraction of the diagonal, which shortens a step that made things worse.
    let mut damping = 0.0;
    for _ in 0..MAX_STEPS {
        let damped = Symmetric2 {
            xx: here.matrix.xx * (1.0 + damping),
            yy: here.matrix.yy * (1.0 + damping),
            ..here.matrix
        };
        let [dx, dy] = damped
            .inverse()
            .ok_or(SolveError::Parallel)?
            .times(here.gradient);
        // The square of the undamped step in standard deviations.
        let decrement = (dx * here.gradient[0] + dy * here.gradient[1]) * (1.0 + damping);
        let next = [position[0] + dx, position[1] + dy];
        let there = Normal::at(observations, errors, next);
        let better = there.cost <= here.cost;
        if better {
            position = next;
            here = there;
            damping *= 0.1;
        } else {
            damping = if damping > 0.0 { damping * 10.0 } else { 1e-3 };
        }
        if decrement < SETTLED || (!better && decrement < ROUNDING * here.cost) {
            let covariance = match errors {
                Errors::Gaussian => here.matrix.inverse().ok_or(SolveError::Parallel)?,
                Errors::VonMises => von_mises_covariance(observations, position)?,
            };
            return Ok(Solution {
                position,
                covariance,
            });
        }
    }
    Err(SolveError::NotConverged)
}

/// Lenth (1981), the asymptotic covariance of the maximum-likelihood estimate.
fn von_mises_covariance(
    observations: &[impl AsRef<Observation>],
    position: [f32; 2],
) -> Result<Symmetric2, SolveError> {
    let mut matrix = Symmetric2::default();
    let mut weights = 0.0;
    // One less the mean cosine of the residuals, by half angles, which keep the digits of small ones.
    let mut shortfall = 0.0;
    for observation in observations.iter().map(AsRef::as_ref) {
        let Linearised {
            residual,
            gradient: [gx, gy],
            information,
        } = linearise(observation, position);
        // The paper multiplies the expected by the measured direction, both over the distance.
        let (sin, cos) = sin_cos(observation.bearing().radians());
        let inverse_distance = sqrt(gx * gx + gy * gy);
        let (mx, my) = (-sin * inverse_distance, cos * inverse_distance);
        matrix.xx += information * gx * mx;
        matrix.xy += information * 0.5 * (gx * my + gy * mx);
        matrix.yy += information * gy * my;
        weights += information;
        let half = sin_cos(0.5 * residual).0;
        shortfall += information * 2.0 * half * half;
    }
    // Of the concentration, by Lenth's series in the mean cosine.
    let s = shortfall / weights;
    let c = 1.0 - s;
    let spread = 2.0 * s + s * s * (0.48794 - 0.82905 * c - 1.3915 * c * c) / c;
    let mean_information = weights / observations.len() as f32;
    let scale = spread * mean_information;
    let inverse = matrix.inverse().ok_or(SolveError::Parallel)?;
    Ok(inverse.scaled(scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;

    fn towards(position: [f32; 2], target: [f32; 2], error: f32) -> Observation {
        let angle = (target[1] - position[1]).atan2(target[0] - position[0]);
        Observation::new(0, position, Bearing::from_radians(angle + error), 0.02).unwrap()
    }

    #[test]
    fn exact_bearings_give_the_source_from_a_poor_start() {
        let source = [1200.0, 800.0];
        let observations: [Observation; 6] =
            core::array::from_fn(|i| towards([300.0 * i as f32, 0.0], source, 0.0));
        for errors in [Errors::Gaussian, Errors::VonMises] {
            for start in [[400.0, 300.0], [1500.0, 1500.0], [1100.0, 900.0]] {
                let Solution { position, .. } = solve(&observations, errors, start).unwrap();
                assert!(
                    (position[0] - source[0]).abs() < 0.01,
                    "{errors:?} {start:?} {position:?}"
                );
                assert!(
                    (position[1] - source[1]).abs() < 0.01,
                    "{errors:?} {start:?} {position:?}"
                );
            }
        }
    }

    #[test]
    fn the_covariance_is_the_cramer_rao_bound() {
        // Two bearings that cross at a right angle, 1 km away: 20 m in either direction.
        let observations = [
            towards([-1000.0, 0.0], [0.0, 0.0], 0.0),
            towards([0.0, -1000.0], [0.0, 0.0], 0.0),
        ];
        let solution = solve(&observations, Errors::Gaussian, [50.0, 50.0]).unwrap();
        let Symmetric2 { xx, xy, yy } = solution.covariance;
        assert!((xx - 400.0).abs() < 0.1 && (yy - 400.0).abs() < 0.1 && xy.abs() < 0.1);
    }

    #[test]
    fn a_small_error_keeps_its_digits() {
        // Von Mises and normal errors are the same when they are small: the same spread, whatever its size.
        for sigma in [0.02f32, 0.003, 0.0005] {
            let observations: [Observation; 8] = core::array::from_fn(|i| {
                let error = if i % 2 == 0 { sigma } else { -sigma };
                towards([300.0 * i as f32, 0.0], [1000.0, 800.0], error)
            });
            let solution = solve(&observations, Errors::VonMises, [900.0, 700.0]).unwrap();
            let normal = solve(&observations, Errors::Gaussian, [900.0, 700.0]).unwrap();
            let ratio = solution.covariance.xx / normal.covariance.xx;
            let expected = (sigma / 0.02) * (sigma / 0.02);
            // The fit takes up a part of the errors.
            assert!(
                (0.5..1.1).contains(&(ratio / expected)),
                "{sigma}: {}",
                ratio / expected
            );
        }
    }

    #[test]
    fn what_has_no_solution_says_why() {
        let one = [towards([0.0, 0.0], [0.0, 500.0], 0.0)];
        let stationary = [one[0]; 5];
        let start = [10.0, 400.0];
        assert_eq!(
            solve(&one, Errors::Gaussian, start),
            Err(SolveError::TooFewBearings)
        );
        assert_eq!(
            solve(&stationary[..2], Errors::VonMises, start),
            Err(SolveError::TooFewBearings)
        );
        assert_eq!(
            solve(&stationary, Errors::Gaussian, start),
            Err(SolveError::Parallel)
        );
        let parting = [
            towards([-10.0, 0.0], [-20.0, 100.0], 0.0),
            towards([10.0, 0.0], [20.0, 100.0], 0.0),
        ];
        assert!(solve(&parting, Errors::Gaussian, [0.0, 50.0]).is_err());
    }
}
