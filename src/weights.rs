//! From log-weights to weights, in one place and without underflow.
//!
//! Log-weights are shifted by their maximum before the exponential, so the best particle always has a
//! weight: a measurement that every particle finds a thousand deviations off still ranks them.

use crate::math::{exp_of_weight, ln};

/// What the sum over the weights says.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Normalised {
    /// What was taken off every log-weight: the largest of them.
    pub shift: f32,
    /// Natural logarithm of the sum of what the shifted log-weights stand for; with `shift`, of the original sum.
    pub log_sum: f32,
    /// (sum w)^2 / sum w^2: how many equally weighted particles would be worth as much, from 1 to their number but for
    /// rounding.
    pub effective_sample_size: f32,
}

/// Turns log-weights into weights that sum to one, and shifts the log-weights so that the largest is zero.
///
/// A log-weight that is NaN or plus infinity stands for no weight at all, like minus infinity. Weights below
/// 2^-60 of the largest become zero.
///
/// Returns `None`, with the log-weights as they were and no use in the weights, when no particle has any.
pub fn normalise(log_weights: &mut [f32], weights: &mut [f32]) -> Option<Normalised> {
    weights.fill(0.0);
    reweigh(log_weights, weights)
}

/// Like [`normalise`], after adding what stands in `weights` at first to the log-weights: log-likelihoods.
pub fn reweigh(log_weights: &mut [f32], weights: &mut [f32]) -> Option<Normalised> {
    // The shorter slice decides.
    let n = log_weights.len().min(weights.len());
    let (log_weights, weights) = (log_weights.get_mut(..n)?, weights.get_mut(..n)?);
    let largest = largest_sum(log_weights, weights);
    if largest == f32::NEG_INFINITY {
        return None;
    }
    let sums = exponentiate(log_weights, weights, largest);
    let scale = 1.0 / sums.weights;
    for w in weights {
        *w *= scale;
    }
    Some(Normalised {
        shift: largest,
        log_sum: ln(sums.weights),
        effective_sample_size: sums.effective_sample_size(),
    })
}

/// (sum w)^2 / sum w^2 of weights on any scale; NaN when they are all zero.
pub fn effective_sample_size(weights: &[f32]) -> f32 {
    let mut sums = Sums::default();
    for &w in weights {
        sums.weights += w;
        sums.squares += w * w;
    }
    sums.effective_sample_size()
}

#[derive(Default)]
struct Sums {
    weights: f32,
    squares: f32,
}

impl Sums {
    fn effective_sample_size(&self) -> f32 {
        self.weights * self.weights / self.squares
    }
}

/// Largest of the sums that is finite, or minus infinity. Where a sum is plus infinity, the second summand
/// becomes NaN, which is no weight from then on.
fn largest_sum(log_weights: &[f32], log_likelihoods: &mut [f32]) -> f32 {
    let of_all = |log_likelihoods: &[f32]| {
        let mut largest = f32::NEG_INFINITY;
        for (l, more) in log_weights.iter().zip(log_likelihoods) {
            let sum = l + more;
            // False for NaN.
            if sum > largest {
                largest = sum;
            }
        }
        largest
    };
    let largest = of_all(log_likelihoods);
    if largest < f32::INFINITY {
        return largest;
    }
    for (l, more) in log_weights.iter().zip(log_likelihoods.iter_mut()) {
        if l + *more == f32::INFINITY {
            *more = f32::NAN;
        }
    }
    of_all(log_likelihoods)
}

/// Adds to every log-weight what stands in its weight, less `largest`, and sets the weight to the exponential.
///
/// Four running sums each, because one would wait for itself; then added in a fixed order.
fn exponentiate(log_weights: &mut [f32], weights: &mut [f32], largest: f32) -> Sums {
    let mut sum = [0.0f32; 4];
    let mut squares = [0.0f32; 4];
    let (log_blocks, log_rest) = log_weights.as_chunks_mut::<4>();
    let (blocks, rest) = weights.as_chunks_mut::<4>();
    for (l, w) in log_blocks.iter_mut().zip(blocks) {
        for lane in 0..4 {
            l[lane] = (l[lane] + w[lane]) - largest;
            w[lane] = exp_of_weight(l[lane]);
            sum[lane] += w[lane];
            squares[lane] += w[lane] * w[lane];
        }
    }
    for (l, w) in log_rest.iter_mut().zip(rest) {
        *l = (*l + *w) - largest;
        *w = exp_of_weight(*l);
        sum[0] += *w;
        squares[0] += *w * *w;
    }
    Sums {
        weights: (sum[0] + sum[1]) + (sum[2] + sum[3]),
        squares: (squares[0] + squares[1]) + (squares[2] + squares[3]),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn weights_sum_to_one_whatever_the_offset() {
        for offset in [-1e5f32, -88.0, 0.0, 88.0, 1e5] {
            let mut logs = [offset, offset + 1.0, offset - 1.0, offset - 2.0, offset];
            let mut weights = [0.0; 5];
            let result = normalise(&mut logs, &mut weights).unwrap();
            let total: f64 = [0.0f64, 1.0, -1.0, -2.0, 0.0].iter().map(|l| l.exp()).sum();
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            assert!((f64::from(weights[1]) - 1f64.exp() / total).abs() < 1e-6);
            let exact = f64::from(offset) + total.ln();
            assert!(
                (f64::from(result.shift + result.log_sum) - exact).abs()
                    < 1e-6 * (1.0 + exact.abs())
            );
            assert_eq!(logs[1], 0.0);
        }
    }

    #[test]
    fn equal_weights_have_a_full_sample_size_and_one_weight_has_one() {
        let mut weights = [0.0; 9];
        let equal = normalise(&mut [-3.0; 9], &mut weights).unwrap();
        assert!((equal.effective_sample_size - 9.0).abs() < 1e-5);
        let mut logs = [-1e4; 9];
        logs[7] = 0.0;
        let one = normalise(&mut logs, &mut weights).unwrap();
        assert_eq!(one.effective_sample_size, 1.0);
        assert_eq!(effective_sample_size(&weights), 1.0);
    }

    #[test]
    fn what_is_no_weight_counts_as_zero() {
        let mut logs = [f32::NAN, 0.0, f32::INFINITY, f32::NEG_INFINITY, 0.0];
        let mut weights = [9.0; 5];
        normalise(&mut logs, &mut weights).unwrap();
        assert_eq!(weights, [0.0, 0.5, 0.0, 0.0, 0.5]);
    }

    #[test]
    fn no_weight_at_all_changes_nothing() {
        let mut logs = [f32::NEG_INFINITY, f32::NAN, -1.0, f32::INFINITY];
        let mut weights = [0.0, 0.0, f32::NEG_INFINITY, 0.0];
        assert_eq!(reweigh(&mut logs, &mut weights), None);
        assert!(logs[1].is_nan());
        assert_eq!(
            (logs[0], logs[2], logs[3]),
            (f32::NEG_INFINITY, -1.0, f32::INFINITY)
        );
        assert_eq!(normalise(&mut [], &mut []), None);
    }
}
