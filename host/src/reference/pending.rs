//! A part of the plane that may yet have to be summed.

use std::cmp::Ordering;

use nalgebra::Vector2;

use super::{cell::Cell, likelihood::Likelihood};

/// A cell, ordered by what it can hold.
pub(super) struct Pending {
    pub cell: Cell,
    /// Logarithm of the most that the integral of the likelihood over it can be.
    pub log_mass: f64,
    /// Its sides in standard deviations of a normal density that curves as strongly as the likelihood can.
    pub widths: Vector2<f64>,
}

impl Pending {
    pub fn new(cell: Cell, likelihood: &Likelihood) -> Self {
        let bound = likelihood.bound(&cell);
        Self {
            cell,
            log_mass: bound.log + cell.area().ln(),
            widths: 2.0 * cell.half.component_mul(&bound.curvature.map(f64::sqrt)),
        }
    }
}

impl Ord for Pending {
    fn cmp(&self, other: &Self) -> Ordering {
        self.log_mass.total_cmp(&other.log_mass)
    }
}

impl PartialOrd for Pending {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Pending {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Pending {}
