//! The likelihood of a bearing.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use super::Observation;
use crate::math::{LN_TAU, atan_coarse, ln, sin_cos};
use crate::model::Likelihood;

/// A bearing with a normally distributed error, wrapped round the circle.
///
/// Works on any state whose first two dimensions are metres east and north. Needs no `atan2` and no wrapping
/// for each particle: the offset of the particle from the receiver is turned by the bearing, so that its
/// direction is the error itself, between 0 and pi either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingLikelihood {
    position: [f32; 2],
    sin: f32,
    cos: f32,
    /// -1 / (2 sigma^2)
    curvature: f32,
    /// -ln(sigma sqrt(2 pi))
    pub(super) peak: f32,
}

/// Added to a distance: the ratio is finite for a particle at the receiver, too, and its error is zero. The product of four
/// of these, and that of four of the largest distances, is still a normal number.
const TINY_M: f32 = 1e-7;

impl BearingLikelihood {
    /// Of an observed bearing.
    pub fn new(observation: &Observation) -> Self {
        let (sin, cos) = sin_cos(observation.bearing().radians());
        let sigma = observation.sigma_rad();
        Self {
            position: observation.position(),
            sin,
            cos,
            curvature: -0.5 / (sigma * sigma),
            peak: -ln(sigma) - 0.5 * LN_TAU,
        }
    }

    /// Components of the offset along and across the bearing.
    #[inline(always)]
    fn turn(&self, x: f32, y: f32) -> (f32, f32) {
        let (dx, dy) = (x - self.position[0], y - self.position[1]);
        (dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin)
    }

    #[inline(never)]
    fn one_by_one(&self, x: &[f32], y: &[f32], out: &mut [f32]) {
        for ((x, y), out) in x.iter().zip(y).zip(out) {
            *out = Likelihood::<2>::log_likelihood(self, &[*x, *y]);
        }
    }

    /// Log-likelihood from the component along the bearing and the ratio that stands for the angle.
    #[inline(always)]
    fn of_ratio(&self, along: f32, ratio: f32) -> f32 {
        let beyond_normal = atan_coarse(ratio) - FRAC_PI_4;
        // Half a turn less the angle, for a particle behind the receiver.
        let error = if along < 0.0 {
            FRAC_PI_2 - beyond_normal
        } else {
            FRAC_PI_2 + beyond_normal
        };
        self.peak + self.curvature * (error * error)
    }
}

/// Numerator and denominator of tan(angle - pi/4), which is within [-1, 1] for any offset.
#[inline(always)]
fn fraction(along: f32, across: f32) -> (f32, f32) {
    let (along, across) = (along.abs() + TINY_M, across.abs());
    (across - along, across + along)
}

impl<const D: usize> Likelihood<D> for BearingLikelihood {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        const { assert!(D >= 2, "a position takes two dimensions") };
        let (along, across) = self.turn(state[0], state[1]);
        let (numerator, denominator) = fraction(along, across);
        self.of_ratio(along, numerator / denominator)
    }

    /// Four particles share one division: a Cortex-M4F takes 14 cycles for it, and one for a product.
    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        const { assert!(D >= 2, "a position takes two dimensions") };
        // The shortest column decides.
        let n = columns[0].len().min(columns[1].len()).min(out.len());
        let (x_blocks, x_rest) = columns[0].get(..n).unwrap_or_default().as_chunks::<4>();
        let (y_blocks, y_rest) = columns[1].get(..n).unwrap_or_default().as_chunks::<4>();
        let out = out.get_mut(..n).unwrap_or_default();
        let (out_blocks, out_rest) = out.as_chunks_mut::<4>();
        for ((x, y), out) in x_blocks.iter().zip(y_blocks).zip(out_blocks) {
            let (along0, across0) = self.turn(x[0], y[0]);
            let (along1, across1) = self.turn(x[1], y[1]);
            let (along2, across2) = self.turn(x[2], y[2]);
            let (along3, across3) = self.turn(x[3], y[3]);
            let (n0, d0) = fraction(along0, across0);
            let (n1, d1) = fraction(along1, across1);
            let (n2, d2) = fraction(along2, across2);
            let (n3, d3) = fraction(along3, across3);
            let (d01, d23) = (d0 * d1, d2 * d3);
            let inverse = 1.0 / (d01 * d23);
            if !(inverse > 0.0 && inverse <= f32::MAX) {
                // One that is infinite or NaN would make the others infinite or NaN, too.
                self.one_by_one(x, y, out);
                continue;
            }
            let (inverse01, inverse23) = (d23 * inverse, d01 * inverse);
            out[0] = self.of_ratio(along0, n0 * (d1 * inverse01));
            out[1] = self.of_ratio(along1, n1 * (d0 * inverse01));
            out[2] = self.of_ratio(along2, n2 * (d3 * inverse23));
            out[3] = self.of_ratio(along3, n3 * (d2 * inverse23));
        }
        self.one_by_one(x_rest, y_rest, out_rest);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aoa::Bearing;
    use std::{vec, vec::Vec};

    fn likelihood(position: [f32; 2], degrees: f32, sigma: f32) -> BearingLikelihood {
        let bearing = Bearing::from_radians(degrees.to_radians());
        BearingLikelihood::new(&Observation::new(0, position, bearing, sigma).unwrap())
    }

    fn exact(position: [f32; 2], degrees: f32, sigma: f32, [x, y]: [f32; 2]) -> f64 {
        let bearing = f64::from(degrees.to_radians());
        let direction = f64::from(y - position[1]).atan2(f64::from(x - position[0]));
        let tau = core::f64::consts::TAU;
        let error = (direction - bearing) - tau * ((direction - bearing) / tau).round();
        let z = error / f64::from(sigma);
        -0.5 * z * z - (f64::from(sigma) * tau.sqrt()).ln()
    }

    #[test]
    fn at_the_receiver_every_direction_is_right() {
        let here = likelihood([0.0; 2], 0.0, 0.1);
        for x in [0.0, 5e-8, 1e-7, 2e-7] {
            let found = Likelihood::<2>::log_likelihood(&here, &[x, 0.0]);
            assert!((found - here.peak).abs() < 1e-3, "{x}: {found}");
        }
    }

    /// Offsets all round the receiver, from a decimetre to a hundred kilometres.
    fn places() -> Vec<[f32; 2]> {
        let mut places = vec![];
        for ring in 0..7 {
            let radius = 0.1 * 10f32.powi(ring);
            for i in 0..203 {
                let angle = i as f32 * 0.031;
                places.push([radius * angle.cos() + 3.0, radius * angle.sin() - 2.0]);
            }
        }
        places
    }

    #[test]
    fn the_log_likelihood_is_that_of_atan2_and_wrapping() {
        for degrees in [-180.0, -91.0, 0.0, 33.0, 90.0, 135.0, 179.9] {
            for sigma in [0.01f32, 0.05, 1.0] {
                let likelihood = likelihood([3.0, -2.0], degrees, sigma);
                for place in places() {
                    let got = f64::from(Likelihood::<2>::log_likelihood(&likelihood, &place));
                    let exact = exact([3.0, -2.0], degrees, sigma, place);
                    // An error of 2e-5 rad in the angle moves the logarithm by z / sigma times it.
                    let z = (2.0 * (f64::from(likelihood.peak) - exact).abs()).sqrt() + 1.0;
                    let limit = 2e-5 * z / f64::from(sigma) + 1e-5 * (1.0 + exact.abs());
                    assert!(
                        (got - exact).abs() < limit,
                        "{degrees} {sigma} {place:?}: {got} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn columns_get_the_likelihood_of_each_particle() {
        let likelihood = likelihood([3.0, -2.0], 33.0, 0.05);
        let places = places();
        let x: Vec<f32> = places.iter().map(|p| p[0]).collect();
        let y: Vec<f32> = places.iter().map(|p| p[1]).collect();
        let mut out = vec![0.0; places.len()];
        likelihood.log_likelihoods(&[&x, &y], &mut out);
        for (place, got) in places.iter().zip(out) {
            let one = Likelihood::<2>::log_likelihood(&likelihood, place);
            assert!(
                (got - one).abs() <= 2e-5 * (1.0 + one.abs()),
                "{place:?}: {got} {one}"
            );
        }
    }

    #[test]
    fn a_particle_at_the_receiver_or_far_away_has_a_finite_likelihood() {
        let likelihood = likelihood([3.0, -2.0], 33.0, 0.05);
        let (x, y) = ([3.0, 3.0, 1e9, 3.0, 3.0], [-2.0, -2.0, -1e9, -2.0, -2.0]);
        let mut out = [f32::NAN; 5];
        likelihood.log_likelihoods(&[&x, &y], &mut out);
        assert!(out.iter().all(|l| l.is_finite()), "{out:?}");
        for lost in [f32::NAN, f32::INFINITY, 1e30] {
            let x = [0.0, 1.0, lost, 2.0];
            likelihood.log_likelihoods(&[&x, &[5.0; 4]], &mut out[..4]);
            assert!(
                [out[0], out[1], out[3]].iter().all(|l| l.is_finite()),
                "{lost}: {out:?}"
            );
        }
        likelihood.log_likelihoods(&[&[3.0; 5], &[-2.0; 5]], &mut out);
        assert!((out[0] - likelihood.peak).abs() < 1e-3);
    }
}
