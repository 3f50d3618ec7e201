extern crate std;

mod chase;
mod oracle;

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, TAU};

use super::*;
use crate::aoa::{Bearing, robust};
use crate::random::{SeedableRng, Xoshiro128PlusPlus, uniform};
use crate::resample::{Scheme, resample};
use crate::weights;
use chase::Chase;
use std::{print, println, vec, vec::Vec};

fn generator(seed: u64) -> Xoshiro128PlusPlus {
    Xoshiro128PlusPlus::seed_from_u64(seed)
}

fn towards_with(position: [f32; 2], target: [f32; 2], error: f32, deviation: f32) -> Observation {
    let angle = (target[1] - position[1]).atan2(target[0] - position[0]);
    Observation::new(position, Bearing::from_radians(angle + error), deviation).unwrap()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn median(values: &mut [f32]) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f32::NAN)
}

/// What came of one time of many chases.
#[derive(Default)]
struct Window {
    errors: Vec<f32>,
    all: Vec<f32>,
    oracle: Vec<f32>,
    covered: u32,
    bearings: u32,
}

impl Window {
    fn print(&mut self, name: &str) {
        let fixes = self.errors.len() as f32;
        println!(
            "{name}: fixes {:.3}, coverage {:.3}, median {:.1} m, 90 % {:.1} m; with those that are no fix {:.1} m, oracle {:.1} m",
            fixes / self.bearings as f32,
            self.covered as f32 / fixes,
            median(&mut self.errors),
            self.errors[self.errors.len() * 9 / 10],
            median(&mut self.all),
            median(&mut self.oracle),
        );
    }
}

#[test]
#[ignore]
fn study() {
    let runs: u64 = std::env::var("RUNS").map_or(20, |runs| runs.parse().unwrap());
    let with_oracle = std::env::var("ORACLE").is_ok();
    let verbose = std::env::var("VERBOSE").is_ok();
    let windows = [
        ("parked", 60.0, 120.0),
        ("departing", 120.0, 135.0),
        ("driving", 135.0, 240.0),
        ("stopping", 240.0, 270.0),
        ("parked again", 270.0, 360.0),
        ("at the end", 359.0, 360.0),
    ];
    let mut results: Vec<Window> = windows.iter().map(|_| Window::default()).collect();
    let (mut alarms, mut delays, mut rests) = (0, Vec::new(), Vec::new());
    for seed in 0..runs {
        let mut rng = generator(seed);
        let chase = Chase::random(&mut rng);
        let bearings = chase.bearings(seed);
        let oracle = with_oracle.then(|| oracle::track(&chase, &bearings, seed));
        let mut pursuit = Pursuit::<256, 64>::new(Settings::default());
        let (mut delay, mut rest) = (f32::INFINITY, f32::INFINITY);
        let mut alarm = false;
        for (i, (time, source, observation)) in bearings.iter().enumerate() {
            let answer = pursuit.push_after(*observation, 1.0, &mut rng);
            let moving = pursuit.motion().map_or(0.0, |motion| motion.moving);
            if *time < chase.departure && moving > 0.5 {
                alarm = true;
            }
            if *time >= chase.departure && moving > 0.5 && delay.is_infinite() {
                delay = *time - chase.departure;
            }
            if *time >= chase.stop && moving < 0.5 && rest.is_infinite() {
                rest = *time - chase.stop;
            }
            let mut off = f32::NAN;
            for ((_, from, to), window) in windows.iter().zip(&mut results) {
                if (*from..*to).contains(time) {
                    window.bearings += 1;
                    if let Answer::Fix(fix) = answer {
                        off = distance(fix.position, *source);
                        window.errors.push(off);
                        window.covered += u32::from(fix.ellipse(0.95).contains(*source));
                    }
                    let at = match answer {
                        Answer::Fix(fix) => fix.position,
                        Answer::NotObservable(_) => {
                            let (mean, _) = pursuit.cloud.moments();
                            [mean[0], mean[1]]
                        }
                    };
                    window.all.push(distance(at, *source));
                    if let Some(oracle) = &oracle
                        && oracle[i].0[0].is_finite()
                    {
                        window.oracle.push(distance(oracle[i].0, *source));
                    }
                }
            }
            if verbose && i % 5 == 0 {
                let known = distance(observation.position(), *source);
                let inside =
                    matches!(answer, Answer::Fix(fix) if fix.ellipse(0.95).contains(*source));
                let rest = pursuit.cloud.at_rest();
                println!(
                    "{time} {:?} moving {moving:.3} parked {:.4} rest {:.3} {:.1} s fitted {:.2} {:?} off {off:.1} {inside} range {known:.0} n {:.0} spread {:.0} really off {:.0} oracle {:.1} spread {:.0}",
                    pursuit.phase,
                    pursuit.parked,
                    rest.share,
                    rest.seconds,
                    pursuit.fitted,
                    pursuit.lost,
                    pursuit.cloud.effective_sample_size(),
                    {
                        let (_, c) = pursuit.cloud.moments();
                        (c[0][0] + c[1][1]).sqrt()
                    },
                    {
                        let (m, _) = pursuit.cloud.moments();
                        distance([m[0], m[1]], *source)
                    },
                    oracle
                        .as_ref()
                        .map_or(f32::NAN, |oracle| distance(oracle[i].0, *source)),
                    oracle.as_ref().map_or(f32::NAN, |oracle| oracle[i].1),
                );
            }
        }
        alarms += u32::from(alarm);
        delays.push(delay);
        rests.push(rest);
        print!("");
    }
    for ((name, ..), window) in windows.iter().zip(&mut results) {
        window.print(name);
    }
    println!("false alarms {alarms} of {runs}");
    println!("delays {:.0} {:?}", median(&mut delays), delays);
    println!("rests {:.0} {:?}", median(&mut rests), rests);
}
