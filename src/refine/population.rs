//! Particles, their log-densities, and the three ways to take a place that is offered: common to all refinements.

use core::ops::Range;

use super::lengths::{Lengths, Scale};
use crate::math::ln;
use crate::math::vector::{difference, dot, square};
use crate::model::Likelihood;
use crate::particles::{read, write};
use crate::random::{Rng, uniform, uniform_open};

/// What a refinement did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// Iterations, or generations; fewer than were asked for if it stopped early.
    pub iterations: usize,
    /// Evaluations of the density.
    pub evaluations: usize,
    /// Places that particles were offered.
    pub proposals: usize,
    /// Places that they took.
    pub moves: usize,
}

/// The particles under refinement. A state and its density change together or not at all.
pub(super) struct Population<'a, 'c, const D: usize, T> {
    columns: &'a mut [&'c mut [f32]; D],
    /// Never NaN and never plus infinity.
    log_densities: &'a mut [f32],
    target: &'a T,
    pub(super) report: Report,
}

/// A place, and how the target likes it.
pub(super) struct Trial<const D: usize> {
    pub(super) state: [f32; D],
    pub(super) log_density: f32,
}

impl<'a, 'c, const D: usize, T: Likelihood<D>> Population<'a, 'c, D, T> {
    /// Evaluates the density of every particle that there is memory for.
    pub(super) fn new(
        columns: &'a mut [&'c mut [f32]; D],
        target: &'a T,
        log_densities: &'a mut [f32],
    ) -> Self {
        let shortest = columns.iter().map(|column| column.len()).min();
        let particles = log_densities.len().min(shortest.unwrap_or(0));
        let log_densities = log_densities.get_mut(..particles).unwrap_or_default();
        target.log_likelihoods(&columns.each_ref().map(|column| &**column), log_densities);
        for l in log_densities.iter_mut() {
            *l = possible(*l);
        }
        Self {
            columns,
            log_densities,
            target,
            report: Report {
                evaluations: particles,
                ..Report::default()
            },
        }
    }

    pub(super) fn len(&self) -> usize {
        self.log_densities.len()
    }

    pub(super) fn columns(&self) -> [&[f32]; D] {
        self.columns.each_ref().map(|column| &**column)
    }

    #[inline(always)]
    pub(super) fn state(&self, i: usize) -> [f32; D] {
        read(&self.columns(), i)
    }

    #[inline(always)]
    pub(super) fn log_density(&self, i: usize) -> f32 {
        self.log_densities
            .get(i)
            .copied()
            .unwrap_or(f32::NEG_INFINITY)
    }

    /// The particle of the highest density among `range`; none of them if all are impossible.
    pub(super) fn best(&self, range: Range<usize>) -> Option<usize> {
        let mut best = None;
        let mut highest = f32::NEG_INFINITY;
        for i in range {
            let log_density = self.log_density(i);
            if log_density > highest {
                (best, highest) = (Some(i), log_density);
            }
        }
        best
    }

    /// The highest density.
    pub(super) fn highest(&self) -> f32 {
        let best = self.best(0..self.len());
        best.map_or(f32::NEG_INFINITY, |i| self.log_density(i))
    }

    /// The unit of `lengths`, by the particles of `range`.
    pub(super) fn scale(&self, lengths: Lengths, range: Range<usize>) -> Scale<D> {
        let columns = self
            .columns
            .each_ref()
            .map(|column| column.get(range.clone()).unwrap_or_default());
        Scale::new(lengths, &columns)
    }

    /// Evaluates the density at `state`.
    #[inline(always)]
    pub(super) fn trial(&mut self, state: [f32; D]) -> Trial<D> {
        // Nothing times infinity or NaN is NaN.
        let finite = state.iter().map(|x| 0.0 * x).sum::<f32>() == 0.0;
        self.report.evaluations += usize::from(finite);
        let log_density = if finite {
            possible(self.target.log_likelihood(&state))
        } else {
            f32::NEG_INFINITY
        };
        Trial { state, log_density }
    }

    /// Moves particle `i` to any place that is possible.
    #[inline(always)]
    pub(super) fn go(&mut self, i: usize, trial: &Trial<D>) {
        self.offer(i, trial, trial.log_density > f32::NEG_INFINITY);
    }

    /// Moves particle `i` to a better place.
    #[inline(always)]
    pub(super) fn improve(&mut self, i: usize, trial: &Trial<D>) {
        self.offer(i, trial, trial.log_density > self.log_density(i));
    }

    /// Moves particle `i` with the probability of Metropolis and Hastings. `way_back` is the log-density of proposing
    /// the way back less that of the way there. Draws once, whatever comes of it.
    #[inline(always)]
    pub(super) fn metropolis<R: Rng + ?Sized>(
        &mut self,
        i: usize,
        trial: &Trial<D>,
        way_back: f32,
        rng: &mut R,
    ) {
        let log_ratio = trial.log_density - self.log_density(i) + way_back;
        // NaN, as between two impossible places, is no reason to move.
        self.offer(i, trial, ln(uniform_open(rng)) < log_ratio);
    }

    /// A Metropolis step of particle `i` along the line through `anchor`, by as much as two other particles are apart
    /// along it, times 1.2 to 2.2: the snooker update of ter Braak and Vrugt, "Differential evolution Markov
    /// chain with snooker updater and fewer chains" (2008). `anchor` must not depend on particle `i`.
    ///
    /// The lines through a point lie close together near it, so the way towards it is more likely than the way back,
    /// by the ratio of the distances to the power of D - 1.
    #[inline(always)]
    pub(super) fn snooker<R: Rng + ?Sized>(
        &mut self,
        i: usize,
        anchor: [f32; D],
        scale: &Scale<D>,
        rng: &mut R,
    ) {
        let Some([a, b]) = others(self.len(), i, rng) else {
            return;
        };
        let here = self.state(i);
        let line = scale.measure(difference(here, anchor));
        let apart = scale.measure(difference(self.state(a), self.state(b)));
        let factor = 1.2 + uniform(rng);
        // A part of the distance from the anchor; NaN, and thus rejected, for a particle that sits on it.
        let part = factor * dot(apart, line) / square(line);
        let trial = self.trial(scale.away(here, part, line));
        let way_back = (D as f32 - 1.0) * ln((1.0 + part).abs());
        self.metropolis(i, &trial, way_back, rng);
    }

    #[inline(always)]
    fn offer(&mut self, i: usize, trial: &Trial<D>, taken: bool) {
        self.report.proposals += 1;
        if !taken {
            return;
        }
        if let Some(log_density) = self.log_densities.get_mut(i) {
            *log_density = trial.log_density;
            write(self.columns, i, trial.state);
            self.report.moves += 1;
        }
    }
}

/// A log-density; minus infinity for what is none.
#[inline(always)]
fn possible(log_density: f32) -> f32 {
    // Not `log_density < INFINITY`: compiled to the vectors of a Cortex-M55, a comparison with "less than" a number that is
    // in no vector is true for NaN (LLVM 22).
    if 0.0 * log_density == 0.0 {
        log_density
    } else {
        f32::NEG_INFINITY
    }
}

/// Both halves of `n` particles, each with the other.
///
/// While one half moves, what the other one says (its spread, its best) is fixed. Were it measured on all
/// particles, it would change with the particle that moves, and the way back would not be the way there. Within
/// a half the particles move one after the other, each given all others as they are by then: such moves leave
/// each particle's own distribution invariant given the others, hence that of all together.
pub(super) fn halves(n: usize) -> [(Range<usize>, Range<usize>); 2] {
    let middle = n / 2;
    [(0..middle, middle..n), (middle..n, 0..middle)]
}

/// `K` different ones of `n` particles, in random order, none of them `i`. `None` if there are too few.
#[inline(always)]
pub(super) fn others<const K: usize, R: Rng + ?Sized>(
    n: usize,
    i: usize,
    rng: &mut R,
) -> Option<[usize; K]> {
    if n <= K {
        return None;
    }
    let mut taken = [usize::MAX; K];
    let mut chosen = [0; K];
    for (k, chosen) in chosen.iter_mut().enumerate() {
        // A rank among those left, counted on from the one behind i; then among all.
        let mut rank = below(n - 1 - k, rng);
        for taken in taken {
            if rank >= taken {
                rank += 1;
            }
        }
        let index = i + 1 + rank;
        *chosen = if index < n { index } else { index - n };
        // Keeps what is taken in order.
        for taken in &mut taken {
            if rank < *taken {
                core::mem::swap(taken, &mut rank);
            }
        }
    }
    Some(chosen)
}

/// Uniform on the integers below `n`, to within n / 2^32.
#[inline(always)]
fn below<R: Rng + ?Sized>(n: usize, rng: &mut R) -> usize {
    ((u64::from(rng.next_u32()) * n as u64) >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};

    #[test]
    fn a_place_beyond_all_numbers_is_impossible_and_not_looked_at() {
        let mut columns: [&mut [f32]; 2] = [&mut [0.0; 3], &mut [1.0; 3]];
        let (mut log_densities, target) = ([0.0; 3], |_: &[f32; 2]| 5.0);
        let mut population = Population::new(&mut columns, &target, &mut log_densities);
        assert_eq!(population.report.evaluations, 3);
        for state in [
            [f32::INFINITY, 1.0],
            [0.0, f32::NAN],
            [f32::MIN, f32::NEG_INFINITY],
        ] {
            assert_eq!(population.trial(state).log_density, f32::NEG_INFINITY);
        }
        assert_eq!(population.report.evaluations, 3);
        for state in [[0.0, -0.0], [f32::MAX, f32::MIN]] {
            assert_eq!(population.trial(state).log_density, 5.0);
        }
        assert_eq!(population.report.evaluations, 5);
        assert_eq!(population.highest(), 5.0);
    }

    #[test]
    fn others_are_different_and_each_order_is_as_likely() {
        // 24 orders of three out of four others, 1000 each on average: six of their sigmas of 31.
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(85);
        let mut counts = [[[0u32; 5]; 5]; 5];
        for _ in 0..24_000 {
            let [a, b, c] = others(5, 2, &mut rng).unwrap();
            counts[a][b][c] += 1;
        }
        for (a, counts) in counts.iter().enumerate() {
            for (b, counts) in counts.iter().enumerate() {
                for (c, count) in counts.iter().enumerate() {
                    let all_different = a != b && b != c && a != c && ![a, b, c].contains(&2);
                    let expected = if all_different { 814..1186 } else { 0..1 };
                    assert!(expected.contains(count), "{a} {b} {c}: {count}");
                }
            }
        }
        assert_eq!(others::<3, _>(3, 0, &mut rng), None);
        assert_eq!(others::<1, _>(0, 0, &mut rng), None);
    }
}
