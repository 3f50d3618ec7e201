//! What goes wrong with bearings: some are outliers, some mirrored, all may be biased, and those of a stationary vehicle
//! repeat each other's errors.

use std::f64::consts::{PI, TAU};

use rand::{Rng, RngExt};

use crate::Sight;
use crate::sight::{direction, wrap};
use crate::simulate::normal;
use crate::tracks::Track;

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

impl Faults {
    /// Spoils the bearings of one run. The errors that they have stay as they are, so that runs with different faults
    /// can be compared bearing by bearing.
    pub fn spoil(&self, sights: &mut [Sight], rng: &mut impl Rng) {
        let bias = self.bias_sigma * normal(rng);
        for sight in sights {
            let (kind, anywhere): (f64, f64) = (rng.random(), rng.random());
            sight.bearing = if kind < self.outlier_rate {
                wrap(TAU * anywhere)
            } else if kind < self.outlier_rate + self.mirrored_rate {
                wrap(sight.bearing + bias + PI)
            } else {
                wrap(sight.bearing + bias)
            };
        }
    }
}

/// A drive whose vehicle is stationary for many readings, with errors that neighbouring ones have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stationary {
    /// The stop, counted from zero.
    pub stop: usize,
    /// How many readings are taken there.
    pub readings: usize,
    /// Correlation of two successive errors at one place.
    pub at_rest: f64,
    /// Metres over which it falls by a factor of e.
    pub distance: f64,
}

impl Stationary {
    /// The bearings: an autoregression of first order along the drive.
    pub fn bearings(&self, track: &Track, rng: &mut impl Rng) -> Vec<Sight> {
        let mut sights: Vec<Sight> = Vec::new();
        let mut error = 0.0;
        for (stop, &position) in track.receivers.iter().enumerate() {
            let readings = if stop == self.stop { self.readings } else { 1 };
            for _ in 0..readings {
                let common = sights.last().map_or(0.0, |last| {
                    let [dx, dy] = [0, 1].map(|d| position[d] - last.position[d]);
                    self.at_rest * (-dx.hypot(dy) / self.distance).exp()
                });
                error = common * error + (1.0 - common * common).sqrt() * normal(rng);
                sights.push(Sight {
                    time_ms: 1000 * sights.len() as u32,
                    position,
                    bearing: wrap(direction(position, track.source) + track.sigma * error),
                    sigma: track.sigma,
                });
            }
        }
        sights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{bearings, generator};

    #[test]
    fn rates_and_bias_are_as_asked_for() {
        let track = Track::a2();
        let faults = Faults {
            outlier_rate: 0.2,
            mirrored_rate: 0.3,
            bias_sigma: 0.05,
        };
        let (mut turned, mut off, mut biases, mut all) = (0.0, 0.0, 0.0, 0.0);
        const RUNS: u64 = 500;
        for run in 0..RUNS {
            let clean = bearings(&track, &mut generator(1, run));
            let mut spoilt = clean.clone();
            faults.spoil(&mut spoilt, &mut generator(2, run));
            let turns: Vec<f64> = (clean.iter().zip(&spoilt))
                .map(|(c, s)| wrap(s.bearing - c.bearing))
                .collect();
            let near = |a: f64, b: f64| wrap(a - b).abs() < 1e-9;
            // The bias is common to most of those that are not turned.
            let bias = *turns
                .iter()
                .max_by_key(|t| turns.iter().filter(|u| near(**t, **u)).count())
                .unwrap();
            let bias = if bias.abs() > 1.5 {
                wrap(bias + PI)
            } else {
                bias
            };
            biases += bias * bias;
            for turn in turns {
                all += 1.0;
                turned += f64::from(u8::from(near(turn, bias + PI)));
                off += f64::from(u8::from(!near(turn, bias) && !near(turn, bias + PI)));
            }
        }
        // Four standard errors.
        assert!((turned / all - 0.3_f64).abs() < 0.011, "{}", turned / all);
        assert!((off / all - 0.2_f64).abs() < 0.01, "{}", off / all);
        let sigma = (biases / RUNS as f64).sqrt();
        assert!((sigma - 0.05_f64).abs() < 0.007, "{sigma}");
    }

    #[test]
    fn errors_at_rest_are_correlated() {
        let track = Track::a1();
        let stationary = Stationary {
            stop: 20,
            readings: 20_000,
            at_rest: 0.9,
            distance: 20.0,
        };
        let sights = stationary.bearings(&track, &mut generator(3, 0));
        assert_eq!(sights.len(), 20_059);
        let errors: Vec<f64> = sights[20..20_020]
            .iter()
            .map(|s| s.residual(track.source) / track.sigma)
            .collect();
        let product: f64 = errors.windows(2).map(|w| w[0] * w[1]).sum();
        let square: f64 = errors.iter().map(|e| e * e).sum();
        // Three standard errors of the correlation, and of the variance of 1,000 independent errors.
        assert!((product / square - 0.9).abs() < 0.01);
        assert!((square / 20_000.0 - 1.0).abs() < 0.14);
    }
}
