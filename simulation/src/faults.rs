//! What goes wrong with bearings: some are outliers, some mirrored, and all may be biased.

use core::f64::consts::{PI, TAU};

use rand::{Rng, RngExt};

use crate::{Sight, random::normal, sight::wrap};

/// How many bearings are wrong, and how.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Rate of outliers: bearings that are uniform on the circle.
    pub outlier_rate: f64,
    /// Rate of mirrored bearings, which are turned by half a circle.
    pub mirrored_rate: f64,
    /// Standard deviation of the common bias of all bearings of a run, in radians.
    pub bias_sigma: f64,
}

/// What a bearing says of the source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Its direction, but for an error.
    Direct,
    /// The opposite direction, but for an error.
    Mirrored,
    /// Nothing.
    Outlier,
}

impl Faults {
    /// Spoils the bearings of one run. The errors that they have stay as they are, so that runs with different faults
    /// can be compared bearing by bearing.
    pub fn spoil(&self, sights: &mut [Sight], rng: &mut impl Rng) {
        let bias = self.bias_sigma * normal(rng);
        for sight in sights {
            self.spoil_one(sight, bias, rng);
        }
    }

    /// Spoils one bearing of a run with this bias, in radians, and says what it is then.
    pub fn spoil_one(&self, sight: &mut Sight, bias: f64, rng: &mut impl Rng) -> Kind {
        let (kind, anywhere): (f64, f64) = (rng.random(), rng.random());
        if kind < self.outlier_rate {
            sight.bearing = wrap(TAU * anywhere);
            Kind::Outlier
        } else if kind < self.outlier_rate + self.mirrored_rate {
            sight.bearing = wrap(sight.bearing + bias + PI);
            Kind::Mirrored
        } else {
            sight.bearing = wrap(sight.bearing + bias);
            Kind::Direct
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::generator;

    #[test]
    fn rates_and_bias_are_as_asked_for() {
        let faults = Faults {
            outlier_rate: 0.2,
            mirrored_rate: 0.3,
            bias_sigma: 0.05,
        };
        let clean = Sight {
            time_ms: 0,
            position: [0.0; 2],
            bearing: 1.0,
            sigma: 0.02,
        };
        const RUNS: u64 = 500;
        const COUNT: usize = 60;
        let (mut mirrored, mut outliers, mut biases) = (0.0, 0.0, 0.0);
        for run in 0..RUNS {
            let mut sights = [clean; COUNT];
            faults.spoil(&mut sights, &mut generator(2, run));
            let mut alone = generator(2, run);
            let bias = faults.bias_sigma * normal(&mut alone);
            biases += bias * bias;
            for sight in sights {
                let turn = wrap(sight.bearing - clean.bearing);
                let kind = faults.spoil_one(&mut clean.clone(), bias, &mut alone);
                match kind {
                    Kind::Direct => assert!((turn - bias).abs() < 1e-9),
                    Kind::Mirrored => assert!(wrap(turn - bias - PI).abs() < 1e-9),
                    Kind::Outlier => {}
                }
                mirrored += f64::from(u8::from(kind == Kind::Mirrored));
                outliers += f64::from(u8::from(kind == Kind::Outlier));
            }
        }
        // Four standard errors.
        let all = (RUNS * COUNT as u64) as f64;
        assert!((mirrored / all - 0.3).abs() < 0.011, "{}", mirrored / all);
        assert!((outliers / all - 0.2).abs() < 0.01, "{}", outliers / all);
        let sigma = libm::sqrt(biases / RUNS as f64);
        assert!((sigma - 0.05).abs() < 0.007, "{sigma}");
    }
}
