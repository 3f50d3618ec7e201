//! A stationary vehicle: a thousand readings whose errors are correlated.

use anyhow::Result;
use foxhunt::aoa::robust::{Config, Correlation, Errors};
use foxhunt_host::{figures::Figure, stationary::Stationary, tracks::Track};
use foxhunt_simulation::random;
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use crate::papers::{
    outcome::{Outcome, locate},
    statistics::root_mean_square,
    study::progress,
    table::table,
};

const STOPS: [usize; 3] = [0, 20, 45];
const READINGS: usize = 1000;
const AT_REST: f64 = 0.9;
const DISTANCE_M: f64 = 20.0;

/// Runs all stops on both tracks, as if the errors were independent, too.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let header = [
        "track",
        "stationary at",
        "errors taken for",
        "RMSE m",
        "95 % ellipse holds",
    ];
    let mut table = table(header, 3);
    let mut figures = Vec::new();
    for track in [Track::a1(), Track::a2()] {
        for stop in STOPS {
            for (key, kind, at_rest, runs) in [
                ("coverage", "correlated", AT_REST, runs),
                ("coverage_untempered", "independent", 0.0, runs.div_ceil(4)),
            ] {
                let all = outcomes(&track, stop, at_rest, runs, seed)?;
                let covered = all.iter().filter(|outcome| outcome.covered).count();
                let coverage = covered as f64 / all.len() as f64;
                table.add_row([
                    track.name.to_owned(),
                    stop.to_string(),
                    kind.to_owned(),
                    format!("{:.2}", root_mean_square(all.iter().map(|o| o.error))),
                    format!("{:.1} %", 100.0 * coverage),
                ]);
                let name = track.name.to_lowercase();
                let name = format!("papers.bearings.{name}.stationary{stop}.{key}");
                let figure = Figure::new(name.as_str(), coverage, "of runs");
                if at_rest > 0.0 {
                    let missed = Figure::new(format!("{name}_missed"), 1.0 - coverage, "of runs");
                    figures.extend([figure.at_most(0.98), missed.at_most(0.10)]);
                } else {
                    figures.push(figure);
                }
            }
        }
    }
    println!(
        "A vehicle stationary for {READINGS} readings at a stop of the track, {runs} runs; errors with a correlation of \
         {AT_REST} at rest, and by a factor of e less every {DISTANCE_M} m"
    );
    println!("{table}\n");
    Ok(figures)
}

fn outcomes(
    track: &Track,
    stop: usize,
    at_rest: f64,
    runs: u32,
    seed: u64,
) -> Result<Vec<Outcome>> {
    let stationary = Stationary {
        stop,
        readings: READINGS,
        at_rest: AT_REST,
        distance: DISTANCE_M,
    };
    let config = Config {
        errors: Errors {
            correlation: Correlation {
                at_rest: at_rest as f32,
                distance_m: DISTANCE_M as f32,
                ..Correlation::NONE
            },
            bias_sigma_rad: 0.0,
            ..Errors::DEFAULT
        },
        ..Config::DEFAULT
    };
    (0..runs)
        .into_par_iter()
        .progress_with(progress(
            runs.into(),
            format!("{}, stationary at {stop}", track.name),
        )?)
        .map(|run| {
            let sights = stationary.bearings(track, &mut random::generator(seed, run.into()));
            let answer = locate(&config, &sights, seed ^ u64::from(run))?;
            Ok(Outcome::of(answer, track.source))
        })
        .collect()
}
