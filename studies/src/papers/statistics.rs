//! What many runs say, and how sure that is.

use foxhunt_simulation::random::generator;

/// 95 % of a normal distribution in the plane lie within this Mahalanobis distance.
pub const NINETY_FIVE: f64 = 2.447_746_830_680_816;

/// A figure and the standard deviation that it would have over repetitions of the experiment.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    pub value: f64,
    pub error: f64,
}

impl Estimate {
    /// The mean of values, by their own scatter.
    pub fn mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (n - 1.0);
        Self {
            value,
            error: (variance / n).sqrt(),
        }
    }

    /// The root of the mean of squares, by their own scatter.
    pub fn root_of_mean(squares: &[f64]) -> Self {
        let mean = Self::mean(squares);
        let value = mean.value.sqrt();
        Self {
            value,
            error: 0.5 * mean.error / value,
        }
    }

    /// How many standard deviations it is from `reference`, a figure of as much scatter that came of
    /// `reference_runs` runs; this one came of `runs`.
    pub fn distance(self, reference: f64, reference_runs: f64, runs: f64) -> f64 {
        let scatter = self.error * (1.0 + runs / reference_runs).sqrt();
        (self.value - reference).abs() / scatter
    }
}

impl std::fmt::Display for Estimate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // As many decimals as the first digit of the error has.
        let decimals = (-self.error.log10().floor()).clamp(0.0, 3.0) as usize;
        write!(f, "{:.decimals$} ± {:.decimals$}", self.value, self.error)
    }
}

/// `statistic` of runs 0 to `runs`, with its standard deviation over 400 bootstrap samples: it is given
/// the numbers of the runs that it is to count.
pub fn bootstrap(
    runs: usize,
    statistic: impl Fn(&mut dyn Iterator<Item = usize>) -> f64,
) -> Estimate {
    use rand::RngExt;

    const SAMPLES: u32 = 400;
    let mut rng = generator(0, 0);
    let samples: Vec<f64> = (0..SAMPLES)
        .map(|_| statistic(&mut (0..runs).map(|_| rng.random_range(0..runs))))
        .collect();
    let mean = samples.iter().sum::<f64>() / f64::from(SAMPLES);
    let variance = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / f64::from(SAMPLES);
    Estimate {
        value: statistic(&mut (0..runs)),
        error: variance.sqrt(),
    }
}

/// Root of the mean of the squares.
pub fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), v| (count + 1.0, sum + v * v));
    (sum / count).sqrt()
}

/// The middle value.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The root mean squares that experiments of some runs each find: in rising order.
///
/// For a method of which a few runs in a thousand are lost, and make the figure: what 1,000 runs can show of it
/// is only seen from many more.
pub struct Experiments(Vec<f64>);

impl Experiments {
    /// Draws experiments of `runs` runs each from the errors in `pool`.
    pub fn draw(pool: &[f64], runs: usize, seed: u64) -> Self {
        use rand::RngExt;

        const EXPERIMENTS: usize = 4000;
        let mut rng = generator(seed, u64::MAX);
        let mut experiments: Vec<f64> = (0..EXPERIMENTS)
            .map(|_| root_mean_square((0..runs).map(|_| pool[rng.random_range(0..pool.len())])))
            .collect();
        experiments.sort_by(f64::total_cmp);
        Self(experiments)
    }

    pub fn quantile(&self, probability: f64) -> f64 {
        self.0[((self.0.len() - 1) as f64 * probability) as usize]
    }

    /// Fraction of the experiments below `value`.
    pub fn fraction_below(&self, value: f64) -> f64 {
        let below = self.0.partition_point(|experiment| *experiment < value);
        below as f64 / self.0.len() as f64
    }

    /// Fraction of the experiments that are nearer to the middle one than `value`.
    pub fn surprise(&self, value: f64) -> f64 {
        (2.0 * self.fraction_below(value) - 1.0).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bootstrap_of_a_mean_is_its_standard_error() {
        let values: Vec<f64> = (0..400).map(|n| f64::from(n % 20)).collect();
        let mean =
            |runs: &mut dyn Iterator<Item = usize>| runs.map(|r| values[r]).sum::<f64>() / 400.0;
        let estimate = bootstrap(values.len(), mean);
        assert_eq!(estimate.value, 9.5);
        // The standard deviation of 0 to 19 is 5.77; 400 bootstrap samples know an error to 4 %.
        assert!((estimate.error - 5.77 / 20.0).abs() < 0.04);
    }

    #[test]
    fn middle_and_root() {
        assert_eq!(median([9.0, 1.0, 5.0].into_iter()), 5.0);
        assert_eq!(root_mean_square([3.0, 4.0, 0.0, 0.0].into_iter()), 2.5);
    }
}
