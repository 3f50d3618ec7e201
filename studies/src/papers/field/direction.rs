//! A bias that depends on the direction from the bow.

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{Bearing, Locate, Observation},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    curve::Curve,
    figures::Figure,
    reference::{Biases, ByDirection as Unknown, Model, Posterior},
    tracks::Track,
};
use foxhunt_simulation::{Sight, random::generator};

use super::{
    config::{self, ByDirection, CURVE_SIGMA, HARMONICS, Told},
    runs::{HEADER, Limits, Run, Runs, exact},
};
use crate::papers::table::table;

const FIRST: Limits = Limits {
    ratio: 1.2,
    covered: [0.92, 0.98],
};
const NEXT: Limits = Limits {
    ratio: 1.05,
    covered: [0.92, 0.98],
};

/// When the next drive begins.
const NEXT_MS: u32 = 1_000_000;

/// Runs both tracks, and the next drive with each array.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut table = table(HEADER, 1);
    for (key, name, track) in [
        ("l", "an L (A2)", Track::a2()),
        ("circle", "a circle about the source (A5)", Track::a5()),
    ] {
        let first = drive(&track, runs, seed, name, false)?;
        table.add_row(first.row(name));
        figures.extend(first.figures(&format!("field.direction.{key}"), &FIRST));
        let name = format!("{name}, the next drive");
        let next = drive(&track, runs, seed, &name, true)?;
        table.add_row(next.row(&name));
        figures.extend(next.figures(&format!("field.direction.{key}.next"), &NEXT));
    }
    println!(
        "A bias of two harmonics of the direction from the bow, of 10 degrees in all, {runs} runs; the next drive is an L, with what \
         was learned\n\n{table}\n"
    );
    Ok(figures)
}

/// The first drive along a track, or the one after it.
fn drive(track: &Track, runs: u32, seed: u64, name: &str, next: bool) -> Result<Runs> {
    Runs::new(runs, name, |run| {
        let curve = Curve::random(HARMONICS, CURVE_SIGMA, &mut generator(seed, run));
        let (sights, headings) = curve.bearings(track, &mut generator(!seed, run));
        let model = Model {
            biases: by_direction(&headings),
            ..Model::default()
        };
        let posterior = exact(&sights, model)?;
        let told = config::direction(track.sigma);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed ^ run);
        let mut locator = Box::new(ByDirection::EMPTY);
        push(&mut locator, &told, (&sights, &headings), 0, &mut rng)?;
        if !next {
            let answer = locator.answer();
            return Ok(Run::new(answer, &posterior, track.source, last(track)));
        }
        let track = Track::a2();
        let mut randoms = generator(seed.rotate_left(32), run);
        let (sights, headings) = curve.bearings(&track, &mut randoms);
        let exact = after(&posterior, &sights, &headings)?;
        locator.forget_source();
        push(&mut locator, &told, (&sights, &headings), NEXT_MS, &mut rng)?;
        Ok(Run::new(
            locator.answer(),
            &exact,
            track.source,
            last(&track),
        ))
    })
}

/// Takes a drive's bearings, that begins at this time.
fn push(
    locator: &mut ByDirection,
    told: &Told,
    (sights, headings): (&[Sight], &[f64]),
    start_ms: u32,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<()> {
    for (sight, heading) in sights.iter().zip(headings) {
        let time_ms = start_ms + sight.time_ms;
        let observation = Observation::try_from(Sight { time_ms, ..*sight })?;
        let heading = Bearing::from_radians(*heading as f32);
        locator.push(&observation.with_heading(heading), &told.config, rng)?;
    }
    Ok(())
}

fn last(track: &Track) -> [f64; 2] {
    track.receivers[track.receivers.len() - 1]
}

fn by_direction(headings: &[f64]) -> Biases {
    Biases::ByDirection(Unknown::new(headings.to_vec(), HARMONICS, CURVE_SIGMA))
}

/// The exact posterior of a drive with what another one says of the biases, as a normal distribution.
fn after(before: &Posterior, sights: &[Sight], headings: &[f64]) -> Result<Posterior> {
    let (mean, covariance) = before.biases();
    let root = covariance.cholesky().context("no covariance")?.l();
    let learned = Unknown {
        mean,
        root,
        ..Unknown::new(headings.to_vec(), HARMONICS, CURVE_SIGMA)
    };
    let model = Model {
        biases: Biases::ByDirection(learned),
        ..Model::default()
    };
    exact(sights, model)
}
