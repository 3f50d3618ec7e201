//! What a method made of one run.

use anyhow::Result;
use foxhunt::{
    aoa::{Answer, Fix, Locate, Robust, robust::Config},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::reference::{Posterior, mahalanobis};
use foxhunt_simulation::Sight;

use super::statistics::NINETY_FIVE;

/// What a method made of one run.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// In metres; infinite without a fix.
    pub error: f64,
    /// Whether the 95 % ellipse holds the source.
    pub covered: bool,
}

impl Outcome {
    /// That of the exact posterior.
    pub fn exact(posterior: &Posterior, source: [f64; 2]) -> Self {
        let error = [0, 1].map(|d| posterior.mean[d] - source[d]);
        Self {
            error: error[0].hypot(error[1]),
            covered: mahalanobis(error, &posterior.covariance) <= NINETY_FIVE,
        }
    }

    /// That of a locator.
    pub fn of(answer: Answer, source: [f64; 2]) -> Self {
        let Answer::Fix(fix) = answer else {
            return Self {
                error: f64::INFINITY,
                covered: false,
            };
        };
        Self {
            error: distance(&fix, source),
            covered: fix.ellipse(0.95).contains(source.map(|v| v as f32)),
        }
    }
}

/// Of a fix from the source, in metres.
fn distance(fix: &Fix, source: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|d| f64::from(fix.position[d]) - source[d]);
    x.hypot(y)
}

/// The last answer to the bearings.
pub fn locate(config: &Config, sights: &[Sight], seed: u64) -> Result<Answer> {
    locate_by::<Robust<256>>(config, sights, seed)
}

/// The last answer of another locator.
pub fn locate_by<L: Locate>(config: &L::Config, sights: &[Sight], seed: u64) -> Result<Answer> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(L::EMPTY);
    for sight in sights {
        locator.push(&(*sight).try_into()?, config, &mut rng)?;
    }
    Ok(locator.answer())
}
