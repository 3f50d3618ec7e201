//! The scales that all sigmas may have, to be summed over.

/// One of them.
#[derive(Debug, Clone)]
pub(super) struct Scale {
    pub value: f64,
    pub log: f64,
    /// Logarithm of the peak of the density of all bearings without biases, against that at scale one.
    pub peak: f64,
    log_weight: f64,
}

/// Scales beyond so many of their sigmas are left out: they have less than a millionth of the prior.
const LIMIT: f64 = 16.0;
/// Farthest apart, in these sigmas: twice as fine changes sums by less than 1e-5.
const FARTHEST: f64 = 0.5;

impl Scale {
    /// Those of `sigma` and so many bearings: near enough for the sum to be right to 1e-5.
    pub fn all(sigma: f64, bearings: usize) -> Vec<Self> {
        let bearings = bearings as f64;
        // In standard deviations of the scale once the bearings are known.
        let step = 1.25 / (1.0 + 2.0 * bearings * sigma * sigma).sqrt();
        let prior = |z: f64| 1.0 - (1.0 + z * z).sqrt();
        let half = match sigma {
            0.0 => 0,
            _ => (LIMIT / step.min(FARTHEST)).ceil() as i32,
        };
        let value = |k: i32| LIMIT * f64::from(k) / f64::from(half.max(1));
        let total: f64 = (-half..=half).map(|k| prior(value(k)).exp()).sum();
        (-half..=half)
            .map(value)
            .map(|z| {
                let log = sigma * z;
                Self {
                    value: log.exp(),
                    log,
                    peak: -bearings * log,
                    log_weight: prior(z) - total.ln(),
                }
            })
            .collect()
    }

    /// Logarithm of the mean over all of what has these logarithms.
    pub fn sum(scales: &[Self], log: impl Fn(&Self) -> f64) -> f64 {
        match scales {
            [one] => log(one),
            _ => Self::bound(scales, log).0,
        }
    }

    /// The same, and how likely each scale is then.
    pub fn bound(scales: &[Self], log: impl Fn(&Self) -> f64) -> (f64, Vec<f64>) {
        let mut logs: Vec<f64> = (scales.iter())
            .map(|scale| scale.log_weight + log(scale))
            .collect();
        let best = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = logs.iter().map(|log| (log - best).exp()).sum();
        let sum = best + total.ln();
        logs.iter_mut().for_each(|log| *log = (*log - sum).exp());
        (sum, logs)
    }
}
