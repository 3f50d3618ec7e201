use foxhunt::{
    filter::{ParticleFilter, UpdateError},
    model::{ConstantVelocity, RandomWalk},
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
};

use super::{Case, Digest, assert_normal};

pub const CASES: &[Case] = &[
    ("filter::tracks_a_walk", tracks_a_walk),
    ("filter::tracks_a_velocity", tracks_a_velocity),
    (
        "filter::impossible_measurements_change_nothing",
        impossible_measurements_change_nothing,
    ),
];

fn tracks_a_walk() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut filter = ParticleFilter::<1, 200>::new();
    filter.initialise(&mut rng, |rng| [normal(rng)]);
    let dynamics = RandomWalk { sigma: [0.5] };
    let mut digest = Digest::new();
    let mut truth = 0.0;
    for _ in 0..50 {
        truth += 0.5 * normal(&mut rng);
        let measured = truth + 0.2 * normal(&mut rng);
        filter.resample_below(0.5, &mut rng);
        filter.predict(&dynamics, 1.0, &mut rng);
        let fit = |[x]: &[f32; 1]| -0.5 * (measured - x) * (measured - x) / (0.2 * 0.2);
        let evidence = filter.update(&fit).expect("some particle is near");
        digest.add(&[evidence, filter.mean()[0], filter.covariance()[0][0]]);
        digest.add(&[filter.effective_sample_size()]);
        assert_normal(&filter.particles().columns());
        assert_normal(&[filter.weights()]);
    }
    assert!((filter.mean()[0] - truth).abs() < 1.0);
    digest
}

fn tracks_a_velocity() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut filter = ParticleFilter::<4, 300>::new();
    filter.initialise(&mut rng, |rng| {
        [
            normal(rng),
            normal(rng),
            1.0 + 0.3 * normal(rng),
            0.3 * normal(rng),
        ]
    });
    let dynamics = ConstantVelocity {
        sigma_m_s2: [0.05, 0.08],
    };
    let mut digest = Digest::new();
    for half in 1..=40_u8 {
        filter.resample_below(0.5, &mut rng);
        filter.predict(&dynamics, 0.5, &mut rng);
        let east = 0.5 * f32::from(half);
        let fit = |[x, y, ..]: &[f32; 4]| -0.5 * ((x - east) * (x - east) + y * y);
        filter.update(&fit).expect("some particle is near");
        digest.add(&filter.mean());
        digest.add(filter.covariance().as_flattened());
        assert_normal(&filter.particles().columns());
        assert_normal(&[filter.weights()]);
    }
    let [x, y, vx, _] = filter.mean();
    assert!((x - 20.0).abs() < 1.0 && y.abs() < 1.0 && (vx - 1.0).abs() < 0.3);
    digest
}

fn impossible_measurements_change_nothing() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
    let mut filter = ParticleFilter::<1, 100>::new();
    filter.initialise(&mut rng, |rng| [normal(rng)]);
    let likely = |[x]: &[f32; 1]| -x * x;
    let mut digest = Digest::new();
    digest.add(&[filter.update(&likely).expect("every particle has weight")]);
    let (mean, size) = (filter.mean(), filter.effective_sample_size());
    for impossible in [f32::NEG_INFINITY, f32::NAN, f32::INFINITY] {
        assert_eq!(
            filter.update(&|_: &[f32; 1]| impossible),
            Err(UpdateError::AllWeightsZero)
        );
        assert_eq!(
            (filter.mean(), filter.effective_sample_size()),
            (mean, size)
        );
        let partly = |[x]: &[f32; 1]| if *x < 0.0 { impossible } else { -x };
        let mut filter = filter.clone();
        let likely = filter.update(&partly).expect("some have weight");
        let living = filter.effective_sample_size();
        assert!(filter.mean()[0] > 0.0 && living < 0.7 * size);
        digest.add(&[likely, living]);
        digest.add(filter.particles().columns()[0]);
    }
    digest
}
