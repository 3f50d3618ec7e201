use foxhunt::{
    kalman::{Covariance, Unscented},
    proposal::{AuxiliaryFilter, PointMassFilter, UnscentedParticleFilter},
    random::{SeedableRng, Xoshiro128PlusPlus},
    resample::Scheme,
};
use foxhunt_problems::gamma;

use super::{Case, Digest};

pub const CASES: &[Case] = &[("proposal::gamma_noise", gamma_noise)];

/// The three filters on one run of the gamma-noise model.
fn gamma_noise() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut digest = Digest::new();
    let mut unscented = UnscentedParticleFilter::<1, 10>::EMPTY;
    unscented.initialise(&mut rng, &Covariance::diagonal([1e-3]), |_| [1.0]);
    let mut auxiliary = AuxiliaryFilter::<1, 10>::EMPTY;
    auxiliary.initialise(&mut rng, |_| [1.0]);
    let mut points = PointMassFilter::<1, 10>::EMPTY;
    points.initialise_at([1.0]);
    let mut memory = [0.0; 64];
    let mut simulator = rng.clone();
    for (dynamics, _, measurement) in gamma::simulate(0.04, 0.1, &mut simulator).take(50) {
        let parameters = &Unscented::DEFAULT;
        let evidence = [
            unscented
                .step(parameters, &dynamics, &measurement, 1.0, &mut rng)
                .ok(),
            auxiliary
                .step(&dynamics, &measurement, 1.0, &mut memory, &mut rng)
                .ok(),
            points.step(&dynamics, &measurement, 1.0, &mut memory).ok(),
        ];
        digest.add(&evidence.map(|evidence| evidence.unwrap_or(f32::NAN)));
        digest.add(&[unscented.mean()[0], auxiliary.mean()[0], points.mean()[0]]);
        unscented.resample(Scheme::Systematic, &mut rng);
    }
    digest
}
