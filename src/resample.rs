//! Resampling: replace light particles by copies of heavy ones.
//!
//! Every scheme gives particle `i` an expected number of copies of exactly `N w_i`; they differ in the
//! variance of that number. All of them work in place, in time proportional to `N`, with no second cloud.
//!
//! All of them keep the particles in order, so that siblings stay neighbours. That matters: systematic and
//! stratified resampling spread their copies evenly over *neighbouring* particles, and a scheme that put
//! copies wherever a slot is free would lose that from the second step on, at the price of half as much
//! Monte Carlo variance again.

use crate::math::{exp, ln};
use crate::random::{Rng, uniform, uniform_open};

/// How copies are allotted. In order of variance, smallest first, as a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

/// Allots as many copies as there are weights, which must sum to one.
///
/// Carry along whatever belongs to a particle, one column at a time:
///
/// ```
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
/// use foxhunt::resample::{Scheme, resample};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut names = ["light", "heavy", "none", "light"];
/// let mut weights = [0.25, 0.5, 0.0, 0.25];
/// let offspring = resample(Scheme::Systematic, &mut weights, &mut rng);
/// offspring.expand(&mut names, &mut [""; 4]);
/// assert_eq!(names, ["light", "heavy", "heavy", "light"]);
/// drop(offspring);
/// assert_eq!(weights, [0.25; 4]);
/// ```
pub fn resample<'a, R: Rng + ?Sized>(
    scheme: Scheme,
    weights: &'a mut [f32],
    rng: &mut R,
) -> Offspring<'a> {
    let n = weights.len() as f32;
    let points = weights.len() as u32;
    match scheme {
        Scheme::Systematic => {
            let first = uniform(rng);
            allot(weights, n, false, points, first, |_| 1.0);
        }
        Scheme::Stratified => {
            let first = uniform(rng);
            let mut last = first;
            allot(weights, n, false, points, first, |_| {
                let next = uniform(rng);
                let gap = 1.0 + next - last;
                last = next;
                gap
            });
        }
        Scheme::Residual => {
            let (rest, length) = residue(weights, n);
            let mut gaps = SortedUniforms { length, rng };
            let first = gaps.next(rest);
            allot(weights, n, true, rest, first, |left| gaps.next(left));
        }
        Scheme::Multinomial => {
            let mut gaps = SortedUniforms { length: n, rng };
            let first = gaps.next(points);
            allot(weights, n, false, points, first, |left| gaps.next(left));
        }
    }
    Offspring { counts: weights }
}

/// How many copies each particle gets. When it is dropped, the weights that it was made of are equal.
#[derive(Debug)]
pub struct Offspring<'a> {
    /// Integers, held as the bits of floats.
    counts: &'a mut [f32],
}

impl Offspring<'_> {
    /// The number of copies of each particle, which may be zero.
    pub fn counts(&self) -> impl Iterator<Item = u32> {
        self.counts.iter().map(|count| count.to_bits())
    }

    /// Replaces every value of a column by its copies, in order. `scratch` is as long as the column and holds
    /// nothing of use before or after.
    pub fn expand<T: Copy>(&self, column: &mut [T], scratch: &mut [T]) {
        let mut slots = scratch.iter_mut();
        for (value, count) in column.iter().zip(self.counts()) {
            for _ in 0..count {
                if let Some(slot) = slots.next() {
                    *slot = *value;
                }
            }
        }
        // Without any weight there are no copies, and everything stays.
        let unfilled = slots.len();
        let filled = scratch.len() - unfilled;
        for (value, slot) in column.iter_mut().zip(scratch).take(filled) {
            *value = *slot;
        }
    }
}

impl Drop for Offspring<'_> {
    fn drop(&mut self) {
        let n = self.counts.len() as f32;
        self.counts.fill(1.0 / n);
    }
}

/// How many points are left for the multinomial part of [`Scheme::Residual`], and over what length.
fn residue(weights: &[f32], n: f32) -> (u32, f32) {
    let mut whole = 0u32;
    let mut length = 0.0;
    for &w in weights {
        let share = w * n;
        let certain = share as u32;
        whole += certain;
        length += share - certain as f32;
    }
    ((weights.len() as u32).saturating_sub(whole), length)
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
        let kept = self.length * exp(ln(uniform_open(self.rng)) / left.max(1) as f32);
        let gap = self.length - kept;
        self.length = kept;
        gap
    }
}

/// Replaces every weight by its number of copies, held as the bits of an integer.
///
/// Walks along the shares `n w` of the particles and the points at the same time, and only ever holds the
/// distance from the end of the last share to the next point, so that rounding does not grow with `n`.
fn allot(
    weights: &mut [f32],
    n: f32,
    whole_part_is_certain: bool,
    points: u32,
    first: f32,
    mut gap: impl FnMut(u32) -> f32,
) {
    let mut left = points;
    let mut to_next_point = first;
    for slot in weights.iter_mut() {
        let mut share = *slot * n;
        let mut count = 0;
        if whole_part_is_certain {
            count = share as u32;
            share -= count as f32;
        }
        to_next_point -= share;
        while to_next_point < 0.0 && left > 0 {
            count += 1;
            left -= 1;
            to_next_point += gap(left);
        }
        *slot = f32::from_bits(count);
    }
    // Rounding may leave a point behind the end of the line: it belongs to the last particle that has any.
    if left > 0
        && let Some(slot) = weights.iter_mut().rfind(|slot| slot.to_bits() > 0)
    {
        *slot = f32::from_bits(slot.to_bits() + left);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use std::{vec, vec::Vec};

    const SCHEMES: [Scheme; 4] =
        [Scheme::Systematic, Scheme::Stratified, Scheme::Residual, Scheme::Multinomial];

    /// Copies of each particle after one resampling.
    fn copies(scheme: Scheme, weights: &[f32], rng: &mut Xoshiro128PlusPlus) -> Vec<u32> {
        resample(scheme, &mut weights.to_vec(), rng).counts().collect()
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
                    assert!(off > -below - 1e-4 && off < above + 1e-4, "{scheme:?}: {off}");
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
            for (i, c) in copies(Scheme::Multinomial, &weights, &mut rng).into_iter().enumerate() {
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
    fn columns_are_expanded_in_order() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(15);
        for scheme in SCHEMES {
            for run in 0..100 {
                let raw: Vec<f32> = (0..64).map(|i| ((i * 37 + run * 11) % 64) as f32).collect();
                let mut weights = normalised(&raw);
                let offspring = resample(scheme, &mut weights, &mut rng);
                let mut labels: Vec<usize> = (0..64).collect();
                offspring.expand(&mut labels, &mut [0; 64]);
                assert!(labels.is_sorted());
                let of = |label| labels.iter().filter(|&&l| l == label).count() as u32;
                assert!(offspring.counts().enumerate().all(|(i, count)| of(i) == count));
                drop(offspring);
                assert_eq!(weights, [1.0 / 64.0; 64]);
            }
        }
    }

    #[test]
    fn weights_that_are_none_move_nothing() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(16);
        for scheme in SCHEMES {
            for nonsense in [0.0, f32::NAN] {
                let mut labels = [0, 1, 2, 3];
                resample(scheme, &mut [nonsense; 4], &mut rng).expand(&mut labels, &mut [9; 4]);
                assert_eq!(labels, [0, 1, 2, 3]);
            }
        }
    }
}
