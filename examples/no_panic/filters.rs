//! Filters, and what they are made of.

use core::hint::black_box;

use foxhunt::{
    aoa::BearingLikelihood,
    estimate::{self, Ellipse, Symmetric2},
    filter::ParticleFilter,
    kalman::{Covariance, Gaussian, Unscented},
    math,
    model::{ConstantVelocity, Dynamics, RandomWalk},
    particles::{self, Particles},
    proposal::{AuxiliaryFilter, PointMassFilter, Transition, UnscentedParticleFilter},
    random::{self, SeedableRng, Xoshiro128PlusPlus},
    refine::{DifferentialEvolution, Firefly, FishSchool, Memory, Refinement},
    resample::{Scheme, resample},
    weights::Weights,
};
use foxhunt_problems::{bearings::Track, gamma, growth};

use crate::{
    bearings::observation,
    values::{any, some, some_mut},
};

pub fn math() {
    black_box(math::exp(any(0.0)));
    black_box(math::ln(any(0.0)));
    black_box(math::sqrt(any(0.0)));
    black_box(math::wrap(any(0.0)));
    black_box(math::sin_cos(any(0.0)));
    black_box(math::atan2(any(0.0), any(0.0)));
}

pub fn random(rng: &mut Xoshiro128PlusPlus) {
    black_box(random::uniform(rng));
    black_box(random::uniform_open(rng));
    black_box(random::normal(rng));
}

pub fn cloud(rng: &mut Xoshiro128PlusPlus) {
    let mut cloud = any(Particles::<3, 50>::EMPTY);
    cloud.initialise(rng, |_| any([0.0; 3]));
    cloud.set(any(0), any([0.0; 3]));
    black_box(cloud.get(any(0)));
    let mut weights = any(Weights::<50>::EMPTY);
    *weights.log_likelihoods_mut() = any([0.0; 50]);
    _ = black_box((weights.update(), weights.normalise()));
    weights.resample(any(Scheme::Systematic), rng, |ancestors, scratch| {
        cloud.gather(ancestors, scratch);
    });
    black_box((weights.log_weights(), weights.log_sum()));

    let (mut a, mut b, mut c) = (any([0.0; 20]), any([0.0; 20]), any([0.0; 20]));
    let mut columns = [some_mut(&mut a), some_mut(&mut b)];
    particles::write(&mut columns, any(0), any([0.0; 2]));
    let walk = any(RandomWalk { sigma: [0.0; 2] });
    walk.predict(&mut columns, any(0.0), rng);
    black_box(walk.step(any([0.0; 2]), any(0.0), rng));
    let [a, b] = columns;
    let columns = [&*a, &*b];
    black_box(particles::read(&columns, any(0)));
    black_box(estimate::mean(&columns, some(&c)));
    black_box(estimate::covariance(&columns, some(&c)));
    black_box(estimate::quantile(some(a), some(b), any(0.0)));
    let ancestors = resample(any(Scheme::Systematic), some(a), some_mut(&mut c), rng);
    ancestors.gather(some_mut(a), some_mut(b));
    black_box(ancestors.iter().sum::<usize>());
    let matrix = any(Symmetric2::ZERO).plus_outer(any(0.0), any([0.0; 2]));
    black_box((matrix.inverse(), matrix.mahalanobis_squared(any([0.0; 2]))));
    black_box(Ellipse::of_sigmas(any([0.0; 2]), matrix, any(0.0)));
    let ellipse = Ellipse::of_normal(any([0.0; 2]), matrix, any(0.0));
    black_box(ellipse.contains(any([0.0; 2])));
}

pub fn filter(rng: &mut Xoshiro128PlusPlus) {
    let mut filter = any(ParticleFilter::<4, 50>::new());
    filter.initialise(rng, |_| any([0.0; 4]));
    filter.predict(
        &any(ConstantVelocity {
            sigma_m_s2: [0.0; 2],
        }),
        any(0.0),
        rng,
    );
    _ = black_box(filter.update(&|state: &[f32; 4]| any(state[0])));
    if let Some(observation) = observation() {
        _ = black_box(filter.update(&BearingLikelihood::new(&observation)));
    }
    black_box(filter.resample_below(any(0.0), rng));
    filter.resample(any(Scheme::Systematic), rng);
    black_box((
        filter.mean(),
        filter.covariance(),
        filter.effective_sample_size(),
    ));
    _ = black_box(filter.step(
        &any(RandomWalk { sigma: [0.0; 4] }),
        &|_: &[f32; 4]| any(0.0),
        any(0.0),
        rng,
    ));
    black_box((filter.columns_mut(), any(0.0)));
    black_box((filter.particles(), filter.weights(), filter.log_weights()));
}

pub fn refine<const D: usize>(rng: &mut Xoshiro128PlusPlus) {
    let mut memory = Memory::<D, 50>::EMPTY;
    let mut states = any([[0.0; 60]; D]);
    let mut columns = states.each_mut().map(|column| some_mut(column));
    let target = |state: &[f32; D]| any(state[0]);
    let school = any(FishSchool::DEFAULT);
    _ = black_box(school.check());
    black_box(Refinement::<D>::evaluations(&school, any(3)));
    black_box(school.refine(&mut columns, &target, &mut memory, rng));
    let firefly = any(Firefly::DEFAULT);
    _ = black_box(firefly.check());
    black_box(firefly.refine(&mut columns, &target, &mut memory, rng));
    let evolution = any(DifferentialEvolution::DEFAULT);
    _ = black_box(evolution.check());
    black_box(evolution.refine(&mut columns, &target, &mut memory, rng));
}

pub fn kalman(rng: &mut Xoshiro128PlusPlus) {
    let Some(mut covariance) = Covariance::<3>::new(&any([[0.0; 3]; 3])) else {
        return;
    };
    covariance.add(any([0.0; 3]));
    black_box((covariance.matrix(), covariance.sigmas()));
    let mut state = any(Gaussian {
        mean: [0.0; 3],
        covariance: covariance.plus(&any(Covariance::diagonal([0.0; 3]))),
    });
    black_box((state.draw(rng), state.log_density(any([0.0; 3]))));
    let noise = any(Covariance::<2>::diagonal([0.0; 2]));
    _ = black_box(state.predict(&any([[0.0; 3]; 3]), &covariance));
    _ = black_box(state.update(&any([[0.0; 3]; 2]), any([0.0; 2]), &noise));
    let unscented = any(Unscented::DEFAULT);
    _ = black_box(unscented.check());
    _ = black_box(unscented.predict(&mut state, |x| any(*x), &covariance));
    _ = black_box(unscented.update(&mut state, |[x, y, _]| any([*x, *y]), &noise));
}

pub fn propose(rng: &mut Xoshiro128PlusPlus) {
    let covariance = any(Covariance::diagonal([0.0]));
    let mut unscented = any(UnscentedParticleFilter::<1, 10>::EMPTY);
    unscented.initialise(rng, &covariance, |_| any([0.0]));
    unscented.forget();
    let mut auxiliary = any(AuxiliaryFilter::<1, 10>::EMPTY);
    auxiliary.initialise(rng, |_| any([0.0]));
    let mut points = any(PointMassFilter::<1, 10>::EMPTY);
    points.initialise_at(any([0.0]));
    let mut memory = any([0.0; 32]);
    let seed = any(1);
    for (dynamics, _, measurement) in gamma::simulate(
        any(0.0),
        any(0.0),
        &mut Xoshiro128PlusPlus::seed_from_u64(seed),
    )
    .take(any(50))
    {
        let parameters = &Unscented::DEFAULT;
        _ = black_box(unscented.step(parameters, &dynamics, &measurement, any(0.0), rng));
        black_box((unscented.mean(), unscented.covariance()));
        unscented.resample(any(Scheme::Systematic), rng);
        _ = black_box(auxiliary.step(&dynamics, &measurement, any(0.0), &mut memory, rng));
        black_box((auxiliary.mean(), auxiliary.covariance()));
        _ = black_box(points.step(&dynamics, &measurement, any(0.0), &mut memory));
        black_box((points.mean(), points.covariance()));
    }
    for (dynamics, truth, measurement) in growth::simulate(rng).take(any(50)) {
        black_box((dynamics.mean(&[truth], any(0.0)), measurement));
    }

    let walk = any(RandomWalk { sigma: [0.0; 2] });
    let mut memory = any([0.0; 300]);
    let mut auxiliary = any(AuxiliaryFilter::<2, 10>::EMPTY);
    let likelihood = |state: &[f32; 2]| any(state[0]);
    _ = black_box(auxiliary.step(&walk, &likelihood, any(0.0), &mut memory, rng));
    let (low, high) = any(([0.0; 2], [0.0; 2]));
    let prior = |state: &[f32; 2]| any(state[1]);
    let mut points = any(PointMassFilter::<2, 10>::EMPTY);
    _ = black_box(points.initialise(low, high, prior, &mut memory));
    _ = black_box(points.step(&walk, &likelihood, any(0.0), &mut memory));
    for observation in any(Track::A2).simulate(rng) {
        black_box(observation);
    }
}
