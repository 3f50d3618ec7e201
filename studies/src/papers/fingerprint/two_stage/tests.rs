//! The particle filter beside the Kalman filter, which is exact for this model.

use super::*;
use foxhunt::filter::UpdateError;
use foxhunt::kalman::KalmanError;
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};

const WALK: [[f32; 2]; 9] = [
    [1.0, 1.0],
    [4.0, 1.5],
    [11.0, 2.0],
    [14.0, 1.0],
    [22.0, 0.5],
    [24.0, 1.5],
    [30.0, 1.0],
    [36.0, 2.0],
    [39.0, 1.5],
];

fn matched() -> Model {
    let observation = Covariance::new(&[[9.0, 1.0], [1.0, 2.0]]).unwrap();
    Model {
        observation,
        ..Model::AS_PRINTED
    }
}

/// The mean over 40 clouds of 1,000 particles scatters by less than 1 % of the posterior's sigma (40,000 particles,
/// resampled in every step); 5 % are allowed, so this fails by chance less often than anything else here.
#[test]
fn many_particles_come_to_what_the_kalman_filter_says() {
    for model in [Model::AS_PRINTED, matched()] {
        let mut kalman = model.kalman_start(WALK[0]);
        for found in &WALK[1..] {
            model.kalman_step(&mut kalman, 2.0, *found).unwrap();
        }
        let mut mean = [0.0; 4];
        let mut variance = [0.0; 4];
        for seed in 0..40 {
            let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
            let mut cloud = Cloud::<1000>::EMPTY;
            cloud.start_around(WALK[0], &model, &mut rng);
            for found in &WALK[1..] {
                cloud.step(2.0, *found, &model, &mut rng).unwrap();
            }
            for k in 0..4 {
                mean[k] += cloud.mean()[k] / 40.0;
                variance[k] += cloud.filter.covariance()[k][k] / 40.0;
            }
        }
        for (k, sigma) in kalman.covariance.sigmas().iter().enumerate() {
            assert!((mean[k] - kalman.mean[k]).abs() < 0.05 * sigma);
            assert!((variance[k].sqrt() / sigma - 1.0).abs() < 0.05);
        }
    }
}

#[test]
fn the_printed_covariance_lags_behind_a_walk() {
    let [mut printed, mut matched] = [Model::AS_PRINTED, matched()].map(|model| {
        let state = model.kalman_start([0.0, 1.5]);
        (model, state, 0.0f32)
    });
    for step in 1..=16 {
        let x = 5.0 * step as f32;
        for (model, state, lag) in [&mut printed, &mut matched] {
            model.kalman_step(state, 2.0, [x, 1.5]).unwrap();
            *lag = lag.max(x - state.mean[0]);
        }
    }
    assert!(printed.2 > 5.0, "{}", printed.2);
    assert!(matched.2 < 2.0, "{}", matched.2);
}

#[test]
fn a_start_anywhere_in_a_box_learns_from_its_first_match() {
    let model = matched();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(5);
    let mut cloud = Cloud::<2000>::EMPTY;
    let (least, most) = ([0.0, 0.0], [80.0, 3.5]);
    cloud
        .start_within(least, most, [30.0, 1.75], &model, &mut rng)
        .unwrap();
    assert!((cloud.mean()[0] - 30.0).abs() < 1.0);
    let [x, y, ..] = cloud.filter.particles().columns();
    assert!(x.iter().all(|x| (0.0..=80.0).contains(x)));
    assert!(y.iter().all(|y| (0.0..=3.5).contains(y)));
}

#[test]
fn impossible_matches_are_refused() {
    let model = Model::AS_PRINTED;
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(6);
    let mut cloud = Cloud::<50>::EMPTY;
    cloud.start_around([normal(&mut rng), 0.0], &model, &mut rng);
    for found in [[f32::NAN, 0.0], [f32::MAX, 0.0]] {
        let refused = cloud.step(2.0, found, &model, &mut rng);
        assert_eq!(refused, Err(UpdateError::AllWeightsZero));
        assert!(cloud.mean().iter().all(|x| x.is_finite()));
    }
    let mut state = model.kalman_start([0.0; 2]);
    let before = state;
    for (dt, found) in [(f32::NAN, [0.0; 2]), (1.0, [f32::NAN, 0.0])] {
        let refused = model.kalman_step(&mut state, dt, found);
        assert!(matches!(refused, Err(KalmanError::NotFinite)));
    }
    assert_eq!(state, before);
}
