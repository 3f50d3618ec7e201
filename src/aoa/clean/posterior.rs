//! What all bearings say, and what moves the particles by it when they have become too few.

use core::fmt::Debug;

use heapless::Vec;

use crate::ConfigError;
use crate::aoa::core::{BLOCK, Block, Buffer, Proposal, Target, sweep};
use crate::aoa::triangulation::{gauss_newton, linearise};
use crate::aoa::{BearingLikelihood, Observation};
use crate::estimate::Symmetric2;
use crate::filter::ParticleFilter;
use crate::math::{atan2, sin_cos, sqrt, wrap};
use crate::model::Likelihood;
use crate::random::{Rng, normal};
use crate::refine::{Memory, Refinement};
use crate::resample::Scheme;

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

/// What the bearings say to a source at `point`: the sum of the squares of their errors in sigmas.
#[inline(never)]
pub(super) fn misfit<const B: usize>(bearings: &Buffer<B>, point: [f32; 2]) -> f32 {
    let square = |o| {
        let line = linearise(o, point);
        line.information * line.residual * line.residual
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
pub(super) fn mode<const B: usize>(bearings: &Buffer<B>, start: [f32; 2]) -> Option<ModeProposal> {
    let (position, covariance) = gauss_newton(bearings.entries(), start)?;
    ModeProposal::new(position, covariance)
}

/// A normal distribution about the mode, to propose from.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModeProposal {
    mean: [f32; 2],
    /// Lower triangle of the Cholesky factor of the covariance: xx, yx, yy.
    factor: [f32; 3],
}

impl ModeProposal {
    /// `None` when the covariance is not positive definite.
    pub(super) fn new(mean: [f32; 2], covariance: impl Into<Symmetric2>) -> Option<Self> {
        let Symmetric2 { xx, xy, yy } = covariance.into();
        let l_xx = sqrt(xx);
        let l_yx = xy / l_xx;
        let l_yy = sqrt(yy - l_yx * l_yx);
        let proper = l_xx > 0.0 && l_yy > 0.0 && l_xx <= f32::MAX && l_yy <= f32::MAX;
        proper.then_some(Self {
            mean,
            factor: [l_xx, l_yx, l_yy],
        })
    }

    pub(super) fn mean(&self) -> [f32; 2] {
        self.mean
    }

    pub(super) fn covariance(&self) -> Symmetric2 {
        let [xx, yx, yy] = self.factor;
        Symmetric2 {
            xx: xx * xx,
            xy: xx * yx,
            yy: yx * yx + yy * yy,
        }
    }

    /// A point about `from`, `scale` times as far as a draw is from the mean.
    pub(super) fn step<R: Rng + ?Sized>(
        &self,
        from: [f32; 2],
        scale: f32,
        rng: &mut R,
    ) -> [f32; 2] {
        let [xx, yx, yy] = self.factor;
        let (u, v) = (scale * normal(rng), scale * normal(rng));
        [from[0] + xx * u, from[1] + yx * u + yy * v]
    }
}

impl Proposal<2> for ModeProposal {
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> [f32; 2] {
        self.step(self.mean, INDEPENDENT_SCALE, rng)
    }

    fn log_density(&self, [x, y]: &[f32; 2]) -> f32 {
        let [xx, yx, yy] = self.factor;
        let u = (x - self.mean[0]) / xx;
        let v = (y - self.mean[1] - yx * u) / yy;
        -0.5 / (INDEPENDENT_SCALE * INDEPENDENT_SCALE) * (u * u + v * v)
    }

    fn walk<R: Rng + ?Sized>(&self, from: &[f32; 2], rng: &mut R) -> [f32; 2] {
        self.step(*from, WALK_SCALE, rng)
    }
}

/// Scale of draws that do not depend on where a particle is: wider than one reaches the tails of a posterior of bearings,
/// for fewer that are accepted.
const INDEPENDENT_SCALE: f32 = 1.25;

/// The best scale of a random walk in two dimensions: 2.38 / sqrt(2) (Gelman, Roberts and Gilks 1996).
const WALK_SCALE: f32 = 1.68;

/// What may move the particles of a locator: nothing but its own moves, `()`, or any [`Refinement`] of a position.
pub trait Moves<const N: usize>: Copy + PartialEq + Debug {
    /// What it works in.
    type Memory: Debug + Clone;

    /// An unused memory.
    const EMPTY: Self::Memory;

    /// Checks the configuration.
    fn check(&self) -> Result<(), ConfigError>;

    /// Resamples the particles and moves them by what the bearings say.
    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        memory: &mut Self::Memory,
        rng: &mut R,
    );
}

/// Draws about the mode of the posterior and steps of a random walk, in turns, accepted by Metropolis and Hastings. They
/// need no memory.
impl<const N: usize> Moves<N> for () {
    type Memory = ();

    const EMPTY: () = ();

    fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }

    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        (): &mut (),
        rng: &mut R,
    ) {
        let mean = filter.mean();
        let proposal =
            mode(posterior.bearings, mean).or_else(|| ModeProposal::new(mean, filter.covariance()));
        filter.resample(Scheme::Systematic, rng);
        if let Some(proposal) = proposal {
            sweep(filter.columns_mut(), posterior, &proposal, moves, rng);
        }
    }
}

/// A refinement moves particles by the differences between them. Where they are worth fewer than this, copies of a single
/// one would stay together for ever, and the moves about the mode part them first: less leaves copies, more takes time.
const COMPANY: f32 = 8.0;

impl<const N: usize, F: Refinement<2> + Copy + PartialEq + Debug> Moves<N> for F {
    type Memory = Memory<2, N>;

    const EMPTY: Self::Memory = Memory::EMPTY;

    fn check(&self) -> Result<(), ConfigError> {
        Refinement::check(self)
    }

    fn rejuvenate<const B: usize, R: Rng + ?Sized>(
        &self,
        filter: &mut ParticleFilter<2, N>,
        posterior: &Posterior<'_, B>,
        moves: u8,
        memory: &mut Self::Memory,
        rng: &mut R,
    ) {
        if filter.effective_sample_size() < COMPANY {
            ().rejuvenate(filter, posterior, moves, &mut (), rng);
        } else {
            filter.resample(Scheme::Systematic, rng);
        }
        filter.refine(self, posterior, memory, rng);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aoa::Bearing;
    use crate::aoa::core::Entry;
    use crate::math::ln;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, uniform, uniform_open};
    use std::vec::Vec;

    #[test]
    fn a_proposal_has_the_covariance_that_it_was_made_of() {
        let covariance = [[9.0, 2.0], [2.0, 4.0]];
        let proposal = ModeProposal::new([1.0, 2.0], covariance).unwrap();
        let got = proposal.covariance().rows();
        assert!((0..2).all(|a| (0..2).all(|b| (got[a][b] - covariance[a][b]).abs() < 1e-5)));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(41);
        let draws: Vec<[f32; 2]> = (0..100_000)
            .map(|_| proposal.step(proposal.mean(), 1.0, &mut rng))
            .collect();
        let moment = |f: fn(f32, f32) -> f32| {
            draws
                .iter()
                .map(|d| f64::from(f(d[0] - 1.0, d[1] - 2.0)))
                .sum::<f64>()
                / 1e5
        };
        // Four standard errors of the moments.
        assert!((moment(|x, _| x * x) - 9.0).abs() < 0.17);
        assert!((moment(|_, y| y * y) - 4.0).abs() < 0.08);
        assert!((moment(|x, y| x * y) - 2.0).abs() < 0.09);
        for flat in [
            [[1.0, 1.0], [1.0, 1.0]],
            [[0.0, 0.0], [0.0, 1.0]],
            [[f32::NAN; 2]; 2],
        ] {
            assert!(ModeProposal::new([0.0, 0.0], flat).is_none());
        }
    }

    /// Two bearings that cross at 15 degrees with errors of 3: the posterior is far from normal.
    fn skewed() -> Buffer<4> {
        let mut bearings = Buffer::EMPTY;
        for (time_ms, east, degrees) in [(0, -130.0f32, 7.5f32), (1, 130.0, -7.5)] {
            let bearing = Bearing::from_compass_degrees(degrees);
            let sigma = 3f32.to_radians();
            let observation = Observation::new(time_ms, [east, 0.0], bearing, sigma).unwrap();
            bearings.add(Entry::new(observation, 1.0), &None);
        }
        bearings
    }

    #[test]
    fn moves_leave_the_posterior_invariant() {
        let bearings = skewed();
        let proposal = mode(&bearings, [0.0, 900.0]).unwrap();
        let evidence = Posterior::new(&bearings);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(42);
        // Exact draws by rejection from a wide box, which holds all but a negligible part of the posterior.
        const N: usize = 20_000;
        let peak = evidence.log_likelihood(&proposal.mean());
        let mut exact = [Vec::new(), Vec::new()];
        while exact[0].len() < N {
            let point = [
                600.0 * uniform(&mut rng) - 300.0,
                8000.0 * uniform(&mut rng),
            ];
            if ln(uniform_open(&mut rng)) < evidence.log_likelihood(&point) - peak {
                exact[0].push(point[0]);
                exact[1].push(point[1]);
            }
        }
        for moves in [1, 2, 5] {
            let mut moved = exact.clone();
            let [x, y] = &mut moved;
            sweep([x, y], &evidence, &proposal, moves, &mut rng);
            assert_ne!(moved, exact);
            for (before, after) in exact.iter().zip(&mut moved) {
                // Two-sample Kolmogorov-Smirnov: six tests at 1.95, one false alarm in 170 seeds.
                let mut before = before.clone();
                before.sort_by(f32::total_cmp);
                after.sort_by(f32::total_cmp);
                let distance = (0..N)
                    .map(|i| {
                        let below = after.partition_point(|&v| v <= before[i]);
                        (below as f64 - (i + 1) as f64).abs() / N as f64
                    })
                    .fold(0.0, f64::max);
                assert!(
                    distance * (N as f64 / 2.0).sqrt() < 1.95,
                    "{moves} moves: {distance}"
                );
            }
        }
    }
}
