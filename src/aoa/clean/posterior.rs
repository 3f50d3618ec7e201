//! What all bearings say.

use heapless::Vec;

use super::proposal::ModeProposal;
use crate::aoa::core::{BLOCK, Block, Buffer, Comparison, Entry, Target};
use crate::aoa::gauss_newton::{Errors, Linearised, SolveError, linearise, solve};
use crate::aoa::{BearingLikelihood, Observation};
use crate::math::{atan2, sin_cos, wrap};
use crate::model::Likelihood;

/// The likelihood of all bearings; under a flat prior, the posterior.
#[derive(Debug)]
pub struct Posterior<'a, const B: usize> {
    bearings: &'a Buffer<B>,
    likelihoods: Vec<BearingLikelihood, B>,
}

impl<'a, const B: usize> Posterior<'a, B> {
    // Once in flash.
    #[inline(never)]
    pub(super) fn new(bearings: &'a Buffer<B>) -> Self {
        let mut likelihoods = Vec::new();
        for observation in bearings.observations() {
            let _ = likelihoods.push(BearingLikelihood::new(observation));
        }
        Self {
            bearings,
            likelihoods,
        }
    }

    pub(super) fn bearings(&self) -> &'a Buffer<B> {
        self.bearings
    }
}

impl<const B: usize> Likelihood<2> for Posterior<'_, B> {
    #[inline(never)]
    fn log_likelihood(&self, point: &[f32; 2]) -> f32 {
        self.likelihoods
            .iter()
            .map(|likelihood| likelihood.log_likelihood(point))
            .sum()
    }
}

impl<const B: usize> Target<2> for Posterior<'_, B> {
    fn log_densities(&self, [x, y]: &Block<2>) -> [f32; BLOCK] {
        let mut sums = [0.0; BLOCK];
        let mut one = [0.0; BLOCK];
        for likelihood in &self.likelihoods {
            likelihood.log_likelihoods(&[x.as_slice(), y.as_slice()], &mut one);
            for (sum, one) in sums.iter_mut().zip(one) {
                *sum += one;
            }
        }
        sums
    }
}

/// Clean bearings never contradict each other.
pub(super) struct CleanBearings {
    pub(super) source: Option<[f32; 2]>,
}

impl Comparison for CleanBearings {
    fn source(&self) -> Option<[f32; 2]> {
        self.source
    }

    fn fold(&self, _: &Entry, _: &Entry, angle: f32) -> f32 {
        angle
    }

    fn is_similar(&self, _: &Entry, _: &Entry) -> bool {
        true
    }

    fn prefers(&self, _: &Entry, _: &Entry) -> bool {
        true
    }
}

/// What the bearings say to a source at `point`: the sum of the squares of their errors in sigmas.
#[inline(never)]
pub(super) fn misfit<const B: usize>(bearings: &Buffer<B>, point: [f32; 2]) -> f32 {
    let square = |o| {
        let Linearised {
            residual,
            information,
            ..
        } = linearise(o, point);
        information * residual * residual
    };
    bearings.observations().map(square).sum()
}

/// The same for a source so far away, in the direction that fits best, that all bearings are parallel; and the sum of
/// their information, 1 / sigma^2.
#[inline(never)]
pub(super) fn misfit_at_infinity<const B: usize>(bearings: &Buffer<B>) -> (f32, f32) {
    let mut sum = [0.0; 2];
    let mut total = 0.0;
    for o in bearings.observations() {
        let (sin, cos) = sin_cos(o.bearing().radians());
        sum[0] += o.information() * cos;
        sum[1] += o.information() * sin;
        total += o.information();
    }
    let direction = atan2(sum[1], sum[0]);
    let square = |o: &Observation| {
        let error = wrap(o.bearing().radians() - direction);
        o.information() * error * error
    };
    (bearings.observations().map(square).sum(), total)
}

/// The mode nearest to `start`, and the normal distribution that has its curvature.
#[inline(never)]
pub(super) fn mode<const B: usize>(
    bearings: &Buffer<B>,
    start: [f32; 2],
) -> Result<ModeProposal, SolveError> {
    let solution = solve(bearings.entries(), Errors::Gaussian, start)?;
    ModeProposal::new(solution.position, solution.covariance).ok_or(SolveError::Parallel)
}
