extern crate std;

use core::fmt::Debug;
use std::{format, string::String, vec, vec::Vec};

use super::*;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{self, Answer, Locator, Moves};
use crate::aoa::pursuit::{self, Pursuit};
use crate::aoa::robust::{self, RobustLocator, Tails};
use crate::aoa::sources::{self, Sources};
use crate::aoa::{Bearing, Locate, Observation};
use crate::checksum::crc32;
use crate::filter::ParticleFilter;
use crate::math::{atan2, sin_cos};
use crate::model::RandomWalk;
use crate::random::{Rng, SeedableRng, Xoshiro128PlusPlus, normal};
use crate::refine::{DifferentialEvolution, Firefly, FishSchool};

const SOURCE: [f32; 2] = [1200.0, 800.0];

fn generator() -> Xoshiro128PlusPlus {
    Xoshiro128PlusPlus::seed_from_u64(7)
}

/// A drive past the source; every fifth bearing is mirrored or wild if `spoilt`.
fn drive(spoilt: bool) -> Vec<Observation> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let bearing = |i: usize| {
        let east = 50.0 * i as f32;
        let turn = match i % 10 {
            3 if spoilt => core::f32::consts::PI,
            8 if spoilt => i as f32,
            _ => 0.0,
        };
        let radians = atan2(SOURCE[1], SOURCE[0] - east) + 0.035 * normal(&mut rng) + turn;
        Observation::new([east, 0.0], Bearing::from_radians(radians), 0.035).unwrap()
    };
    (0..40).map(bearing).collect()
}

fn saved<T: Persist>(state: &T) -> Vec<u8> {
    let mut buffer = vec![0; largest::<T>()];
    save(state, &mut buffer).unwrap().to_vec()
}

/// A snapshot whose content was changed, with a checksum that is right.
fn sealed(mut snapshot: Vec<u8>, change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    snapshot.truncate(snapshot.len() - CHECKSUM);
    change(&mut snapshot);
    let content = (snapshot.len() - HEADER) as u32;
    snapshot[12..16].copy_from_slice(&content.to_le_bytes());
    let checksum = crc32(&snapshot).to_le_bytes();
    snapshot.extend(checksum);
    snapshot
}

/// All of a state, to the last bit: Rust prints as many digits of a float as tell it from all others.
fn text(state: &impl Debug) -> String {
    format!("{state:?}")
}

/// At every bearing of a drive: saved, restored into a new one, saved again, and driven on.
fn goes_on<L: Locate + Persist>(
    new: impl Fn() -> L,
    spoilt: bool,
    same: impl Fn(&L, &L),
) -> Vec<u8> {
    let mut going = (new(), generator());
    let drive = drive(spoilt);
    for (i, observation) in drive.iter().enumerate() {
        going.0.push_after(*observation, 1.0, &mut going.1);
        let snapshot = saved(&going);
        let mut restored = (new(), Xoshiro128PlusPlus::seed_from_u64(99));
        // Something else before, none of which may stay.
        for other in drive.iter().rev().step_by(7) {
            restored.0.push_after(*other, 1.0, &mut restored.1);
        }
        for _ in 0..2 {
            restore(&mut restored, &snapshot).unwrap();
            assert_eq!(saved(&restored), snapshot);
        }
        same(&restored.0, &going.0);
        for observation in drive.iter().skip(i + 1) {
            restored.0.push_after(*observation, 1.0, &mut restored.1);
        }
        let mut whole = (new(), generator());
        for observation in &drive {
            whole.0.push_after(*observation, 1.0, &mut whole.1);
        }
        same(&restored.0, &whole.0);
        assert_eq!(restored.1, whole.1);
    }
    assert!(matches!(going.0.answer(), Answer::Fix(_)));
    saved(&going)
}

#[test]
fn a_locator_goes_on_as_if_nothing_had_happened() {
    // A buffer that the drive fills, and more than once.
    let new = || Locator::<60, 12>::new(locator::Settings::new());
    let snapshot = goes_on(new, false, |a, b| assert_eq!(text(a), text(b)));
    assert_eq!(
        snapshot.len(),
        largest::<(Locator<60, 12>, Xoshiro128PlusPlus)>()
    );
}

#[test]
fn so_does_one_with_any_moves() {
    fn refined<M: Moves<60>>(new: impl Fn() -> Locator<60, 12, M>) {
        // What the moves work in holds nothing of use.
        let state = |locator: &Locator<60, 12, M>| {
            let columns = locator.columns().map(<[f32]>::to_vec);
            text(&(columns, locator.weights(), locator.answer()))
        };
        goes_on(new, false, |a, b| assert_eq!(state(a), state(b)));
    }
    let settings = locator::Settings::new();
    refined(|| Locator::with_refinement(settings, FishSchool::METROPOLIS));
    refined(|| Locator::with_refinement(settings, Firefly::METROPOLIS));
    refined(|| Locator::with_refinement(settings, DifferentialEvolution::METROPOLIS));
}

#[test]
fn so_does_a_robust_one() {
    for tails in [Tails::Normal, Tails::Student { freedom: 4 }] {
        let errors = robust::Errors::new().tails(tails).unwrap();
        let errors = errors.bias_deviation(0.05).unwrap();
        let errors = errors.correlation(0.9, 60.0, 100.0).unwrap();
        let errors = errors.position_deviation(20.0).unwrap();
        let new = || RobustLocator::<64, 12>::new(robust::Settings::new(errors));
        let snapshot = goes_on(new, true, |a, b| assert_eq!(text(a), text(b)));
        assert!(snapshot.len() <= largest::<(RobustLocator<64, 12>, Xoshiro128PlusPlus)>());
    }
}

/// Of a source that is parked and then drives off.
#[test]
fn so_does_a_pursuit() {
    let errors = robust::Errors::new().bias_deviation(0.05).unwrap();
    let habits = pursuit::Settings::new(robust::Settings::new(errors));
    let new = || Pursuit::<64, 12>::new(habits);
    let mut rng = generator();
    let round = |i: usize| {
        let (sin, cos) = sin_cos(0.08 * i as f32);
        let [x, y] = [300.0 * cos, 300.0 * sin];
        let north = 10.0 * i.saturating_sub(40) as f32;
        let radians = atan2(north - y, -x) + 0.02 * normal(&mut rng);
        Observation::new([x, y], Bearing::from_radians(radians), 0.02).unwrap()
    };
    let drive: Vec<Observation> = (0..80).map(round).collect();
    let mut going = (new(), generator());
    let mut phases = std::collections::BTreeSet::new();
    for (i, observation) in drive.iter().enumerate() {
        going.0.push_after(*observation, 1.0, &mut going.1);
        let moving = going.0.motion().map_or(0.0, |motion| motion.moving);
        phases.insert((10.0 * moving) as u32);
        let mut restored = (new(), Xoshiro128PlusPlus::seed_from_u64(99));
        for other in drive.iter().rev().step_by(7) {
            restored.0.push_after(*other, 1.0, &mut restored.1);
        }
        let snapshot = saved(&going);
        restore(&mut restored, &snapshot).unwrap();
        assert_eq!(saved(&restored), snapshot);
        assert_eq!(text(&restored), text(&going));
        // A few on, which is where what was forgotten would show.
        let mut on = going.clone();
        for observation in drive.iter().skip(i + 1).take(5) {
            on.0.push_after(*observation, 1.0, &mut on.1);
            restored.0.push_after(*observation, 1.0, &mut restored.1);
        }
        assert_eq!(text(&restored), text(&on));
    }
    assert!(phases.contains(&0) && phases.contains(&9), "{phases:?}");
    for other in [habits.speed(2.0), habits.straight_s(10.0)] {
        let mut other = (Pursuit::<64, 12>::new(other.unwrap()), generator());
        assert_eq!(assert_refused(&mut other, &saved(&going)), Error::Settings);
    }
}

#[test]
fn so_do_several_sources() {
    let errors = robust::Errors::new().position_deviation(5.0).unwrap();
    let track = || RobustLocator::<64, 12>::new(robust::Settings::new(errors));
    let new = || Sources::<2, _, 12>::new(sources::Settings::new(), [track(), track()]);
    goes_on(new, true, |a, b| assert_eq!(text(a), text(b)));
}

#[test]
fn so_does_a_filter() {
    let walk = RandomWalk {
        deviation: [1.0; 2],
    };
    let step = |(filter, rng): &mut (ParticleFilter<2, 50>, Xoshiro128PlusPlus), x: f32| {
        filter.predict(&walk, 1.0, rng);
        let fits = |&[a, b]: &[f32; 2]| -0.5 * ((a - x).powi(2) + (b - x).powi(2));
        filter.update(&fits).unwrap();
        filter.resample_below(0.5, rng);
    };
    let mut going = (ParticleFilter::<2, 50>::new(), generator());
    for x in 0..20 {
        step(&mut going, x as f32);
        let mut restored = (
            ParticleFilter::<2, 50>::new(),
            Xoshiro128PlusPlus::seed_from_u64(9),
        );
        restore(&mut restored, &saved(&going)).unwrap();
        assert_eq!(text(&restored), text(&going));
    }
}

#[test]
fn parts_that_are_kept_apart() {
    let (mut locator, mut rng) = (Locator::<8, 4>::new(locator::Settings::new()), generator());
    for observation in drive(false) {
        locator.push(observation, &mut rng);
    }
    let place = |north| Geodetic::new(north, 115_166_667).unwrap();
    let mut plane = LocalPlane::new(place(481_173_000)).unwrap();
    let whole = (text(&locator), rng.clone(), plane);
    let snapshot = saved(&(&mut locator, &mut rng, &mut plane));
    locator.reset();
    rng.next_u32();
    plane = LocalPlane::new(place(0)).unwrap();
    restore(&mut (&mut locator, &mut rng, &mut plane), &snapshot).unwrap();
    assert_eq!((text(&locator), rng, plane), whole);
}

/// A small one with a fix.
fn small() -> (Locator<5, 3>, Xoshiro128PlusPlus) {
    let mut state = (Locator::new(locator::Settings::new()), generator());
    for observation in drive(false) {
        state.0.push(observation, &mut state.1);
    }
    state
}

fn assert_refused<T: Persist + Debug>(state: &mut T, bytes: &[u8]) -> Error {
    let before = text(state);
    let error = restore(state, bytes).unwrap_err();
    assert_eq!(text(state), before, "{error}");
    error
}

#[test]
fn a_small_buffer_is_told_its_size() {
    let state = small();
    let needed = saved(&state).len();
    for length in 0..needed {
        let error = save(&state, &mut vec![0; length]).unwrap_err();
        assert_eq!(error, Error::BufferTooSmall { needed });
    }
    assert_eq!(
        save(&state, &mut vec![1; needed + 9]).unwrap(),
        saved(&state)
    );
}

#[test]
fn every_flipped_bit_and_every_truncation_is_refused() {
    let snapshot = saved(&small());
    let mut state = (Locator::<5, 3>::new(locator::Settings::new()), generator());
    for bit in 0..8 * snapshot.len() {
        let mut spoilt = snapshot.clone();
        spoilt[bit / 8] ^= 1 << (bit % 8);
        let error = assert_refused(&mut state, &spoilt);
        match bit / 8 {
            0..4 => assert_eq!(error, Error::NotASnapshot),
            4..8 => assert!(matches!(error, Error::Version { .. })),
            12..16 => assert!(matches!(error, Error::Truncated | Error::Checksum)),
            _ => assert_eq!(error, Error::Checksum),
        }
    }
    for length in 0..snapshot.len() {
        let error = assert_refused(&mut state, &snapshot[..length]);
        assert_eq!(error, Error::Truncated);
    }
    // What stands behind it is nobody's concern.
    restore(&mut state, &[&snapshot[..], &[1, 2, 3]].concat()).unwrap();
    assert_eq!(saved(&state), snapshot);
}

#[test]
fn other_shapes_and_settings_are_refused() {
    let settings = locator::Settings::new();
    let snapshot = saved(&small().0);
    let shape = Error::Shape;
    let more = &mut Locator::<6, 3>::new(settings);
    assert_eq!(assert_refused(more, &snapshot), shape);
    let longer = &mut Locator::<5, 4>::new(settings);
    assert_eq!(assert_refused(longer, &snapshot), shape);
    let robust = &mut RobustLocator::<5, 3>::new(robust::Settings::default());
    assert_eq!(assert_refused(robust, &snapshot), shape);
    assert_eq!(assert_refused(&mut small(), &snapshot), shape);

    for other in [
        settings.moves(3),
        settings.resample_share(0.6),
        settings.relative_range_error(0.2),
    ] {
        let other = &mut Locator::<5, 3>::new(other.unwrap());
        assert_eq!(assert_refused(other, &snapshot), Error::Settings);
    }

    let defaults = robust::Errors::new();
    let snapshot = saved(&RobustLocator::<5, 3>::new(robust::Settings::new(defaults)));
    for other in [
        defaults.tails(Tails::Student { freedom: 3 }),
        defaults.shares(0.1, 0.1),
        defaults.prior_bearings(20.0),
        defaults.bias_deviation(0.1),
        defaults.position_deviation(1.0),
        defaults.correlation(0.9, 5.0, 1.0),
    ] {
        let other = robust::Settings::new(other.unwrap());
        let other = &mut RobustLocator::<5, 3>::new(other);
        assert_eq!(assert_refused(other, &snapshot), Error::Settings);
    }
    let other = robust::Settings::new(defaults).range_m(100.0).unwrap();
    let other = &mut RobustLocator::<5, 3>::new(other);
    assert_eq!(assert_refused(other, &snapshot), Error::Settings);
}

/// Where the parts of a snapshot of [`small`] begin.
const LIST: usize = HEADER + 9;
const ANSWER: usize = LIST + 4 + 3 * 16 + 17 + 4 + 4 * 5 * 4 + 8;

#[test]
fn values_that_no_state_has_are_refused() {
    let snapshot = saved(&small());
    let mut state = small();
    let put = |at: usize, bytes: &[u8]| {
        sealed(snapshot.clone(), |all| {
            all[at..at + bytes.len()].copy_from_slice(bytes);
        })
    };
    let nan = f32::NAN.to_le_bytes();
    let first = LIST + 4;
    for spoilt in [
        put(LIST, &4u32.to_le_bytes()),
        put(LIST, &u32::MAX.to_le_bytes()),
        // Another list than the rest stands for.
        put(LIST, &2u32.to_le_bytes()),
        put(first, &nan),
        put(first, &2e6f32.to_le_bytes()),
        put(first + 8, &nan),
        put(first + 8, &3.2f32.to_le_bytes()),
        put(first + 12, &nan),
        put(first + 12, &0f32.to_le_bytes()),
        put(ANSWER, &[4]),
        put(snapshot.len() - CHECKSUM - 16, &[0; 16]),
        sealed(snapshot.clone(), |all| all.push(0)),
        sealed(snapshot.clone(), |all| all.truncate(all.len() - 1)),
        sealed(snapshot.clone(), |all| all.truncate(HEADER)),
    ] {
        assert_eq!(assert_refused(&mut state, &spoilt), Error::Malformed);
    }
    // So that the places above are what they are taken for.
    assert_eq!(snapshot[LIST..LIST + 4], [3, 0, 0, 0]);
    assert_eq!(snapshot[ANSWER], 0);
}

#[test]
fn forged_values_do_no_harm() {
    let snapshot = saved(&small());
    let numbers = [
        f32::NAN,
        f32::INFINITY,
        -f32::INFINITY,
        0.0,
        -1.0,
        1e30,
        1e-40,
    ];
    let mut restored = 0;
    for at in HEADER..snapshot.len() - CHECKSUM - 4 {
        for number in numbers {
            let forged = sealed(snapshot.clone(), |all| {
                all[at..at + 4].copy_from_slice(&number.to_le_bytes());
            });
            let mut state = small();
            if restore(&mut state, &forged).is_err() {
                assert_eq!(saved(&state), snapshot);
                continue;
            }
            restored += 1;
            for observation in drive(false) {
                state.0.push(observation, &mut state.1);
            }
        }
    }
    assert!(restored > 100);
}
