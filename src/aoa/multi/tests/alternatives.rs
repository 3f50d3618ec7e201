//! Readings of several bearings that exclude each other.

use super::*;
use crate::aoa::Alternative;
use core::f32::consts::TAU;
use std::println;

const SOURCES: [[f32; 2]; 2] = [[600.0, 800.0], [900.0, -500.0]];

/// Two bearings of a place on a drive, of which the less probable one is right.
fn reading(second: usize, place: [f32; 2], right: f32, other: f32) -> [Alternative; 2] {
    [(other, 0.55), (right, 0.45)].map(|(radians, probability)| {
        Alternative::new(observe(second, place, radians), probability).unwrap()
    })
}

fn towards([x, y]: [f32; 2], from: [f32; 2]) -> f32 {
    atan2(y - from[1], x - from[0])
}

/// How often both sources of some drives are known, by all bearings and by the most probable ones; and how many others there
/// are.
fn known(other: impl Fn([f32; 2], f32) -> f32) -> ([u32; 2], u32) {
    let (mut known, mut false_ones) = ([0, 0], 0);
    for seed in 0..20 {
        let mut rng = generator(seed);
        let mut locators = [three(), three()];
        for second in 0..120 {
            let place = [12.0 * second as f32, 0.0];
            let whose = SOURCES[usize::from(uniform(&mut rng) < 0.4)];
            let right = towards(whose, place) + SIGMA * normal(&mut rng);
            let wrong = other(place, uniform(&mut rng)) + SIGMA * normal(&mut rng);
            let reading = reading(second, place, right, wrong);
            let [every, best] = &mut locators;
            every.push_alternatives(&reading, &mut rng).unwrap();
            best.push(reading[0].observation(), &mut rng).unwrap();
        }
        for (known, locator) in known.iter_mut().zip(&locators) {
            let sources = all(locator);
            let near = |place: &[f32; 2]| {
                let hold = |source: &Source| source.fix.ellipse(0.99).contains(*place);
                sources.iter().any(hold)
            };
            *known += SOURCES.iter().filter(|place| near(place)).count() as u32;
        }
        let far = |source: &Source| SOURCES.iter().all(|place| off(&source.fix, *place) > 100.0);
        false_ones += all(&locators[0]).iter().filter(|one| far(one)).count() as u32;
    }
    (known, false_ones)
}

/// The most probable bearing of every reading is that of no source. In 100 runs of other seeds, 173 of 200 sources were known,
/// and there were two false ones: the limits are passed in all but one of a thousand such tests.
#[test]
fn less_probable_bearings_tell_of_sources() {
    let (known, false_ones) = known(|_, anywhere| TAU * anywhere);
    println!("{known:?} of 40, {false_ones} false");
    assert!(known[0] >= 27 && known[1] < 8 && false_ones <= 3);
}

/// It is that of a reflector, behind the array. In 100 runs of other seeds, 198 of 200 sources were known, and no false one.
#[test]
fn bearings_of_a_reading_make_no_further_source() {
    let reflected = |place: [f32; 2], _: f32| core::f32::consts::PI + 0.002 * place[0];
    let (known, false_ones) = known(reflected);
    println!("{known:?} of 40, {false_ones} false");
    assert!(known[0] >= 36 && false_ones <= 1);
}
