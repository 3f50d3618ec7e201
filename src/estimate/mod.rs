//! Estimates from a weighted cloud: mean, covariance, quantiles, and the ellipse that holds the truth.
//!
//! Weights are those of [`crate::weights`]: they sum to one.

mod ellipse;
mod symmetric;

use crate::math::{larger, smaller};
pub use ellipse::Ellipse;
pub use symmetric::Symmetric2;

/// Weighted mean of every column.
pub fn mean<const D: usize>(columns: &[&[f32]; D], weights: &[f32]) -> [f32; D] {
    columns.map(|column| weighted_sum(weights, column))
}

/// Weighted covariance of the columns about their mean: symmetric, in the product of their units.
pub fn covariance<const D: usize>(columns: &[&[f32]; D], weights: &[f32]) -> [[f32; D]; D] {
    // Without an index: at `opt-level = "z"` the compiler keeps the check of one, which could panic.
    let axes = columns.map(|column| (column, weighted_sum(weights, column)));
    axes.map(|x| axes.map(|y| weighted_product(weights, x, y)))
}

/// Sum of `w (x - mean of x) (y - mean of y)` over the particles that have a weight.
#[inline(never)]
fn weighted_product(
    weights: &[f32],
    (x, mean_x): (&[f32], f32),
    (y, mean_y): (&[f32], f32),
) -> f32 {
    let mut sum = 0.0;
    for (w, (x, y)) in weights.iter().zip(x.iter().zip(y)) {
        if *w != 0.0 {
            sum += w * ((x - mean_x) * (y - mean_y));
        }
    }
    sum
}

/// Sum of `w x`, in four running sums added in a fixed order.
fn weighted_sum(weights: &[f32], column: &[f32]) -> f32 {
    let n = weights.len().min(column.len());
    let (weights, column) = (
        weights.get(..n).unwrap_or_default(),
        column.get(..n).unwrap_or_default(),
    );
    let mut sum = [0.0f32; 4];
    let (weight_blocks, weight_rest) = weights.as_chunks::<4>();
    let (blocks, rest) = column.as_chunks::<4>();
    for (w, x) in weight_blocks.iter().zip(blocks) {
        for lane in 0..4 {
            sum[lane] += w[lane] * x[lane];
        }
    }
    for (w, x) in weight_rest.iter().zip(rest) {
        sum[0] += w * x;
    }
    let total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    if total.is_finite() {
        total
    } else {
        weighted_sum_of_living(weights, column)
    }
}

/// Of the particles that have a weight: a dead one may be anywhere, at infinity or NaN as well.
#[cold]
#[inline(never)]
fn weighted_sum_of_living(weights: &[f32], column: &[f32]) -> f32 {
    let living = weights.iter().zip(column).filter(|(w, _)| **w != 0.0);
    living.map(|(w, x)| w * x).sum()
}

/// Smallest value of `column` that, with all smaller ones, holds at least `probability` of the weight.
///
/// Zero and one give the smallest and the largest value with a weight. Needs no sorting and no memory: 33 passes
/// over the column, one for each bit of the answer and one for the sum. NaN for an empty column.
pub fn quantile(column: &[f32], weights: &[f32], probability: f32) -> f32 {
    // The order of the floats is that of their bits once the negative ones are turned round.
    let key = |x: f32| {
        let bits = x.to_bits();
        if bits >> 31 == 0 {
            bits | 1 << 31
        } else {
            !bits
        }
    };
    let weight_up_to = |limit: u32| -> f32 {
        weights
            .iter()
            .zip(column)
            .map(|(w, x)| if key(*x) <= limit { *w } else { 0.0 })
            .sum()
    };
    // Within what can be reached, which rounding may leave short of one.
    let reachable = weight_up_to(u32::MAX);
    let probability = larger(probability, f32::MIN_POSITIVE);
    let probability = smaller(probability, reachable);
    let mut answer = u32::MAX;
    for bit in (0..32).rev() {
        let lower = answer & !(1 << bit);
        // With this bit cleared and all below it set: is that still enough?
        if weight_up_to(lower) >= probability {
            answer = lower;
        }
    }
    // The next bits are cleared one by one, so what is left is the key of a value of the column.
    f32::from_bits(if answer >> 31 == 1 {
        answer & !(1 << 31)
    } else {
        !answer
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform};
    use std::vec::Vec;

    #[test]
    fn moments_of_five_points() {
        let x = [1.0, 2.0, 3.0, 4.0, 100.0];
        let y = [2.0, 4.0, 6.0, 8.0, -7.0];
        let weights = [0.25, 0.25, 0.25, 0.25, 0.0];
        assert_eq!(mean(&[&x, &y], &weights), [2.5, 5.0]);
        assert_eq!(covariance(&[&x, &y], &weights), [[1.25, 2.5], [2.5, 5.0]]);
    }

    #[test]
    fn a_dead_particle_may_be_anywhere() {
        for nowhere in [f32::NAN, f32::INFINITY] {
            let columns: [&[f32]; 1] = [&[1.0, nowhere, 3.0, 3.0, nowhere]];
            let weights = [0.5, 0.0, 0.25, 0.25, 0.0];
            assert_eq!(mean(&columns, &weights), [2.0]);
            assert_eq!(covariance(&columns, &weights), [[1.0]]);
        }
    }

    #[test]
    fn quantiles_are_those_of_the_sorted_column() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(21);
        for n in [1usize, 2, 7, 100] {
            let column: Vec<f32> = (0..n).map(|_| 10.0 * normal(&mut rng)).collect();
            let raw: Vec<f32> = (0..n).map(|_| uniform(&mut rng)).collect();
            let total: f32 = raw.iter().sum();
            let weights: Vec<f32> = raw.iter().map(|w| w / total).collect();
            let mut order: Vec<usize> = (0..n).collect();
            order.sort_by(|&a, &b| column[a].total_cmp(&column[b]));
            for p in [0.001f32, 0.025, 0.3, 0.5, 0.9, 0.999] {
                let mut sum = 0.0;
                let expected = order
                    .iter()
                    .find(|&&i| {
                        sum += weights[i];
                        sum >= p
                    })
                    .map(|&i| column[i])
                    .unwrap();
                assert_eq!(quantile(&column, &weights, p), expected, "n {n} p {p}");
            }
        }
        assert_eq!(quantile(&[-1.0, 0.0, 1.0], &[0.5, 0.25, 0.25], 0.5), -1.0);
        assert!(quantile(&[], &[], 0.5).is_nan());
        let (column, weights) = ([3.0, -7.0, 5.0, 9.0], [0.3, 0.3, 0.4, 0.0]);
        assert_eq!(quantile(&column, &weights, 0.0), -7.0);
        assert_eq!(quantile(&column, &weights, 1.0), 5.0);
        let equal = [1.0 / 200.0; 200];
        let ramp: Vec<f32> = (0..200).map(|i| i as f32).collect();
        assert_eq!(quantile(&ramp, &equal, 1.0), 199.0);
    }
}
