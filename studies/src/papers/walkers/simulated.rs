//! Simulated walks, beside a particle filter that knows how they came about.

use anyhow::Result;
use foxhunt::aoa::{manoeuvring::Config, robust};
use foxhunt_host::{
    figures::Figure,
    reference::{Walkers, mahalanobis},
    stations::Stations,
    walker::Walker,
};
use foxhunt_simulation::random::generator;
use indicatif::ParallelProgressIterator;
use nalgebra::Vector2;
use rayon::prelude::*;

use super::{COMPONENTS, EVERY_S, FIRST_S, Follower, MANY};
use crate::papers::{
    outcome::Outcome,
    statistics::{Estimate, NINETY_FIVE, bootstrap, root_mean_square},
    study::progress,
    table::table,
};

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const INTERVAL_S: f64 = 1.0;
const SECONDS: usize = 40;
/// Walks of the reference. Its own ellipses hold 92 %, so it may not quite have converged, and the ratio may be a little too
/// good for the locator.
const PARTICLES: usize = 100_000;
/// Of all walks, one in so many is given to the reference: it takes two seconds for each.
const REFERENCE_EVERY: u64 = 5;

const WALKER: Walker = Walker {
    speed_m_s: 1.0,
    standing_s: 5.0,
    walking_s: 20.0,
    straight_s: 5.0,
};
const STATIONS: Stations = Stations {
    readings: SECONDS,
    bias_sigma: 10.0 * DEGREE,
    sigma: 3.0 * DEGREE,
    // Independent.
    time_s: 1e-3,
};

/// What the locator is told: how somebody walks, and what the arrays' errors are.
const fn told() -> Config {
    let mut config = Config::ROOM;
    config.speed_m_s = WALKER.speed_m_s as f32;
    config.slowest_m_s = WALKER.speed_m_s as f32;
    config.stationary_s = WALKER.standing_s as f32;
    config.moving_s = WALKER.walking_s as f32;
    config.straight_s = WALKER.straight_s as f32;
    config.stationary.errors.rates = foxhunt::aoa::Mixture::new(0.0, 0.001);
    config.stationary.errors.stop_sigma_rad = STATIONS.bias_sigma as f32;
    config.stationary.errors.correlation = robust::Correlation::NONE;
    config
}

/// The same, of whom is not known whether he walks or drives.
const fn told_nothing_of_him() -> Config {
    let told = told();
    Config {
        stationary: told.stationary,
        ..Config::DEFAULT
    }
}

/// The scores of a walk.
struct Scores {
    ours: Vec<Outcome>,
    reference: Vec<Outcome>,
}

pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut table = table(
        [
            "told",
            "RMSE m",
            "RMSE / reference",
            "95 % ellipse holds",
            "the reference's",
            "no fix",
        ],
        1,
    );
    let told = walks::<COMPONENTS>(runs, seed, told(), true)?;
    let nothing = walks::<COMPONENTS>(runs, seed, told_nothing_of_him(), false)?;
    for (name, words, all) in [
        ("many", "how he walks; 1,024 components", many(&told, seed)?),
        ("told", "how he walks", told),
        ("default", "the default: a car, or on foot", nothing),
    ] {
        let ours = || all.iter().flat_map(|walk| &walk.ours);
        let fixed = || ours().filter(|outcome| outcome.error.is_finite());
        let fixes = fixed().count() as f64;
        let rmse = root_mean_square(fixed().map(|outcome| outcome.error));
        let covered = fixed().filter(|outcome| outcome.covered).count() as f64 / fixes;
        let none = 1.0 - fixes / ours().count() as f64;
        let ratio = ratio(&all);
        table.add_row([
            words.to_owned(),
            format!("{rmse:.3}"),
            ratio.map_or_else(String::new, |(ratio, _)| ratio.to_string()),
            format!("{:.1} %", 100.0 * covered),
            ratio.map_or_else(String::new, |(_, held)| format!("{:.1} %", 100.0 * held)),
            format!("{:.2} %", 100.0 * none),
        ]);
        let figure = |what: &str, value, unit| {
            Figure::new(format!("walkers.simulated.{name}.{what}"), value, unit)
        };
        figures.push(figure("rmse", rmse, "m"));
        figures.extend(
            ratio.map(|(ratio, _)| figure("rmse_over_reference", ratio.value, "").at_most(1.1)),
        );
        let (inside, outside, missed) = (
            figure("covered", covered, "of fixes"),
            figure("missed", 1.0 - covered, "of fixes"),
            figure("no_fix", none, "of scores"),
        );
        figures.extend(if name != "default" {
            [
                inside.at_most(0.98),
                outside.at_most(0.08),
                missed.at_most(0.01),
            ]
        } else {
            [inside, outside, missed]
        });
    }
    println!(
        "Somebody walks among four arrays with a bias of 10 degrees each and 3 degrees a reading, one a second of each; \
         {runs} walks of {SECONDS} s, scored every second from {FIRST_S} s on; the reference is a filter of {PARTICLES} \
         particles that knows all but the room, on one walk in {REFERENCE_EVERY}\n\n{table}\n"
    );
    Ok(figures)
}

/// RMSE over the reference's, and the fraction that the reference's ellipse holds, of the walks that it has, if any.
fn ratio(all: &[Scores]) -> Option<(Estimate, f64)> {
    let both: Vec<&Scores> = (all.iter())
        .filter(|walk| !walk.reference.is_empty())
        .collect();
    let ratio = bootstrap(both.len().max(1), |walks| {
        let pairs = walks
            .filter_map(|walk| both.get(walk))
            .flat_map(|walk| walk.ours.iter().zip(&walk.reference));
        let fixed = pairs.filter(|(ours, _)| ours.error.is_finite());
        let (ours, reference): (Vec<f64>, Vec<f64>) = fixed
            .map(|(ours, reference)| (ours.error, reference.error))
            .unzip();
        root_mean_square(ours.into_iter()) / root_mean_square(reference.into_iter())
    });
    let held = both.iter().flat_map(|walk| &walk.reference);
    let (held, count) = held.fold((0.0, 0.0), |(held, count), outcome| {
        (held + f64::from(u8::from(outcome.covered)), count + 1.0)
    });
    (count > 0.0).then_some((ratio, held / count))
}

/// The same walks, followed by many components, beside the same reference.
fn many(told: &[Scores], seed: u64) -> Result<Vec<Scores>> {
    let mut all = walks::<MANY>(told.len() as u32, seed, self::told(), false)?;
    for (scores, known) in all.iter_mut().zip(told) {
        scores.reference.clone_from(&known.reference);
    }
    Ok(all)
}

fn walks<const N: usize>(
    runs: u32,
    seed: u64,
    config: Config,
    with_reference: bool,
) -> Result<Vec<Scores>> {
    (0..u64::from(runs))
        .into_par_iter()
        .progress_with(progress(runs.into(), "walkers")?)
        .map(|run| {
            walk::<N>(
                seed,
                run,
                config,
                with_reference && run % REFERENCE_EVERY == 0,
            )
        })
        .collect()
}

fn walk<const N: usize>(
    seed: u64,
    run: u64,
    config: Config,
    with_reference: bool,
) -> Result<Scores> {
    let mut rng = generator(seed, run);
    let walk = WALKER.walk(&STATIONS, INTERVAL_S, &mut rng);
    let mut reference =
        with_reference.then(|| Walkers::new(WALKER, STATIONS, INTERVAL_S, PARTICLES, &mut rng));
    let mut follower = Follower::<N>::new(config, seed ^ run)?;
    let mut scores = Scores {
        ours: Vec::new(),
        reference: Vec::new(),
    };
    let rounds = walk.sights.chunks(Stations::PLACES.len());
    for (i, (round, tag)) in rounds.zip(&walk.tag).enumerate() {
        for reading in round {
            follower.push(reading)?;
        }
        let exact = reference
            .as_mut()
            .map(|filter| filter.push(round, &mut rng));
        let seconds = i as f64 * INTERVAL_S;
        if seconds < FIRST_S || seconds % EVERY_S > 0.5 * INTERVAL_S {
            continue;
        }
        scores.ours.push(Outcome::of(follower.answer(), *tag));
        if let Some((mean, covariance)) = exact {
            let off = mean - Vector2::from(*tag);
            scores.reference.push(Outcome {
                error: off.norm(),
                covered: mahalanobis(off.into(), &covariance) <= NINETY_FIVE,
            });
        }
    }
    Ok(scores)
}
