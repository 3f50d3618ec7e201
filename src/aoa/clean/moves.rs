//! Metropolis-Hastings moves of the particles against the posterior of all bearings.

use super::evidence::Evidence;
use crate::math::{ln, sqrt};
use crate::random::{Rng, normal, uniform_open};

/// A normal distribution about the mode, to propose from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Proposal {
    mean: [f32; 2],
    /// Lower triangle of the Cholesky factor of the covariance: xx, yx, yy.
    factor: [f32; 3],
}

impl Proposal {
    /// `None` when the covariance is not positive definite.
    pub(super) fn new(mean: [f32; 2], covariance: [[f32; 2]; 2]) -> Option<Self> {
        let [[xx, xy], [_, yy]] = covariance;
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

    pub(super) fn covariance(&self) -> [[f32; 2]; 2] {
        let [xx, yx, yy] = self.factor;
        [[xx * xx, xx * yx], [xx * yx, yx * yx + yy * yy]]
    }

    pub(super) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> [f32; 2] {
        self.step(self.mean, 1.0, rng)
    }

    /// A point about `from`, `scale` times as far as a draw is from the mean.
    fn step<R: Rng + ?Sized>(&self, from: [f32; 2], scale: f32, rng: &mut R) -> [f32; 2] {
        let [xx, yx, yy] = self.factor;
        let (u, v) = (scale * normal(rng), scale * normal(rng));
        [from[0] + xx * u, from[1] + yx * u + yy * v]
    }

    /// Log-density, up to a constant, of a step from the mean with [`INDEPENDENT_SCALE`].
    fn log_density(&self, [x, y]: [f32; 2]) -> f32 {
        let [xx, yx, yy] = self.factor;
        let u = (x - self.mean[0]) / xx;
        let v = (y - self.mean[1] - yx * u) / yy;
        -0.5 / (INDEPENDENT_SCALE * INDEPENDENT_SCALE) * (u * u + v * v)
    }
}

/// Draws that do not depend on where a particle is are spread a little wider than the curvature at the mode, as
/// the tails of a posterior of bearings are.
const INDEPENDENT_SCALE: f32 = 1.25;

/// The best scale of a random walk in two dimensions: 2.38 / sqrt(2) (Gelman, Roberts and Gilks 1996).
const WALK_SCALE: f32 = 1.68;

/// Particles that are moved together, to evaluate each bearing on a short column of them.
const BLOCK: usize = 16;

/// Moves every particle `moves` times: in turns by a draw about the mode, which forgets where it was, and by a
/// step of a random walk, which finds its way where the posterior is not normal. The generator is drawn from
/// the same number of times whatever is accepted.
pub(super) fn sweep<R: Rng + ?Sized, const B: usize>(
    [x, y]: [&mut [f32]; 2],
    evidence: &Evidence<B>,
    proposal: &Proposal,
    moves: u8,
    rng: &mut R,
) {
    for (x, y) in x.chunks_mut(BLOCK).zip(y.chunks_mut(BLOCK)) {
        // A short block is filled up with the mode.
        let mut here = [[proposal.mean[0]; BLOCK], [proposal.mean[1]; BLOCK]];
        transfer(x, &mut here[0]);
        transfer(y, &mut here[1]);
        let mut density = evidence.log_densities(&here);
        for turn in 0..moves {
            step(
                &mut here,
                &mut density,
                evidence,
                proposal,
                turn % 2 == 0,
                rng,
            );
        }
        transfer(&here[0], x);
        transfer(&here[1], y);
    }
}

/// Copies as much as there is room for.
fn transfer(from: &[f32], to: &mut [f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// One Metropolis-Hastings step of every particle of a block.
fn step<R: Rng + ?Sized, const B: usize>(
    here: &mut [[f32; BLOCK]; 2],
    density: &mut [f32; BLOCK],
    evidence: &Evidence<B>,
    proposal: &Proposal,
    independent: bool,
    rng: &mut R,
) {
    let mut there = [[0.0; BLOCK]; 2];
    // Log-density of proposing the way back, less that of the way there.
    let mut way_back = [0.0; BLOCK];
    for i in 0..BLOCK {
        let from = [here[0][i], here[1][i]];
        let to = if independent {
            let to = proposal.step(proposal.mean, INDEPENDENT_SCALE, rng);
            way_back[i] = proposal.log_density(from) - proposal.log_density(to);
            to
        } else {
            proposal.step(from, WALK_SCALE, rng)
        };
        [there[0][i], there[1][i]] = to;
    }
    let density_there = evidence.log_densities(&there);
    for i in 0..BLOCK {
        let log_ratio = density_there[i] - density[i] + way_back[i];
        // NaN is no reason to move.
        if ln(uniform_open(rng)) < log_ratio {
            [here[0][i], here[1][i]] = [there[0][i], there[1][i]];
            density[i] = density_there[i];
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aoa::{Bearing, Observation};
    use crate::model::Likelihood;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, uniform};
    use std::vec::Vec;

    #[test]
    fn a_proposal_has_the_covariance_that_it_was_made_of() {
        let covariance = [[9.0, 2.0], [2.0, 4.0]];
        let proposal = Proposal::new([1.0, 2.0], covariance).unwrap();
        let got = proposal.covariance();
        assert!((0..2).all(|a| (0..2).all(|b| (got[a][b] - covariance[a][b]).abs() < 1e-5)));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(41);
        let draws: Vec<[f32; 2]> = (0..100_000).map(|_| proposal.draw(&mut rng)).collect();
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
            assert!(Proposal::new([0.0, 0.0], flat).is_none());
        }
    }

    /// Two bearings that cross at 15 degrees with errors of 3: the posterior is far from normal.
    fn skewed() -> Evidence<4> {
        let mut evidence = Evidence::EMPTY;
        for (time_ms, east, degrees) in [(0, -130.0f32, 7.5f32), (1, 130.0, -7.5)] {
            let bearing = Bearing::from_compass_degrees(degrees);
            let sigma = 3f32.to_radians();
            evidence.push(
                &Observation::new(time_ms, [east, 0.0], bearing, sigma).unwrap(),
                None,
            );
        }
        evidence
    }

    #[test]
    fn moves_leave_the_posterior_invariant() {
        let evidence = skewed();
        let proposal = evidence.mode([0.0, 900.0]).unwrap();
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
