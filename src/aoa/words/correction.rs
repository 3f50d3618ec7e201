//! What is known of the error of a bearing.

use super::observation::Observation;
use crate::math::{larger, smaller, sqrt};
use crate::snapshot::{by_value, value_as};

/// What was taken off a bearing, and how well that was known. All bits are zero where nothing was.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::aoa) struct Correction {
    /// What was taken off, in radians.
    pub(in crate::aoa) offset: f32,
    /// What was added to the stated variance, in square radians.
    pub(in crate::aoa) variance: f32,
}

value_as!(Correction as (f32, f32):
    |taken| (taken.offset, taken.variance),
    |(offset, variance)| {
        let is_one = offset.is_finite() && variance.is_finite();
        is_one.then_some(Self { offset, variance })
    },
);

by_value!(Correction);

impl Correction {
    pub(in crate::aoa) const NONE: Self = Self {
        offset: 0.0,
        variance: 0.0,
    };

    /// A bearing that was corrected by this, corrected by `next` instead. A sigma that would be out of range is the nearest
    /// one that is not.
    #[inline(never)]
    pub(in crate::aoa) fn replace(&mut self, next: &Self, bearing: &Observation) -> Observation {
        let stated = self.stated_variance(bearing);
        let sigma = smaller(sqrt(stated + next.variance), Observation::MAX_SIGMA_RAD);
        let turned = bearing.turned_by(self.offset - next.offset);
        *self = Self {
            offset: next.offset,
            variance: sigma * sigma - stated,
        };
        turned.with_sigma(sigma)
    }

    /// The variance of a bearing as it was stated, before it was corrected by this.
    pub(in crate::aoa) fn stated_variance(&self, bearing: &Observation) -> f32 {
        const LEAST: f32 = Observation::MIN_SIGMA_RAD * Observation::MIN_SIGMA_RAD;
        let sigma = bearing.sigma_rad();
        larger(sigma * sigma - self.variance, LEAST)
    }

    /// What lies `part` of the way to another.
    pub(in crate::aoa) fn mixed(self, other: &Self, part: f32) -> Self {
        let mix = |a: f32, b: f32| a + part * (b - a);
        Self {
            offset: mix(self.offset, other.offset),
            variance: mix(self.variance, other.variance),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aoa::Bearing;

    #[test]
    fn a_correction_can_be_taken_back() {
        let stated = Observation::new(7, [1.0, 2.0], Bearing::from_radians(3.0), 0.03).unwrap();
        let mut correction = Correction::NONE;
        let mut bearing = stated;
        for (offset, variance) in [(0.2, 0.01), (-0.4, 0.0), (0.1, 0.002)] {
            let next = Correction { offset, variance };
            bearing = correction.replace(&next, &bearing);
            let turn = crate::math::wrap(stated.bearing().radians() - bearing.bearing().radians());
            assert!((turn - offset).abs() < 1e-6);
            let sigma = (0.03_f32 * 0.03 + variance).sqrt();
            assert!((bearing.sigma_rad() - sigma).abs() < 1e-6);
        }
        bearing = correction.replace(&Correction::NONE, &bearing);
        assert!((bearing.bearing().radians() - 3.0).abs() < 1e-6);
        assert!((bearing.sigma_rad() - 0.03).abs() < 1e-6);
    }

    #[test]
    fn no_sigma_is_out_of_range() {
        let stated = Observation::new(7, [1.0, 2.0], Bearing::from_radians(3.0), 0.03).unwrap();
        let mut correction = Correction::NONE;
        let wide = Correction {
            offset: 0.0,
            variance: 100.0,
        };
        let bearing = correction.replace(&wide, &stated);
        assert_eq!(bearing.sigma_rad(), Observation::MAX_SIGMA_RAD);
        let variance = correction.stated_variance(&bearing);
        assert!((variance / (0.03 * 0.03) - 1.0).abs() < 1e-3);
    }
}
