//! A bias that depends on the direction from the bow: mutual coupling, the body of the vehicle.

use rand::Rng;

use crate::{reference::turns, tracks::Track};
use foxhunt_simulation::{
    Sight,
    random::normal,
    sight::{direction, wrap},
};

/// The bias of an array: a mean and harmonics of the direction from the bow.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Amplitudes, each in its own sigma.
    amplitudes: Vec<f64>,
    harmonics: usize,
    sigma: f64,
}

impl Curve {
    /// One of random amplitudes, whose standard deviation is `sigma` in every direction, in radians.
    pub fn random(harmonics: usize, sigma: f64, rng: &mut impl Rng) -> Self {
        Self {
            amplitudes: (0..=2 * harmonics).map(|_| normal(rng)).collect(),
            harmonics,
            sigma,
        }
    }

    /// At a direction from the bow, in radians.
    pub fn at(&self, relative: f64) -> f64 {
        let terms = turns(relative, self.harmonics, self.sigma);
        terms.zip(&self.amplitudes).map(|(t, a)| t * a).sum()
    }

    /// Biased bearings along a track, and the heading of each.
    pub fn bearings(&self, track: &Track, rng: &mut impl Rng) -> (Vec<Sight>, Vec<f64>) {
        let headings = headings(&track.receivers);
        let one = |(k, (&position, heading)): (usize, (&[f64; 2], &f64))| {
            let towards = direction(position, track.source);
            let bias = self.at(towards - heading);
            Sight {
                time_ms: 1000 * k as u32,
                position,
                bearing: wrap(towards + bias + track.sigma * normal(rng)),
                sigma: track.sigma,
            }
        };
        let places = track.receivers.iter().zip(&headings);
        (places.enumerate().map(one).collect(), headings)
    }
}

/// From each place to the next, in radians counter-clockwise from east; at the last, as before.
fn headings(places: &[[f64; 2]]) -> Vec<f64> {
    let mut headings: Vec<f64> = (places.windows(2))
        .map(|leg| direction(leg[0], leg[1]))
        .collect();
    headings.extend(headings.last().copied());
    headings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{Biases, ByDirection, Difference, Model, Posterior, Prior, Square};
    use foxhunt_simulation::random::generator;

    #[test]
    fn a_curve_is_as_large_as_asked_for() {
        let square: f64 = (0..2000)
            .map(|run| {
                Curve::random(2, 0.2, &mut generator(1, run))
                    .at(1.0)
                    .powi(2)
            })
            .sum();
        // Three standard errors.
        assert!(((square / 2000.0) / 0.04 - 1.0).abs() < 0.1);
    }

    /// What the posterior says of the bias is off by as much as it says.
    #[test]
    fn the_posterior_finds_it() {
        let track = Track::a2();
        let (mut square, mut count) = (0.0, 0.0);
        for run in 0..40 {
            let curve = Curve::random(2, 0.1, &mut generator(2, run));
            let (sights, headings) = curve.bearings(&track, &mut generator(3, run));
            let model = Model {
                biases: Biases::ByDirection(ByDirection::new(headings, 2, 0.1)),
                prior: Prior::Ranged {
                    centre: track.receivers[0],
                    nearest_m: 1.0,
                    range_m: 20_000.0,
                },
                ..Model::default()
            };
            let centre = track.receivers[0];
            let around = Square { centre, side: 2e5 };
            let posterior = Posterior::within_nearly(&around, &sights, &model).unwrap();
            if run < 3 {
                let exact = Posterior::within(&around, &sights, &model).unwrap();
                let from = (exact.mean, &exact.covariance);
                let off = Difference::new(posterior.mean, &posterior.covariance, from);
                assert!(off.mean < 0.01 && off.sigma < 0.01, "{off:?}");
            }
            let (mean, covariance) = posterior.biases();
            let off = mean - nalgebra::DVector::from_row_slice(&curve.amplitudes);
            let factor = covariance.cholesky().unwrap();
            square += off.dot(&factor.solve(&off));
            count += 5.0;
        }
        // Three standard errors.
        let ratio: f64 = square / count;
        assert!((ratio - 1.0).abs() < 0.3, "{ratio}");
    }
}
