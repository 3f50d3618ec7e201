//! The bearings of one run, and what came of them.

use anyhow::{Context, Result};
use foxhunt::aoa::Observation;
use foxhunt_host::{
    reference::{Posterior, mahalanobis},
    simulate,
    tracks::Track,
};
use foxhunt_simulation::Sight;
use rand::Rng;

use crate::papers::statistics::NINETY_FIVE;

/// The bearings of one run.
pub struct Problem {
    pub track: Track,
    pub sights: Vec<Sight>,
    pub observations: Vec<Observation>,
}

impl Problem {
    pub fn new(track: &Track, rng: &mut impl Rng) -> Result<Self> {
        let sights = simulate::bearings(track, rng);
        let observations = sights
            .iter()
            .map(|sight| (*sight).try_into())
            .collect::<Result<_, _>>()?;
        Ok(Self {
            track: track.clone(),
            sights,
            observations,
        })
    }

    /// Of an estimate, in metres east and north.
    pub fn error(&self, position: [f32; 2]) -> [f64; 2] {
        [0, 1].map(|d| f64::from(position[d]) - self.track.source[d])
    }
}

/// What a method made of one run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Error after the last bearing, in metres east and north.
    pub error: [f64; 2],
    /// Whether the 95 % ellipse holds the source.
    pub covered: bool,
    /// Error after each bearing; empty for a method that is asked once, at the end.
    pub path: Vec<Option<[f64; 2]>>,
    /// Likelihoods of one bearing at one place that it evaluated; zero if that is not what it does.
    pub evaluations: u64,
}

impl Outcome {
    /// That of the exact posterior.
    pub fn exact(problem: &Problem) -> Result<Self> {
        let posterior = Posterior::new(&problem.sights).context("the posterior has no bounds")?;
        let error = [0, 1].map(|d| posterior.mean[d] - problem.track.source[d]);
        Ok(Self {
            error,
            covered: mahalanobis(error, &posterior.covariance) <= NINETY_FIVE,
            path: Vec::new(),
            evaluations: 0,
        })
    }
}
