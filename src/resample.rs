//! Resampling: replace light particles by copies of heavy ones.
//!
//! Every scheme gives particle `i` an expected number of copies of exactly `N w_i`; they differ in the
//! variance of that number. All of them work in place, in time proportional to `N`, with no second cloud.
//!
//! All of them keep the particles in order, so that siblings stay neighbours. That matters: systematic and
//! stratified resampling spread their copies evenly over *neighbouring* particles, and a scheme that put
//! copies wherever a slot is free would lose that from the second step on, at the price of half as much
//! Monte Carlo variance again.

use crate::math::{ln, one_minus_exp};
use crate::random::{Rng, uniform, uniform_open};

/// How copies are allotted. In order of variance, smallest first, as a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Scheme {
    /// One random number; points 1/N apart. The usual choice.
    #[default]
    Systematic,
    /// One random point in every N-th of the total weight.
    Stratified,
    /// The whole part of `N w_i` for certain, the rest multinomial.
    Residual,
    /// `N` independent draws.
    Multinomial,
}

/// Chooses an ancestor for each of `ancestors.len()` particles, by `weights` that sum to one.
///
/// Carry along whatever belongs to a particle, one column at a time:
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
/// use foxhunt::resample::{Scheme, resample};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut memory = [0.0; 4];
/// let ancestors = resample(Scheme::Systematic, &[0.25, 0.5, 0.0, 0.25], &mut memory, &mut rng);
/// let mut names = ["light", "heavy", "none", "light"];
/// ancestors.gather(&mut names, &mut [""; 4]);
/// assert_eq!(names, ["light", "heavy", "heavy", "light"]);
/// ```
pub fn resample<'a, R: Rng + ?Sized>(
    scheme: Scheme,
    weights: &[f32],
    ancestors: &'a mut [f32],
    rng: &mut R,
) -> Ancestors<'a> {
    let points = ancestors.len() as u32;
    let n = points as f32;
    match scheme {
        Scheme::Systematic => {
            let first = uniform(rng);
            choose::<false>(weights, ancestors, points, first, |_| 1.0);
        }
        Scheme::Stratified => {
            let first = uniform(rng);
            let mut last = first;
            choose::<false>(weights, ancestors, points, first, |_| {
                let next = uniform(rng);
                let gap = 1.0 + next - last;
                last = next;
                gap
            });
        }
        Scheme::Residual => {
            let (rest, length) = residue(weights, points);
            let mut gaps = SortedUniforms { length, rng };
            let first = gaps.next(rest);
            choose::<true>(weights, ancestors, rest, first, |left| gaps.next(left));
        }
        Scheme::Multinomial => {
            let mut gaps = SortedUniforms { length: n, rng };
            let first = gaps.next(points);
            choose::<false>(weights, ancestors, points, first, |left| gaps.next(left));
        }
    }
    Ancestors { indices: ancestors }
}

/// The ancestor of every particle, in increasing order.
#[derive(Debug)]
pub struct Ancestors<'a> {
    /// Integers, held as the bits of floats, so that a column of a filter can serve as their memory.
    indices: &'a [f32],
}

impl Ancestors<'_> {
    /// The ancestor of each particle.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + Clone {
        self.indices.iter().map(|index| index.to_bits() as usize)
    }

    /// Replaces every value of a column by that of the ancestor. `scratch` is as long as the column and holds
    /// nothing of use before or after.
    pub fn gather<T: Copy>(&self, column: &mut [T], scratch: &mut [T]) {
        for (slot, ancestor) in scratch.iter_mut().zip(self.iter()) {
            if let Some(value) = column.get(ancestor) {
                *slot = *value;
            }
        }
        for (value, slot) in column.iter_mut().zip(scratch) {
            *value = *slot;
        }
    }
}

/// How many of the points are left for the multinomial part of [`Scheme::Residual`], and over what length.
fn residue(weights: &[f32], points: u32) -> (u32, f32) {
    let mut whole = 0u32;
    let mut length = 0.0;
    for &w in weights {
        let expected = w * points as f32;
        let certain = expected as u32;
        whole = whole.saturating_add(certain);
        length += expected - certain as f32;
    }
    (points.saturating_sub(whole), length)
}

/// Points drawn independently and uniformly on a line, in increasing order, one at a time.
struct SortedUniforms<'a, R: ?Sized> {
    /// What is left of the line behind the last point.
    length: f32,
    rng: &'a mut R,
}

impl<R: Rng + ?Sized> SortedUniforms<'_, R> {
    /// Distance to the next point when `left` points are still to come, this one included.
    fn next(&mut self, left: u32) -> f32 {
        // The smallest of m uniforms exceeds t with probability (1 - t)^m.
        let x = -ln(uniform_open(self.rng)) / left.max(1) as f32;
        let gap = self.length * one_minus_exp(x);
        self.length -= gap;
        gap
    }
}

/// Writes the ancestors: each particle as many times as its expected number of copies, rounded down, if that is
/// `CERTAIN`, and once more for each of `points` points that falls into the rest.
///
/// The expected numbers of the particles lie on a line, one after the other. The function walks along them and the points
/// at the same time, and holds only the distance from the end of the last one to the next point, so that rounding does
/// not grow with their number.
fn choose<const CERTAIN: bool>(
    weights: &[f32],
    ancestors: &mut [f32],
    points: u32,
    first: f32,
    mut gap: impl FnMut(u32) -> f32,
) {
    let n = ancestors.len() as f32;
    let mut left = points;
    let mut to_next_point = first;
    let mut slots = ancestors.iter_mut();
    let mut last = None;
    for (i, &w) in weights.iter().enumerate() {
        let ancestor = f32::from_bits(i as u32);
        let mut expected = w * n;
        if CERTAIN {
            let certain = expected as u32;
            expected -= certain as f32;
            for slot in slots.by_ref().take(certain as usize) {
                *slot = ancestor;
                last = Some(ancestor);
            }
        }
        to_next_point -= expected;
        while to_next_point < 0.0
            && left > 0
            && let Some(slot) = slots.next()
        {
            *slot = ancestor;
            last = Some(ancestor);
            left -= 1;
            to_next_point += gap(left);
        }
    }
    // Rounding may leave a point behind the end of the line: it belongs to the last particle that has any.
    // Weights that are none leave them all, and everything stays.
    let start = weights.len().saturating_sub(slots.len());
    for (i, slot) in slots.enumerate() {
        *slot = last.unwrap_or(f32::from_bits((start + i) as u32));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use std::{vec, vec::Vec};

    const SCHEMES: [Scheme; 4] = [
        Scheme::Systematic,
        Scheme::Stratified,
        Scheme::Residual,
        Scheme::Multinomial,
    ];

    /// Copies of each particle after one resampling.
    fn copies(scheme: Scheme, weights: &[f32], rng: &mut Xoshiro128PlusPlus) -> Vec<u32> {
        let mut counts = vec![0; weights.len()];
        for ancestor in resample(scheme, weights, &mut vec![0.0; weights.len()], rng).iter() {
            counts[ancestor] += 1;
        }
        counts
    }

    fn normalised(raw: &[f32]) -> Vec<f32> {
        let total: f32 = raw.iter().sum();
        raw.iter().map(|w| w / total).collect()
    }

    #[test]
    fn expected_copies_are_proportional_to_the_weights() {
        // 4 schemes x 3 sets x up to 200 particles, each z-tested at 4.5 standard errors: a false alarm in
        // one seed of about 80. The tolerance for f32 rounding is 2e-5 of a copy.
        const RUNS: u32 = 20_000;
        let sets = [
            normalised(&[0.1, 5.0, 0.0, 1.0, 2.9, 1.0]),
            normalised(&[1.0; 7]),
            normalised(&(1..=200).map(|i| 1.0 / i as f32).collect::<Vec<_>>()),
        ];
        for scheme in SCHEMES {
            for weights in &sets {
                let n = weights.len();
                let mut rng = Xoshiro128PlusPlus::seed_from_u64(11);
                let mut sum = vec![0f64; n];
                let mut squares = vec![0f64; n];
                for _ in 0..RUNS {
                    for (i, c) in copies(scheme, weights, &mut rng).into_iter().enumerate() {
                        sum[i] += f64::from(c);
                        squares[i] += f64::from(c * c);
                    }
                }
                for i in 0..n {
                    let expected = f64::from(weights[i]) * n as f64;
                    let mean = sum[i] / f64::from(RUNS);
                    let variance = squares[i] / f64::from(RUNS) - mean * mean;
                    let error = (variance.max(0.0) / f64::from(RUNS)).sqrt();
                    assert!(
                        (mean - expected).abs() < 4.5 * error + 2e-5,
                        "{scheme:?}: particle {i} of {n} gets {mean} copies, not {expected}"
                    );
                    if weights[i] == 0.0 {
                        assert_eq!(sum[i], 0.0, "{scheme:?} revives a dead particle");
                    }
                }
            }
        }
    }

    #[test]
    fn copies_of_low_variance_schemes_stay_near_their_expectation() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(12);
        let weights = normalised(&(1..=50).map(|i| (i * i) as f32).collect::<Vec<_>>());
        for (scheme, below, above) in [
            (Scheme::Systematic, 1.0, 1.0),
            (Scheme::Stratified, 2.0, 2.0),
            (Scheme::Residual, 1.0, f32::INFINITY),
        ] {
            for _ in 0..1000 {
                for (i, c) in copies(scheme, &weights, &mut rng).into_iter().enumerate() {
                    let off = c as f32 - weights[i] * 50.0;
                    assert!(
                        off > -below - 1e-4 && off < above + 1e-4,
                        "{scheme:?}: {off}"
                    );
                }
            }
        }
    }

    #[test]
    fn multinomial_has_multinomial_variance() {
        // The variance of a variance estimate of a near-Poisson count is about (1 + 2 m) / (m runs) of its
        // square; 4 of its standard deviations are below 5 % here.
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(13);
        let weights = normalised(&[1.0, 2.0, 3.0, 4.0]);
        let runs = 20_000;
        let mut squares = [0f64; 4];
        for _ in 0..runs {
            for (i, c) in copies(Scheme::Multinomial, &weights, &mut rng)
                .into_iter()
                .enumerate()
            {
                squares[i] += (f64::from(c) - 4.0 * f64::from(weights[i])).powi(2);
            }
        }
        for i in 0..4 {
            let p = f64::from(weights[i]);
            let ratio = squares[i] / f64::from(runs) / (4.0 * p * (1.0 - p));
            assert!((ratio - 1.0).abs() < 0.05, "particle {i}: {ratio}");
        }
    }

    #[test]
    fn no_particle_and_one_particle() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(14);
        for scheme in SCHEMES {
            assert_eq!(copies(scheme, &[], &mut rng), []);
            assert_eq!(copies(scheme, &[1.0], &mut rng), [1]);
        }
    }

    #[test]
    fn halves_of_many_particles_get_as_many_copies_as_expected() {
        // 65,536 equal weights, 40 runs of each scheme: the first half gets 32,768 copies, with a sigma of at most
        // 128. Four standard errors of the mean, 16 tests at 6e-5: one false alarm in 4,000 seeds.
        const N: usize = 1 << 16;
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(17);
        let mut memory = vec![0.0; N];
        let weights = vec![1.0 / N as f32; N];
        for scheme in SCHEMES {
            let mut sum = 0.0;
            for _ in 0..40 {
                let ancestors = resample(scheme, &weights, &mut memory, &mut rng);
                sum += ancestors.iter().filter(|a| *a < N / 2).count() as f64 - N as f64 / 2.0;
            }
            assert!(
                (sum / 40.0).abs() < 4.0 * 128.0 / 40f64.sqrt(),
                "{scheme:?}: {}",
                sum / 40.0
            );
        }
    }

    #[test]
    fn columns_are_gathered_in_order() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(15);
        for scheme in SCHEMES {
            for run in 0..100 {
                let raw: Vec<f32> = (0..64).map(|i| ((i * 37 + run * 11) % 64) as f32).collect();
                let mut memory = [0.0; 64];
                let ancestors = resample(scheme, &normalised(&raw), &mut memory, &mut rng);
                let mut labels: Vec<usize> = (0..64).collect();
                ancestors.gather(&mut labels, &mut [0; 64]);
                assert!(labels.is_sorted() && ancestors.iter().eq(labels));
            }
        }
    }

    #[test]
    fn weights_that_are_none_move_nothing() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(16);
        for scheme in SCHEMES {
            for nonsense in [0.0, f32::NAN] {
                let mut memory = [7.0; 4];
                let ancestors = resample(scheme, &[nonsense; 4], &mut memory, &mut rng);
                assert!(ancestors.iter().eq(0..4), "{scheme:?} {nonsense}");
            }
        }
    }
}
