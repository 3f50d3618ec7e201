//! What the exact posterior takes for known of the errors and of the place.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Vector2};

use super::cell::Cell;
use foxhunt_simulation::{Sight, faults::Faults};

/// What is known of the bearings and of the place before any of them. By default: errors as stated, and nothing of the place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// The rates of outliers and of mirrored bearings, and the sigma of a bias of all.
    pub faults: Faults,
    /// All sigmas are as stated times exp(`scale_sigma` z), one z for all bearings, of a density in proportion to
    /// exp(-sqrt(1 + z^2)). Zero: as stated.
    pub scale_sigma: f64,
    /// Biases beside that of the faults.
    pub biases: Biases,
    /// Where the source is expected.
    pub prior: Prior,
}

impl Model {
    /// With `faults`, and otherwise as by default.
    pub fn with_faults(faults: &Faults) -> Self {
        Self {
            faults: *faults,
            ..Self::default()
        }
    }

    /// How far each bias that does not depend on the place turns each of `count` bearings, in radians.
    pub(super) fn turns(&self, count: usize) -> Vec<Vec<f64>> {
        let common = Some(self.faults.bias_sigma).filter(|sigma| *sigma > 0.0);
        let own: &[Vec<f64>] = match &self.biases {
            Biases::Turns(turns) => turns,
            Biases::None | Biases::ByDirection(_) => &[],
        };
        assert!(
            own.is_empty() || own.len() == count,
            "biases of another number of bearings"
        );
        (0..count)
            .map(|k| {
                own.get(k)
                    .into_iter()
                    .flatten()
                    .copied()
                    .chain(common)
                    .collect()
            })
            .collect()
    }
}

/// What turns bearings, each bias by a standard normal number.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Biases {
    /// Nothing.
    #[default]
    None,
    /// For each bearing, how far each bias turns it, in radians.
    Turns(Vec<Vec<f64>>),
    /// By the direction of the source from the bow.
    ByDirection(ByDirection),
}

/// A bias by the direction of the source from the bow: a mean and harmonics.
#[derive(Debug, Clone, PartialEq)]
pub struct ByDirection {
    /// Of each bearing, in radians counter-clockwise from east.
    pub headings: Vec<f64>,
    /// How many harmonics.
    pub harmonics: usize,
    /// In every direction, in radians.
    pub sigma: f64,
    /// Means of the amplitudes, each in its own sigma.
    pub mean: DVector<f64>,
    /// A root of their covariance.
    pub root: DMatrix<f64>,
}

impl ByDirection {
    /// One of which nothing else is known.
    pub fn new(headings: Vec<f64>, harmonics: usize, sigma: f64) -> Self {
        let count = 1 + 2 * harmonics;
        Self {
            headings,
            harmonics,
            sigma,
            mean: DVector::zeros(count),
            root: DMatrix::identity(count, count),
        }
    }

    /// How far each of the independent biases turns a bearing on a source in a direction, relative to the bow; and all of
    /// them in the mean.
    pub(super) fn turns(&self, relative: f64) -> (Vec<f64>, f64) {
        let terms = turns(relative, self.harmonics, self.sigma);
        let terms = DVector::from_iterator(self.mean.len(), terms);
        let independent = self.root.tr_mul(&terms);
        (independent.iter().copied().collect(), terms.dot(&self.mean))
    }

    /// The biases of `sights` if the source is in these directions from them, in radians counter-clockwise from east; and the
    /// sights less what is expected of the biases.
    pub(super) fn as_if(&self, sights: &[Sight], directions: &[f64]) -> (Vec<Sight>, Biases) {
        let places = directions.iter().zip(&self.headings);
        let (turns, means): (Vec<_>, Vec<_>) = places
            .map(|(direction, heading)| self.turns(direction - heading))
            .unzip();
        let less = |(sight, mean): (&Sight, f64)| Sight {
            bearing: sight.bearing - mean,
            ..*sight
        };
        let sights = sights.iter().zip(means).map(less).collect();
        (sights, Biases::Turns(turns))
    }

    /// No bias turns a bearing by more than this, all as a norm; nor does it change by more than this per radian. And the
    /// same of their mean.
    pub(super) fn largest(&self) -> ([f64; 2], f64) {
        let each = self.sigma / (1.0 + self.harmonics as f64).sqrt();
        let squares: usize = (1..=self.harmonics).map(|k| k * k).sum();
        let steepest = each * (squares as f64).sqrt();
        let root = self.root.norm();
        (
            [self.sigma * root, steepest * root],
            steepest * self.mean.norm(),
        )
    }
}

/// Where a source is expected before any bearing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Prior {
    /// Anywhere in the square in which it is sought.
    #[default]
    Flat,
    /// With a density in proportion to 1 / ((1 + r^2 / a^2) (1 + r^2 / R^2)) at a distance r from the centre: about as likely
    /// within any factor of range.
    Ranged {
        /// In metres east and north.
        centre: [f64; 2],
        /// a, in metres.
        nearest_m: f64,
        /// R, in metres.
        range_m: f64,
    },
}

impl Prior {
    /// Logarithm of the density at a place, per square metre; of a flat one, zero.
    pub(super) fn log(&self, place: Vector2<f64>) -> f64 {
        match *self {
            Self::Flat => 0.0,
            Self::Ranged { centre, .. } => {
                self.log_at((place - Vector2::from(centre)).norm_squared())
            }
        }
    }

    /// The largest in a cell, and how strongly its logarithm curves there at most, per square metre.
    pub(super) fn bound(&self, cell: &Cell) -> (f64, f64) {
        match *self {
            Self::Flat => (0.0, 0.0),
            Self::Ranged {
                centre,
                nearest_m,
                range_m,
            } => {
                let offset = (cell.centre - Vector2::from(centre)).abs() - cell.half;
                let square = offset.map(|d| d.max(0.0)).norm_squared();
                let curvature = |length: f64| 2.0 / (length * length + square);
                (
                    self.log_at(square),
                    curvature(nearest_m) + curvature(range_m),
                )
            }
        }
    }

    /// At the square of a distance from the centre.
    fn log_at(&self, square: f64) -> f64 {
        let Self::Ranged {
            nearest_m, range_m, ..
        } = *self
        else {
            return 0.0;
        };
        let [near, far] = [nearest_m, range_m].map(|length| length * length);
        // The integral over the plane.
        let whole = if near == far {
            far
        } else {
            near * (far / near).ln() / (1.0 - near / far)
        };
        -(PI * whole).ln() - (square / near).ln_1p() - (square / far).ln_1p()
    }
}

/// The terms of a bias of a mean and harmonics at a direction from the bow, each of which counts by a standard normal
/// amplitude: together it has this sigma everywhere, in radians.
pub fn turns(direction: f64, harmonics: usize, sigma: f64) -> impl Iterator<Item = f64> {
    let each = sigma / (1.0 + harmonics as f64).sqrt();
    let waves = (1..=harmonics).flat_map(move |k| {
        let (sin, cos) = (k as f64 * direction).sin_cos();
        [each * cos, each * sin]
    });
    std::iter::once(each).chain(waves)
}

/// A bias of this sigma for each of the places that `sights` were taken at.
pub fn biases_by_station(sights: &[Sight], sigma: f64) -> Biases {
    let mut stations: Vec<[f64; 2]> = Vec::new();
    for sight in sights {
        if !stations.contains(&sight.position) {
            stations.push(sight.position);
        }
    }
    let at = |sight: &Sight, station: &[f64; 2]| f64::from(u8::from(sight.position == *station));
    let one = |sight| stations.iter().map(|s| sigma * at(sight, s)).collect();
    Biases::Turns(sights.iter().map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prior_has_a_mass_of_one() {
        for nearest_m in [1.0, 30.0, 1000.0] {
            let prior = Prior::Ranged {
                centre: [3.0, -7.0],
                nearest_m,
                range_m: 1000.0,
            };
            // Over rings, each as wide as a hundredth of its radius.
            let mass: f64 = (-1500..2500)
                .map(|k| (f64::from(k) * 0.01).exp())
                .map(|r| {
                    let density = prior.log(Vector2::new(3.0 + r, -7.0)).exp();
                    2.0 * PI * r * r * 0.01 * density
                })
                .sum();
            assert!((mass - 1.0).abs() < 1e-3, "{mass}");
        }
    }

    #[test]
    fn a_bias_by_direction_is_as_large_everywhere() {
        for k in 0..50 {
            let square: f64 = turns(0.1 * f64::from(k), 2, 0.2).map(|t| t * t).sum();
            assert!((square - 0.04).abs() < 1e-12);
        }
    }
}
