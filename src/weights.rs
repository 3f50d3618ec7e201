//! From log-weights to weights, in one place and without underflow.
//!
//! Log-weights are shifted by their maximum before the exponential, so the best particle always has a
//! weight: a measurement that is a thousand sigmas away from every particle still ranks them.

use crate::error::messages;
use crate::math::{exp_of_weight, ln};
use crate::persist;
use crate::random::Rng;
use crate::resample::{Ancestors, Scheme, resample};

/// The weights of `N` particles: natural log-weights, which have an arbitrary common offset, and what follows from them.
///
/// ```
/// use foxhunt::weights::Weights;
///
/// let mut weights = Weights::<4>::EMPTY;
/// *weights.log_likelihoods_mut() = [0.0, 0.0, -100.0, -100.0];
/// let log_evidence = weights.update()?;
/// // Half of the particles explain the measurement.
/// assert!((log_evidence - 0.5_f32.ln()).abs() < 1e-6);
/// assert_eq!(weights.weights(), [0.5, 0.5, 0.0, 0.0]);
/// assert_eq!(weights.effective_sample_size(), 2.0);
/// # Ok::<(), foxhunt::weights::UpdateError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Weights<const N: usize> {
    log_weights: [f32; N],
    /// The exponentials of the log-weights, scaled to sum to one.
    weights: [f32; N],
    /// Natural logarithm of the sum of the exponentials of the log-weights.
    log_sum: f32,
    /// At least one; zero as long as the weights are those of `EMPTY`, which makes the other sums void.
    effective_sample_size: f32,
}

impl<const N: usize> Weights<N> {
    /// Equal weights, in bits that are all zero: [`Weights::weights`] holds zeros until the first call of any other method
    /// that changes the weights.
    pub const EMPTY: Self = {
        // Refinements number particles in 16 bits, and resampling is tested up to this number.
        assert!(N > 0 && N <= 1 << 16, "from one to 65,536 particles");
        Self {
            log_weights: [0.0; N],
            weights: [0.0; N],
            log_sum: 0.0,
            effective_sample_size: 0.0,
        }
    };

    /// Makes all weights equal.
    pub fn make_equal(&mut self) {
        self.log_weights = [0.0; N];
        self.weights = [1.0 / N as f32; N];
        self.log_sum = const { ln(N as f32) };
        self.effective_sample_size = N as f32;
    }

    /// Natural log-weights with an arbitrary common offset.
    pub fn log_weights(&self) -> &[f32] {
        &self.log_weights
    }

    /// The weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Whether the weights are still those of [`Weights::EMPTY`].
    pub(crate) fn are_empty(&self) -> bool {
        self.effective_sample_size <= 0.0
    }

    /// Natural logarithm of the sum of the exponentials of the log-weights.
    pub fn log_sum(&self) -> f32 {
        if self.are_empty() {
            const { ln(N as f32) }
        } else {
            self.log_sum
        }
    }

    /// How many equally weighted particles the cloud is worth, from 1 to `N`.
    pub fn effective_sample_size(&self) -> f32 {
        if self.are_empty() {
            N as f32
        } else {
            self.effective_sample_size
        }
    }

    /// The log-weights, to be set before [`Weights::normalise`].
    pub fn log_weights_mut(&mut self) -> &mut [f32; N] {
        &mut self.log_weights
    }

    /// The log-likelihoods, to be set before [`Weights::update`]. They take the place of the weights until then.
    pub fn log_likelihoods_mut(&mut self) -> &mut [f32; N] {
        &mut self.weights
    }

    /// The columns of log-weights and of weights.
    pub(crate) fn columns_mut(&mut self) -> (&mut [f32; N], &mut [f32; N]) {
        (&mut self.log_weights, &mut self.weights)
    }

    /// Computes the weights from the log-weights.
    ///
    /// # Errors
    /// When no particle has a weight. The log-weights are then as before, and the weights of no use.
    pub fn normalise(&mut self) -> Result<(), UpdateError> {
        let normalised = normalise(&mut self.log_weights, &mut self.weights);
        self.store(normalised).map(drop)
    }

    /// Multiplies the weights by likelihoods, whose logarithms were written into [`Weights::log_likelihoods_mut`].
    /// Returns the log-evidence: the natural logarithm of the weighted mean of the likelihoods.
    ///
    /// # Errors
    /// When no particle is left with any weight. The weights are then as before.
    pub fn update(&mut self) -> Result<f32, UpdateError> {
        let before = self.log_sum();
        let normalised = reweigh(&mut self.log_weights, &mut self.weights);
        if normalised.is_none() {
            // The weights follow from the log-weights, which are untouched.
            normalise(&mut self.log_weights, &mut self.weights);
        }
        let Normalised { shift, log_sum, .. } = self.store(normalised)?;
        Ok(shift + log_sum - before)
    }

    /// Stores the sums, if there are any.
    fn store(&mut self, normalised: Option<Normalised>) -> Result<Normalised, UpdateError> {
        let normalised = normalised.ok_or(UpdateError::AllWeightsZero)?;
        self.log_sum = normalised.log_sum;
        self.effective_sample_size = normalised.effective_sample_size;
        Ok(normalised)
    }

    /// Chooses an ancestor for every particle by the weights, and makes the weights equal. `carry` replaces whatever belongs
    /// to the particles; it gets a column of scratch memory, too.
    #[inline(always)]
    pub fn resample<R: Rng + ?Sized>(
        &mut self,
        scheme: Scheme,
        rng: &mut R,
        carry: impl FnOnce(&Ancestors<'_>, &mut [f32; N]),
    ) {
        // Both columns are about to be equal: until then they serve as memory.
        let ancestors = resample(scheme, &self.weights, &mut self.log_weights, rng);
        carry(&ancestors, &mut self.weights);
        self.make_equal();
    }
}

/// Why an update was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum UpdateError {
    /// Every particle finds the measurement impossible (log-likelihood minus infinity, or NaN). The filter
    /// stays as it was: leave the measurement out, or start again from elsewhere.
    AllWeightsZero,
}

messages!(UpdateError {
    Self::AllWeightsZero => "every particle finds the measurement impossible",
});

persist!(impl[const N: usize] Weights<N> as "Weights"(N) { log_weights, weights, log_sum, effective_sample_size });

/// Sums that a normalisation yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Normalised {
    /// The largest log-weight, which was subtracted from all.
    pub shift: f32,
    /// Natural logarithm of the sum of exp(log-weight - shift).
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
/// Returns `None` when no particle has a weight: the log-weights are then as before, and the weights of no use.
pub(crate) fn normalise(log_weights: &mut [f32], weights: &mut [f32]) -> Option<Normalised> {
    weights.fill(0.0);
    reweigh(log_weights, weights)
}

/// Like [`normalise`], after adding what stands in `weights` at first to the log-weights: log-likelihoods.
fn reweigh(log_weights: &mut [f32], weights: &mut [f32]) -> Option<Normalised> {
    // The shorter slice decides.
    let n = log_weights.len().min(weights.len());
    let (log_weights, weights) = (log_weights.get_mut(..n)?, weights.get_mut(..n)?);
    let largest = largest_sum(log_weights, weights);
    if largest == f32::NEG_INFINITY {
        return None;
    }
    let (sum, squares) = exponentiate(log_weights, weights, largest);
    let scale = 1.0 / sum;
    for w in weights {
        *w *= scale;
    }
    Some(Normalised {
        shift: largest,
        log_sum: ln(sum),
        effective_sample_size: sum * sum / squares,
    })
}

/// Largest of the sums that is finite, or minus infinity. Where a sum is plus infinity, the second summand
/// becomes NaN, which is no weight from then on.
fn largest_sum(log_weights: &[f32], log_likelihoods: &mut [f32]) -> f32 {
    let largest_of = |log_likelihoods: &[f32]| {
        let mut largest = f32::NEG_INFINITY;
        for (log_weight, log_likelihood) in log_weights.iter().zip(log_likelihoods) {
            let sum = log_weight + log_likelihood;
            // False for NaN.
            if sum > largest {
                largest = sum;
            }
        }
        largest
    };
    let largest = largest_of(log_likelihoods);
    if largest < f32::INFINITY {
        return largest;
    }
    for (log_weight, log_likelihood) in log_weights.iter().zip(log_likelihoods.iter_mut()) {
        if log_weight + *log_likelihood == f32::INFINITY {
            *log_likelihood = f32::NAN;
        }
    }
    largest_of(log_likelihoods)
}

/// Adds to every log-weight what stands in its weight, less `largest`, and sets the weight to the exponential. Returns the
/// sum of the weights and that of their squares.
///
/// Four running sums each, because one would wait for itself; then added in a fixed order.
fn exponentiate(log_weights: &mut [f32], weights: &mut [f32], largest: f32) -> (f32, f32) {
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
    let of_all = |[a, b, c, d]: [f32; 4]| (a + b) + (c + d);
    (of_all(sum), of_all(squares))
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
    }

    #[test]
    fn empty_weights_are_equal() {
        let mut weights = Weights::<64>::EMPTY;
        assert_eq!(weights.effective_sample_size(), 64.0);
        weights.log_likelihoods_mut().fill(1.5);
        assert!((weights.update().unwrap() - 1.5).abs() < 1e-5);
        assert_eq!(weights.weights(), [1.0 / 64.0; 64]);

        let mut weights = Weights::<64>::EMPTY;
        weights.log_likelihoods_mut().fill(f32::NAN);
        assert_eq!(weights.update(), Err(UpdateError::AllWeightsZero));
        assert_eq!(weights.weights(), [1.0 / 64.0; 64]);
        assert_eq!(weights.effective_sample_size(), 64.0);
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
