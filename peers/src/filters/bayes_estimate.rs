//! `bayes_estimate::estimators::sir`, in f32.

use core::f32::consts::{PI, TAU};

use alloc::vec::Vec;
use bayes_estimate::estimators::sir::{
    SampleState, Samples, normal_noise_sampler, systematic_resampler,
};
use bayes_estimate::models::Estimator;
use nalgebra::{ComplexField, RealField, U2, Vector2};
use rand::rngs::SmallRng;
use rand::{Rng, RngCore, SeedableRng};
use rand_distr::Normal;

use super::Filter;
use crate::workload::{BEARING_VARIANCE, CLOUD_SIGMA_M, SOURCE, Sighting, WALK_VARIANCE};

/// `bayes_estimate`'s sampling-importance-resampling state with its systematic resampler, which it
/// runs after every observation. Its roughening is left out: the random walk of the workload
/// already parts the copies. The weights are plain f32 likelihoods, not logarithms.
pub struct BayesEstimate {
    state: SampleState<f32, U2>,
    generator: SmallRng,
}

impl<const N: usize> Filter<N> for BayesEstimate {
    fn new(seed: u64) -> Self {
        let mut generator = SmallRng::seed_from_u64(seed);
        let [east, north] = SOURCE.map(|centre| {
            Normal::new(centre, CLOUD_SIGMA_M).expect("the workload's sigma is finite")
        });
        let samples: Samples<f32, U2> = (0..N)
            .map(|_| Vector2::new(generator.sample(east), generator.sample(north)))
            .collect::<Vec<_>>();
        Self {
            state: SampleState::equal_likelihood_samples(samples),
            generator,
        }
    }

    fn step(&mut self, sighting: &Sighting) -> Option<[f32; 2]> {
        let sigma = libm::sqrtf(WALK_VARIANCE);
        let noise = normal_noise_sampler(Vector2::new(sigma, sigma));
        self.state.predict_sampled(
            |state: &Vector2<f32>, generator: &mut dyn RngCore| state + noise(generator),
            &mut self.generator,
        );

        let [east, north] = sighting.position;
        self.state.observe(|state: &Vector2<f32>| {
            let predicted = RealField::atan2(state[1] - north, state[0] - east);
            let mut difference = sighting.bearing - predicted;
            if difference > PI {
                difference -= TAU;
            } else if difference < -PI {
                difference += TAU;
            }
            ComplexField::exp(difference * difference * (-0.5 / BEARING_VARIANCE))
        });

        let resampled = self.state.update_resample(
            &mut systematic_resampler,
            &mut |_: &mut Samples<f32, U2>, _: &mut dyn RngCore| {},
            &mut self.generator,
        );
        resampled.ok()?;
        let mean = self.state.state().ok()?;
        Some([mean[0], mean[1]])
    }
}
