//! Measured walks: what the locator is told comes from the simulation and the first of them.

use std::path::Path;

use anyhow::Result;
use foxhunt::aoa::{manoeuvring::Config, robust::Correlation};
use foxhunt_host::{
    figures::Figure,
    xplr::{self, Walk},
};
use foxhunt_simulation::{Sight, random::generator};
use nalgebra::Vector2;

use super::{COMPONENTS, EVERY_S, FIRST_S, Follower, baseline::Smoothed};
use crate::papers::{outcome::Outcome, statistics::median, table::table};

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Of an error that changes with the place, seen at right angles to an array. A flat array sees its aperture shortened by
/// the cosine of the direction from the boresight, so that errors grow by its inverse, up to a limit.
const SIGMA: f64 = 5.0 * DEGREE;
const LEAST_COSINE: f64 = 0.3;
/// Of what each array is off by on the whole.
const BIAS_SIGMA: f64 = 2.0 * DEGREE;
/// Of where the tag is carried beside the middle of a person, in metres.
const PLACE_M: f64 = 0.2;
/// For how long an error lasts while somebody walks: two metres.
const TIME_S: f64 = 3.0;
/// How much of an error the next reading repeats, of thirty a second and array: they are to tell no more than five do.
const REPEATED: f32 = 0.999;
/// Seconds that are drawn together by the bootstrap: errors repeat for as long.
const BLOCK: usize = 5;
/// Runs of each walk, for the locator draws random numbers.
const SEEDS: u64 = 10;

const fn told() -> Config {
    let mut config = Config::ROOM;
    config.stationary.errors.stop_sigma_rad = BIAS_SIGMA as f32;
    config.stationary.errors.position_sigma_m = PLACE_M as f32;
    config.stationary.errors.correlation = Correlation {
        at_rest: REPEATED,
        time_s: TIME_S as f32,
        ..config.stationary.errors.correlation
    };
    config
}

/// What came of a second, in the mean over the runs.
#[derive(Clone, Copy, Default)]
struct Second {
    error: f64,
    covered: f64,
}

pub fn run(data: &Path, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut table = table(
        [
            "walk",
            "median error m",
            "least squares and Kalman m",
            "95 % ellipse holds",
            "interval",
        ],
        1,
    );
    for name in ["walk_a", "walk_b"] {
        let sigma = |azimuth: f64| SIGMA / azimuth.cos().max(LEAST_COSINE);
        let walk = xplr::walk(data, name, sigma)?;
        let ours = ours(&walk, seed)?;
        let lines = median(least_squares(&walk).into_iter());
        let error = median(ours.iter().map(|second| second.error));
        let covered = covered(ours.iter());
        let [low, high] = interval(&ours, seed);
        table.add_row([
            name.to_owned(),
            format!("{error:.2}"),
            format!("{lines:.2}"),
            format!("{:.0} %", 100.0 * covered),
            format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high),
        ]);
        let figure = |what: &str, value, unit| {
            Figure::new(format!("walkers.xplr.{name}.{what}"), value, unit)
        };
        figures.extend([
            figure("median", error, "m"),
            figure("median_over_least_squares", error / lines, "").at_most(1.0),
            figure("covered", covered, "of seconds"),
            figure("covered_at_least", low, "of seconds").at_most(0.95),
            figure("missed_at_least", 1.0 - high, "of seconds").at_most(0.05),
        ]);
    }
    println!(
        "Measured walks, told what holds in the simulation and on walk_a; {SEEDS} runs of each, scored every second; 95 % \
         interval by a bootstrap over blocks of {BLOCK} s, or of Clopper and Pearson where all are held\n\n{table}\n"
    );
    Ok(figures)
}

/// Every second at which it is known where the tag is.
fn scored(walk: &Walk) -> impl Iterator<Item = (usize, [f64; 2])> {
    let last = walk.sights.last().map_or(0, |(_, sight)| sight.time_ms);
    let seconds = (FIRST_S as usize)..=(last / 1000) as usize;
    seconds.filter_map(|second| Some((second, walk.tag(second as f64 * EVERY_S)?)))
}

fn ours(walk: &Walk, seed: u64) -> Result<Vec<Second>> {
    let mut all = vec![Second::default(); scored(walk).count()];
    for run in 0..SEEDS {
        let mut follower = Follower::<COMPONENTS>::new(told(), seed ^ run)?;
        let mut sights = walk.sights.iter().peekable();
        for (sum, (second, tag)) in all.iter_mut().zip(scored(walk)) {
            while let Some(reading) = sights.next_if(|(_, s)| s.time_ms <= 1000 * second as u32) {
                follower.push(reading)?;
            }
            let outcome = Outcome::of(follower.answer(), tag);
            sum.error += outcome.error / SEEDS as f64;
            sum.covered += f64::from(u8::from(outcome.covered)) / SEEDS as f64;
        }
    }
    Ok(all)
}

/// The errors of the baseline, in metres.
fn least_squares(walk: &Walk) -> Vec<f64> {
    let mut smoothed = Smoothed::new();
    let mut errors = Vec::new();
    let last = scored(walk).map(|(second, _)| second).last().unwrap_or(0);
    for second in 1..=last {
        let within = |sight: &Sight| sight.time_ms.div_ceil(1000) as usize == second;
        let sights = walk.sights.iter().map(|(_, sight)| *sight);
        let place = smoothed.push(&sights.filter(within).collect::<Vec<_>>());
        if let Some(tag) = walk.tag(second as f64).filter(|_| second as f64 >= FIRST_S) {
            errors.push((place - Vector2::from(tag)).norm());
        }
    }
    errors
}

fn covered<'a>(seconds: impl Iterator<Item = &'a Second>) -> f64 {
    let (sum, count) = seconds.fold((0.0, 0.0), |(sum, count), second| {
        (sum + second.covered, count + 1.0)
    });
    sum / count
}

/// The 95 % interval of the coverage over samples of blocks, which may begin at any second.
///
/// Where every second is held there is nothing to sample: then Clopper's and Pearson's for as many blocks side by side.
fn interval(seconds: &[Second], seed: u64) -> [f64; 2] {
    use rand::RngExt;

    const SAMPLES: usize = 2000;
    if covered(seconds.iter()) > 1.0 - 1e-9 {
        let blocks = seconds.len() as f64 / BLOCK as f64;
        return [0.025f64.powf(1.0 / blocks), 1.0];
    }
    let mut rng = generator(seed, u64::MAX);
    let mut samples: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let blocks = (0..seconds.len().div_ceil(BLOCK))
                .map(|_| rng.random_range(0..=seconds.len() - BLOCK))
                .collect::<Vec<_>>();
            covered(blocks.iter().flat_map(|from| &seconds[*from..from + BLOCK]))
        })
        .collect();
    samples.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|q| samples[((SAMPLES - 1) as f64 * q) as usize])
}
