//! Where particles are moved: about the mode of the posterior.

use crate::aoa::core::Proposal;
use crate::estimate::Symmetric2;
use crate::math::sqrt;
use crate::random::{Rng, normal};

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

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::posterior::{CleanBearings, Posterior, mode};
    use super::*;
    use crate::aoa::core::{Buffer, Entry, sweep};
    use crate::aoa::{Bearing, Observation};
    use crate::math::ln;
    use crate::model::Likelihood;
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
            bearings.add(
                Entry::new(observation, 1.0),
                &CleanBearings { source: None },
            );
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
