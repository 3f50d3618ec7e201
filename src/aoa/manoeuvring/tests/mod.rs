extern crate std;

mod alternatives;
mod chase;
mod chases;
mod reference;
mod several;
mod stationary;
mod stations;

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use super::RECENT;
use super::*;
use crate::aoa::testing::{STRAIGHT, at, is_zero};
use crate::aoa::{
    Answer, Bearing, Locate, Locator, Mixture, Observation, PushError, Robust, robust,
};
use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform};
use crate::resample::{Scheme, resample};
use chase::Chase;
use std::{println, vec, vec::Vec};

fn generator(seed: u64) -> Xoshiro128PlusPlus {
    Xoshiro128PlusPlus::seed_from_u64(seed)
}

fn towards(
    time_ms: u32,
    position: [f32; 2],
    target: [f32; 2],
    error: f32,
    sigma_rad: f32,
) -> Observation {
    let angle = (target[1] - position[1]).atan2(target[0] - position[0]);
    Observation::new(
        time_ms,
        position,
        Bearing::from_radians(angle + error),
        sigma_rad,
    )
    .unwrap()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn median(values: &mut [f32]) -> f32 {
    quantile(values, 0.5)
}

fn quantile(values: &mut [f32], fraction: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    let index = (values.len() as f32 * fraction) as usize;
    values.get(index).copied().unwrap_or(f32::NAN)
}

type Subject<const N: usize, const B: usize> = Manoeuvring<Robust<N, B>>;

fn subject() -> Locator<Subject<256, 64>> {
    Locator::new(Config::new(STRAIGHT)).unwrap()
}

#[test]
fn configurations_are_checked() {
    let of = |change: fn(&mut Config, f32), value: f32| {
        let mut config = Config::DEFAULT;
        change(&mut config, value);
        let result = config.check();
        assert_eq!(result, <Subject<256, 64> as Locate>::check(&config));
        result.err().map(|error| error.field())
    };
    for wrong in [0.0, -1.0, 1e7, f32::NAN, f32::INFINITY] {
        assert_eq!(of(|c, v| c.speed_m_s = v, wrong), Some("speed_m_s"));
        assert_eq!(of(|c, v| c.slowest_m_s = v, wrong), Some("slowest_m_s"));
        assert_eq!(of(|c, v| c.stationary_s = v, wrong), Some("stationary_s"));
        assert_eq!(of(|c, v| c.moving_s = v, wrong), Some("moving_s"));
        assert_eq!(of(|c, v| c.straight_s = v, wrong), Some("straight_s"));
    }
    assert_eq!(of(|c, v| c.stationary.range_m = v, 0.0), Some("range_m"));
    assert!(
        [Config::DEFAULT, Config::WALKER, Config::ROOM]
            .iter()
            .all(|config| config.check().is_ok())
    );
}

#[test]
fn without_time_nothing_moves() {
    let bearings = Chase::random(&mut generator(1)).bearings(1);
    let mut wrapped = subject();
    let mut alone = Locator::<Robust<256, 64>>::new(STRAIGHT).unwrap();
    let [mut a, mut b] = [generator(2), generator(2)];
    // Bearings of one time, each of a station of its own.
    for (station, step) in (0..=u8::MAX).zip(&bearings) {
        let observation = at(1000, &step.observation).from_station(station);
        let answer = wrapped.push(&observation, &mut a);
        assert_eq!(answer, alone.push(&observation, &mut b));
    }
    assert!(wrapped.fix().is_some());
    assert_eq!(wrapped.state().motion(), None);
}

#[test]
fn a_clone_goes_on_as_the_original() {
    let bearings = Chase::random(&mut generator(3)).bearings(3);
    let mut original = Locator::<Subject<128, 32>>::new(Config::DEFAULT).unwrap();
    let mut rng = generator(3);
    for (i, step) in bearings.iter().enumerate() {
        if i % 40 == 39 {
            let mut copy = original.clone();
            let [mut a, mut b] = [rng.clone(), rng.clone()];
            for step in &bearings[i..] {
                assert_eq!(original.answer(), copy.answer());
                let answer = original.push(&step.observation, &mut a);
                assert_eq!(answer, copy.push(&step.observation, &mut b));
                assert_eq!(original.state().motion(), copy.state().motion());
            }
            // Once more from the start.
            original.reset();
            assert_eq!(original.answer(), Answer::NOTHING);
            assert_eq!(original.state().motion(), None);
        }
        original.push(&step.observation, &mut rng).unwrap();
    }
}

#[test]
fn a_late_bearing_goes_to_the_stationary_explanation() {
    let bearings = Chase::random(&mut generator(5)).bearings(5);
    let (mut locator, mut rng) = (subject(), generator(5));
    let take = |i: usize| i % 10 != 5;
    for (_, step) in bearings
        .iter()
        .enumerate()
        .filter(|(i, _)| take(*i))
        .take(90)
    {
        locator.push(&step.observation, &mut rng).unwrap();
    }
    let before = locator.fix().unwrap();
    let late = &bearings[65].observation;
    let fix = locator.push(late, &mut rng).unwrap().fix().unwrap();
    assert_eq!(fix.bearings, before.bearings + 1);
    assert_eq!(locator.state().recent.len(), RECENT);
    // What is refused changes nothing.
    let unchanged = locator.clone();
    for (observation, error) in [
        (*late, PushError::Duplicate),
        (bearings[99].observation, PushError::Duplicate),
        (at(u32::MAX - 60_000, late), PushError::TooOld),
    ] {
        assert_eq!(locator.push(&observation, &mut rng), Err(error));
    }
    let next = &bearings[100].observation;
    let [mut a, mut b] = [rng.clone(), rng];
    let mut other = unchanged;
    assert_eq!(locator.push(next, &mut a), other.push(next, &mut b));
    assert_eq!(locator.state().motion(), other.state().motion());
}

#[test]
fn anything_that_is_an_observation_is_taken() {
    let far = Observation::MAX_COORDINATE_M;
    let (sharp, blunt) = (Observation::MIN_SIGMA_RAD, Observation::MAX_SIGMA_RAD);
    let mut config = Config::DEFAULT;
    config.stationary.errors.bias_sigma_rad = 0.5;
    let mut rng = generator(4);
    for round in 0..60 {
        let mut locator = Locator::<Subject<64, 8>>::new(config).unwrap();
        let times = [0, 1, 1000, 60_000, 3_600_000, 1_000_000_000];
        let size = [1.0, 100.0, 1e4, far][round % 4];
        let mut time_ms = 0u32;
        for i in 0..150 {
            let mut coordinate = || size * (2.0 * uniform(&mut rng) - 1.0);
            let position = [coordinate(), coordinate()];
            let sigma_rad = match round % 3 {
                0 => sharp,
                1 => 0.05,
                _ => blunt,
            };
            let target = if i % 3 == 0 {
                [coordinate(), 0.0]
            } else {
                [0.0; 2]
            };
            time_ms = time_ms.wrapping_add(times[if round < 30 { round % 6 } else { i % 6 }]);
            let observation = towards(time_ms, position, target, 0.0, sigma_rad);
            // Those of the same time are of other stations.
            let answer = locator.push(&observation.from_station(i as u8), &mut rng);
            if let Some(fix) = answer.unwrap().fix() {
                let rows = fix.covariance.rows();
                let all = fix.position.iter().chain(rows.as_flattened());
                assert!(all.clone().all(|v| v.is_finite()), "{fix:?}");
            }
            if let Some(motion) = locator.state().motion() {
                assert!((0.0..=1.0).contains(&motion.moving), "{motion:?}");
                assert!(
                    motion.velocity_m_s.iter().all(|v| v.is_finite()),
                    "{motion:?}"
                );
                assert!(motion.sigma_m_s.is_finite(), "{motion:?}");
            }
        }
    }
}

#[test]
fn memory_is_as_stated() {
    let bytes = size_of::<Subject<256, 64>>();
    let own = bytes - size_of::<Robust<256, 64>>();
    println!("{own} bytes, {bytes} bytes with the stationary locator");
    assert!(own <= 10_000 && bytes <= 19_700);
    assert!(is_zero::<Subject<256, 64>>(|place| {
        place.write(Locate::EMPTY);
    }));
}
