//! A vehicle at rest, whose bearings repeat each other's errors.

use foxhunt_simulation::{
    Sight,
    random::normal,
    sight::{direction, wrap},
};
use rand::Rng;

use crate::tracks::Track;

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
    use foxhunt_simulation::random::generator;

    use super::*;

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
