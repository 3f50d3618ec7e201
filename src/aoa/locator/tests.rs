extern crate std;
use super::*;
use crate::aoa::Bearing;
use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

const SOURCE: [f32; 2] = [1200.0, 800.0];
const SIGMA: f32 = 0.0195;

fn observe(position: [f32; 2], error: f32) -> Observation {
    let angle = (SOURCE[1] - position[1]).atan2(SOURCE[0] - position[0]);
    Observation::new(position, Bearing::from_radians(angle + error), SIGMA).unwrap()
}

/// The line from (0, 0) to (1500, 0).
fn drive<const N: usize, const B: usize>(
    locator: &mut Locator<N, B>,
    points: usize,
    rng: &mut Xoshiro128PlusPlus,
) -> Answer {
    // The errors are the same for every locator, whatever it draws for itself.
    let mut noise = rng.clone();
    for i in 0..points {
        let east = 1500.0 * i as f32 / (points - 1) as f32;
        let error = SIGMA * normal(&mut noise);
        locator.push(observe([east, 0.0], error), rng);
    }
    locator.answer()
}

#[test]
fn the_answer_is_a_reason_until_the_bearings_cross() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(51);
    let mut locator = Locator::<100>::new(Settings::new());
    let none = NotObservable::TooFewBearings { have: 0 };
    assert_eq!(locator.answer(), Answer::NotObservable(none));
    let one = NotObservable::TooFewBearings { have: 1 };
    assert_eq!(
        locator.push(observe([0.0, 0.0], 0.0), &mut rng),
        Answer::NotObservable(one)
    );
    let parked = locator.push(observe([0.0, 0.0], 0.0), &mut rng);
    assert!(
        matches!(
            parked,
            Answer::NotObservable(NotObservable::CrossingAngle { .. })
        ),
        "{parked:?}"
    );
    let crept = locator.push(observe([30.0, 0.0], 0.0), &mut rng);
    let Answer::NotObservable(NotObservable::CrossingAngle { radians, needed }) = crept else {
        panic!("{crept:?}");
    };
    assert!(radians < needed);
    locator.push(observe([600.0, 0.0], 0.0), &mut rng);
    let crossed = locator.push(observe([1200.0, 0.0], 0.0), &mut rng);
    assert!(matches!(crossed, Answer::Fix(_)), "{crossed:?}");
    locator.reset();
    assert_eq!(locator.answer(), Answer::NotObservable(none));
}

#[test]
fn rays_that_part_do_not_meet() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(52);
    let mut locator = Locator::<100>::new(Settings::new());
    for (east, degrees) in [(0.0, -30.0), (100.0, 30.0)] {
        let bearing = Bearing::from_compass_degrees(degrees);
        locator.push(
            Observation::new([east, 0.0], bearing, SIGMA).unwrap(),
            &mut rng,
        );
    }
    assert_eq!(
        locator.answer(),
        Answer::NotObservable(NotObservable::NoIntersection)
    );
}

#[test]
fn a_small_buffer_forgets_nothing() {
    // 60 bearings through a buffer of 16, and through one that holds them all: the same posterior.
    for seed in 0..20 {
        let mut whole = Locator::<400>::new(Settings::new());
        let mut small = Locator::<400, 16>::new(Settings::new());
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let Answer::Fix(whole) = drive(&mut whole, 60, &mut rng) else {
            panic!()
        };
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let Answer::Fix(small) = drive(&mut small, 60, &mut rng) else {
            panic!()
        };
        assert_eq!((whole.bearings, small.bearings), (60, 60));
        for axis in 0..2 {
            let sigma = whole.covariance[axis][axis].sqrt();
            // The two clouds have their own noise of about a twelfth of a deviation.
            let off = (whole.position[axis] - small.position[axis]).abs() / sigma;
            assert!(off < 0.4, "seed {seed}: {off}");
            let ratio = small.covariance[axis][axis].sqrt() / sigma;
            assert!((0.7..1.4).contains(&ratio), "seed {seed}: {ratio}");
        }
    }
}

#[test]
fn a_thousand_readings_of_a_parked_vehicle_fit_into_the_buffer() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(53);
    let mut locator = Locator::<100, 8>::new(Settings::new());
    for _ in 0..1000 {
        let error = SIGMA * normal(&mut rng);
        locator.push(observe([0.0, 0.0], error), &mut rng);
    }
    assert!(matches!(locator.answer(), Answer::NotObservable(_)));
    let Answer::Fix(fix) = drive(&mut locator, 60, &mut rng) else {
        panic!()
    };
    assert_eq!(fix.bearings, 1060);
    assert!(fix.ellipse(0.999).contains(SOURCE), "{fix:?}");
}

#[test]
fn settings_are_checked() {
    assert_eq!(
        Settings::new().relative_range_error(0.0),
        Err(SettingsError::RelativeRangeError)
    );
    assert_eq!(
        Settings::new().relative_range_error(f32::NAN),
        Err(SettingsError::RelativeRangeError)
    );
    assert_eq!(
        Settings::new().resample_share(1.5),
        Err(SettingsError::ResampleShare)
    );
    assert_eq!(Settings::new().moves(0), Err(SettingsError::Moves));
    assert!(Settings::new().moves(3).is_ok());
}
