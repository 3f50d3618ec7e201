//! foxhunt's own filter.

use foxhunt::aoa::{Bearing, BearingLikelihood, Observation};
use foxhunt::filter::ParticleFilter;
use foxhunt::model::RandomWalk;
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
use foxhunt::resample::Scheme;

use super::Filter;
use crate::workload::{BEARING_VARIANCE, CLOUD_SIGMA_M, SOURCE, Sighting, WALK_VARIANCE};

/// foxhunt's bootstrap filter, resampling after every bearing. The mean is that of the weighted
/// cloud, before resampling.
pub struct Foxhunt<const N: usize> {
    filter: ParticleFilter<2, N>,
    generator: Xoshiro128PlusPlus,
}

impl<const N: usize> Filter<N> for Foxhunt<N> {
    fn new(seed: u64) -> Self {
        let mut generator = Xoshiro128PlusPlus::seed_from_u64(seed);
        let mut filter = ParticleFilter::new();
        filter.initialise(&mut generator, |generator| {
            SOURCE.map(|centre| centre + CLOUD_SIGMA_M * normal(generator))
        });
        Self { filter, generator }
    }

    fn step(&mut self, sighting: &Sighting) -> Option<[f32; 2]> {
        let walk = RandomWalk {
            sigma: [libm::sqrtf(WALK_VARIANCE); 2],
        };
        let bearing = Bearing::from_radians(sighting.bearing);
        let sigma = libm::sqrtf(BEARING_VARIANCE);
        // Only its likelihood is of interest here, which does not depend on the time.
        let observation = Observation::new(0, sighting.position, bearing, sigma).ok()?;

        self.filter.predict(&walk, 1.0, &mut self.generator);
        self.filter
            .update(&BearingLikelihood::new(&observation))
            .ok()?;
        let mean = self.filter.mean();
        self.filter
            .resample(Scheme::Systematic, &mut self.generator);
        Some(mean)
    }
}
