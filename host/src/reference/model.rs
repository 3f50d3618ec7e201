//! What the exact posterior takes for known of the errors and of the place.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::cell::Cell;
use crate::{Sight, faults::Faults, sight::wrap};

/// What is known of the bearings and of the place before any of them. By default: errors as stated, and nothing of the place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// The rates of outliers and of mirrored bearings, and the sigma of a bias of all.
    pub faults: Faults,
    /// All sigmas are as stated times exp(`scale_sigma` z), z standard normal, and one for all bearings. Zero: as stated.
    pub scale_sigma: f64,
    /// Biases, each of which is standard normal: for each bearing, how far each of them turns it, in radians. Empty: none but
    /// that of the faults.
    pub biases: Vec<Vec<f64>>,
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

    /// How far each bias turns each of `count` bearings, in radians.
    pub(super) fn turns(&self, count: usize) -> Vec<Vec<f64>> {
        assert!(
            self.biases.is_empty() || self.biases.len() == count,
            "biases of another number of bearings"
        );
        let common = Some(self.faults.bias_sigma).filter(|sigma| *sigma > 0.0);
        (0..count)
            .map(|k| {
                let own = self.biases.get(k).into_iter().flatten();
                own.copied().chain(common).collect()
            })
            .collect()
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

/// What a bias by direction does to each of `sights`: one of a mean and `harmonics` of the direction from the bow, of this sigma
/// in all directions, in radians. `headings` are in radians counter-clockwise from east.
pub fn biases_by_direction(
    sights: &[Sight],
    headings: &[f64],
    harmonics: usize,
    sigma: f64,
) -> Vec<Vec<f64>> {
    let one = |(sight, heading): (&Sight, &f64)| {
        turns(wrap(sight.bearing - heading), harmonics, sigma).collect()
    };
    sights.iter().zip(headings).map(one).collect()
}

/// The terms of such a bias at a direction from the bow.
pub fn turns(direction: f64, harmonics: usize, sigma: f64) -> impl Iterator<Item = f64> {
    let each = sigma / (1.0 + harmonics as f64).sqrt();
    let waves = (1..=harmonics).flat_map(move |k| {
        let (sin, cos) = (k as f64 * direction).sin_cos();
        [each * cos, each * sin]
    });
    std::iter::once(each).chain(waves)
}

/// A bias of this sigma for each of the places that `sights` were taken at.
pub fn biases_by_station(sights: &[Sight], sigma: f64) -> Vec<Vec<f64>> {
    let mut stations: Vec<[f64; 2]> = Vec::new();
    for sight in sights {
        if !stations.contains(&sight.position) {
            stations.push(sight.position);
        }
    }
    let at = |sight: &Sight, station: &[f64; 2]| f64::from(u8::from(sight.position == *station));
    (sights.iter())
        .map(|sight| (stations.iter()).map(|s| sigma * at(sight, s)).collect())
        .collect()
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
