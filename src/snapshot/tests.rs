extern crate std;

use core::fmt::Debug;
use std::{format, string::String, vec, vec::Vec};

use super::*;
use crate::aoa::clean;
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::robust::{self, Correlation, Errors};
use crate::aoa::testing::at;
use crate::aoa::{
    Answer, Bearing, Clean, Locate, Manoeuvring, MultiTarget, Observation, Robust, manoeuvring,
    multi,
};
use crate::checksum::crc32;
use crate::filter::ParticleFilter;
use crate::math::{atan2, sin_cos};
use crate::model::RandomWalk;
use crate::random::{Rng, SeedableRng, Xoshiro128PlusPlus, normal};
use crate::refine::{DifferentialEvolution, Firefly, FishSchool, Refinement};

const SOURCE: [f32; 2] = [1200.0, 800.0];

fn generator() -> Xoshiro128PlusPlus {
    Xoshiro128PlusPlus::seed_from_u64(7)
}

/// A drive past the source; every fifth bearing is mirrored or an outlier if `spoilt`.
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
        Observation::new(
            1000 * i as u32,
            [east, 0.0],
            Bearing::from_radians(radians),
            0.035,
        )
        .unwrap()
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
fn goes_on<L: Locate + Persist + Clone>(
    config: &L::Config,
    spoilt: bool,
    same: impl Fn(&L, &L),
) -> Vec<u8> {
    type State<L> = (L, Xoshiro128PlusPlus);
    let push = |state: &mut State<L>, observation: &Observation| {
        state.0.push(observation, config, &mut state.1).unwrap();
    };
    let mut going = (L::EMPTY, generator());
    let drive = drive(spoilt);
    for (i, observation) in drive.iter().enumerate() {
        push(&mut going, observation);
        let snapshot = saved(&going);
        let mut restored = (L::EMPTY, Xoshiro128PlusPlus::seed_from_u64(99));
        // Something else before, none of which may stay.
        for (other, time_ms) in drive.iter().rev().step_by(7).zip(0..) {
            push(&mut restored, &at(time_ms, other));
        }
        for _ in 0..2 {
            restore(&mut restored, &snapshot).unwrap();
            assert_eq!(saved(&restored), snapshot);
        }
        same(&restored.0, &going.0);
        for observation in drive.iter().skip(i + 1) {
            push(&mut restored, observation);
        }
        let mut whole = (L::EMPTY, generator());
        for observation in &drive {
            push(&mut whole, observation);
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
    type State = Clean<60, 12>;
    let config = clean::Config::DEFAULT;
    let snapshot = goes_on::<State>(&config, false, |a, b| assert_eq!(text(a), text(b)));
    assert_eq!(snapshot.len(), largest::<(State, Xoshiro128PlusPlus)>());
}

#[test]
fn so_does_one_with_any_moves() {
    fn refined<M: Refinement<2> + Copy + PartialEq + Debug>(refinement: M) {
        // What the moves work in holds nothing of use.
        let state = |locator: &Clean<60, 12, M>| {
            let columns = locator.columns().map(<[f32]>::to_vec);
            text(&(columns, locator.weights(), locator.answer()))
        };
        let config = clean::Config::with_refinement(refinement);
        goes_on(&config, false, |a, b| assert_eq!(state(a), state(b)));
    }
    refined(FishSchool::METROPOLIS);
    refined(Firefly::METROPOLIS);
    refined(DifferentialEvolution::METROPOLIS);
}

#[test]
fn so_does_a_robust_one() {
    type State = Robust<64, 12>;
    let errors = Errors {
        bias_sigma_rad: 0.05,
        position_sigma_m: 20.0,
        correlation: Correlation {
            distance_m: 60.0,
            time_s: 100.0,
            ..Correlation::DEFAULT
        },
        ..Errors::DEFAULT
    };
    let config = robust::Config {
        errors,
        ..robust::Config::DEFAULT
    };
    let snapshot = goes_on::<State>(&config, true, |a, b| assert_eq!(text(a), text(b)));
    assert!(snapshot.len() <= largest::<(State, Xoshiro128PlusPlus)>());
}

/// The drives of a source that is stationary at first: after every bearing a snapshot, which goes on as what was saved.
fn goes_on_moving<const K: usize>(
    config: &manoeuvring::Config,
    drive: &[Observation],
    mut see: impl FnMut(&Manoeuvring<Robust<64, 12>, K>),
) {
    type State<const K: usize> = (Manoeuvring<Robust<64, 12>, K>, Xoshiro128PlusPlus);
    let push = |(locator, rng): &mut State<K>, observation: &Observation| {
        locator.push(observation, config, rng).unwrap();
    };
    let mut going: State<K> = (Locate::EMPTY, generator());
    for (i, observation) in drive.iter().enumerate() {
        push(&mut going, observation);
        see(&going.0);
        let mut restored: State<K> = (Locate::EMPTY, Xoshiro128PlusPlus::seed_from_u64(99));
        for (other, time_ms) in drive.iter().rev().step_by(7).zip(0..) {
            push(&mut restored, &at(1000 * time_ms, other));
        }
        let snapshot = saved(&going);
        restore(&mut restored, &snapshot).unwrap();
        assert_eq!(saved(&restored), snapshot);
        assert_eq!(text(&restored), text(&going));
        // A few on, which is where what was forgotten would show.
        let mut on = going.clone();
        for observation in drive.iter().skip(i + 1).take(5) {
            push(&mut on, observation);
            push(&mut restored, observation);
        }
        assert_eq!(text(&restored), text(&on));
    }
}

/// Of a source that is stationary and then drives off.
#[test]
fn so_does_one_of_a_manoeuvring_source() {
    let mut config = manoeuvring::Config::DEFAULT;
    config.stationary.errors.bias_sigma_rad = 0.05;
    let mut rng = generator();
    let round = |i: u32| {
        let (sin, cos) = sin_cos(0.08 * i as f32);
        let [x, y] = [300.0 * cos, 300.0 * sin];
        let north = 10.0 * i.saturating_sub(40) as f32;
        let radians = atan2(north - y, -x) + 0.02 * normal(&mut rng);
        Observation::new(1000 * i, [x, y], Bearing::from_radians(radians), 0.02).unwrap()
    };
    let drive: Vec<Observation> = (0..80).map(round).collect();
    let mut phases = std::collections::BTreeSet::new();
    goes_on_moving::<0>(&config, &drive, |locator| {
        let moving = locator.motion().map_or(0.0, |motion| motion.moving);
        phases.insert((10.0 * moving) as u32);
    });
    assert!(phases.contains(&0) && phases.contains(&9), "{phases:?}");
}

/// Of somebody among four stations, each of which has a bias.
#[test]
fn so_does_one_among_stations() {
    const STATIONS: [[f32; 2]; 4] = [[0.0, 0.0], [12.0, 0.0], [12.0, 9.0], [0.0, 9.0]];
    let mut rng = generator();
    let heard = |i: u32| {
        let station = i as usize % 4;
        let ([x, y], [east, north]) = (STATIONS[station], [4.0 + 0.05 * i as f32, 4.0]);
        let off = 0.05 * station as f32 + 0.03 * normal(&mut rng);
        let bearing = Bearing::from_radians(atan2(north - y, east - x) + off);
        let seen = Observation::new(1000 + 250 * i, [x, y], bearing, 0.03).unwrap();
        seen.from_station(station as u8)
    };
    let walk: Vec<Observation> = (0..60).map(heard).collect();
    let mut biases = Vec::new();
    goes_on_moving::<4>(&manoeuvring::Config::ROOM, &walk, |locator| {
        biases.extend(locator.bias(&manoeuvring::Config::ROOM));
    });
    assert!(biases.len() > 40, "{biases:?}");
}

#[test]
fn so_does_one_of_several_sources() {
    let mut config = multi::Config::DEFAULT;
    config.track.errors.position_sigma_m = 5.0;
    goes_on::<MultiTarget<2, Robust<64, 12>, 12>>(&config, true, |a, b| {
        assert_eq!(text(a), text(b))
    });
}

#[test]
fn so_does_a_filter() {
    let walk = RandomWalk { sigma: [1.0; 2] };
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
    let (mut locator, mut rng) = (Clean::<8, 4>::EMPTY, generator());
    for observation in drive(false) {
        let config = clean::Config::DEFAULT;
        locator.push(&observation, &config, &mut rng).unwrap();
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
fn small() -> (Clean<5, 3>, Xoshiro128PlusPlus) {
    let mut state = (Clean::EMPTY, generator());
    drive_on(&mut state);
    state
}

fn drive_on(state: &mut (Clean<5, 3>, Xoshiro128PlusPlus)) {
    for observation in drive(false) {
        // A forged time may be later.
        let config = clean::Config::DEFAULT;
        let _ = state.0.push(&observation, &config, &mut state.1);
    }
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
    let mut state = (Clean::<5, 3>::EMPTY, generator());
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
fn renamed_and_swapped_fields_are_refused() {
    /// Refuses snapshots of types with other fields.
    macro_rules! others {
        ($($first:ident, $second:ident);+) => {$({
            #[derive(Debug, Default)]
            struct State { $first: u32, $second: u32 }
            crate::persist!(State { $first, $second });
            assert_eq!(assert_refused(&mut State::default(), &snapshots().0), Error::Shape);

            #[derive(Debug, Default)]
            struct Plain { $first: u32, $second: u32 }
            value!(Plain { $first, $second });
            assert_eq!(assert_refused(&mut Plain::default(), &snapshots().1), Error::Shape);
        })+};
    }
    fn snapshots() -> (Vec<u8>, Vec<u8>) {
        struct State {
            a: u32,
            b: u32,
        }
        crate::persist!(State { a, b });
        struct Plain {
            a: u32,
            b: u32,
        }
        value!(Plain { a, b });
        (saved(&State { a: 1, b: 2 }), saved(&Plain { a: 1, b: 2 }))
    }
    others!(b, a; a, c);
}

#[test]
fn other_shapes_are_refused() {
    let snapshot = saved(&small().0);
    let shape = Error::Shape;
    assert_eq!(
        assert_refused(&mut { Clean::<6, 3>::EMPTY }, &snapshot),
        shape
    );
    assert_eq!(
        assert_refused(&mut { Clean::<5, 4>::EMPTY }, &snapshot),
        shape
    );
    assert_eq!(
        assert_refused(&mut { Robust::<5, 3>::EMPTY }, &snapshot),
        shape
    );
    assert_eq!(assert_refused(&mut small(), &snapshot), shape);
}

/// Where the parts of a snapshot of [`small`] begin.
const LIST: usize = HEADER;
const ANSWER: usize = LIST + 4 + 3 * 48 + 25 + 4 + 4 * 5 * 4 + 8;

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
        put(first + 4, &nan),
        put(first + 4, &2e6f32.to_le_bytes()),
        put(first + 12, &nan),
        put(first + 12, &3.2f32.to_le_bytes()),
        put(first + 16, &nan),
        put(first + 16, &0f32.to_le_bytes()),
        put(first + 40, &nan),
        put(first + 44, &nan),
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
    assert_eq!(snapshot[ANSWER], 1);
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
            drive_on(&mut state);
        }
    }
    assert!(restored > 100);
}
