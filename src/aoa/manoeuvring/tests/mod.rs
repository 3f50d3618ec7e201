extern crate std;

mod chase;
mod chases;
mod oracle;
mod parked;
mod several;

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use super::*;
use crate::aoa::robust::outside::odds;
use crate::aoa::{Bearing, robust};
use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform};
use crate::resample::{Scheme, resample};
use crate::weights;
use chase::Chase;
use std::{println, vec, vec::Vec};

fn generator(seed: u64) -> Xoshiro128PlusPlus {
    Xoshiro128PlusPlus::seed_from_u64(seed)
}

fn towards(position: [f32; 2], target: [f32; 2], error: f32, deviation: f32) -> Observation {
    let angle = (target[1] - position[1]).atan2(target[0] - position[0]);
    Observation::new(position, Bearing::from_radians(angle + error), deviation).unwrap()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn median(values: &mut [f32]) -> f32 {
    quantile(values, 0.5)
}

fn quantile(values: &mut [f32], share: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    let index = (values.len() as f32 * share) as usize;
    values.get(index).copied().unwrap_or(f32::NAN)
}

#[test]
fn settings_are_checked() {
    let settings = Settings::default();
    for wrong in [0.0, -1.0, 1e7, f32::NAN, f32::INFINITY] {
        assert_eq!(settings.speed(wrong), Err(SettingsError::Speed));
        assert_eq!(settings.parked_s(wrong), Err(SettingsError::Parked));
        assert_eq!(settings.driving_s(wrong), Err(SettingsError::Driving));
        assert_eq!(settings.straight_s(wrong), Err(SettingsError::Straight));
    }
    assert!(settings.speed(1.4).is_ok() && settings.straight_s(60.0).is_ok());
}

#[test]
fn without_time_nothing_moves() {
    let bearings = Chase::random(&mut generator(1)).bearings(1);
    for seconds in [0.0, f32::NAN, -1.0, f32::INFINITY] {
        let mut pursuit = Pursuit::<256, 64>::new(Settings::default());
        let mut locator = RobustLocator::<256, 64>::new(robust::Settings::default());
        let [mut a, mut b] = [generator(2), generator(2)];
        for step in &bearings {
            let answer = pursuit.push_after(step.observation, seconds, &mut a);
            assert_eq!(answer, locator.push(step.observation, &mut b));
        }
        assert_eq!(pursuit.motion(), None);
    }
}

#[test]
fn a_clone_goes_on_as_the_original() {
    let bearings = Chase::random(&mut generator(3)).bearings(3);
    let mut original = Pursuit::<128, 32>::new(Settings::default());
    let mut rng = generator(3);
    for (i, step) in bearings.iter().enumerate() {
        if i % 40 == 39 {
            let mut copy = original.clone();
            let [mut a, mut b] = [rng.clone(), rng.clone()];
            for step in &bearings[i..] {
                let answer = original.clone().answer();
                assert_eq!(answer, copy.answer());
                let answer = original.push_after(step.observation, 1.0, &mut a);
                assert_eq!(answer, copy.push_after(step.observation, 1.0, &mut b));
                assert_eq!(original.motion(), copy.motion());
            }
            // Once more from the start.
            original.reset();
            assert_eq!(original.answer(), NOTHING);
            assert_eq!(original.motion(), None);
        }
        original.push_after(step.observation, 1.0, &mut rng);
    }
}

#[test]
fn anything_that_is_an_observation_is_taken() {
    let far = Observation::MAX_COORDINATE_M;
    let (sharp, blunt) = (
        Observation::MIN_DEVIATION_RAD,
        Observation::MAX_DEVIATION_RAD,
    );
    let mut rng = generator(4);
    for round in 0..60 {
        let errors = robust::Errors::new().bias_deviation(0.5).unwrap();
        let settings = Settings::new(robust::Settings::new(errors));
        let mut pursuit = Pursuit::<64, 8>::new(settings);
        let times = [0.0, 1e-3, 1.0, 60.0, 3600.0, 1e9];
        let size = [1.0, 100.0, 1e4, far][round % 4];
        for i in 0..150 {
            let mut coordinate = || size * (2.0 * uniform(&mut rng) - 1.0);
            let position = [coordinate(), coordinate()];
            let deviation = match round % 3 {
                0 => sharp,
                1 => 0.05,
                _ => blunt,
            };
            let target = if i % 3 == 0 {
                [coordinate(), 0.0]
            } else {
                [0.0; 2]
            };
            let observation = towards(position, target, 0.0, deviation);
            let seconds = times[if round < 30 { round % 6 } else { i % 6 }];
            if let Answer::Fix(fix) = pursuit.push_after(observation, seconds, &mut rng) {
                let all = fix.position.iter().chain(fix.covariance.as_flattened());
                assert!(all.clone().all(|v| v.is_finite()), "{fix:?}");
            }
            if let Some(motion) = pursuit.motion() {
                assert!((0.0..=1.0).contains(&motion.moving), "{motion:?}");
                assert!(motion.velocity.iter().all(|v| v.is_finite()), "{motion:?}");
                assert!(motion.deviation.is_finite(), "{motion:?}");
            }
        }
    }
}

#[test]
fn memory_is_as_stated() {
    let bytes = size_of::<Pursuit<256, 64>>();
    println!("{bytes} bytes");
    assert!(bytes <= 19_500);
}
