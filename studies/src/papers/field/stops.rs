//! A vehicle that takes many readings at each stop, all of which share an error.

use anyhow::Result;
use foxhunt::aoa::Clean;
use foxhunt_host::{
    figures::Figure,
    reference::Model,
    stops::{Stops, shuffle},
};
use foxhunt_simulation::{Sight, random::generator};

use super::{
    config::{self, CLEAN, GUESSED_SIGMA, READING_SIGMA, STOP_SIGMA, Told},
    runs::{HEADER, Limits, Run, Runs, exact},
};
use crate::papers::{
    outcome::{locate, locate_by},
    table::table,
};

/// Readings of a stop, and by which number the runs are divided: five thousand readings take seconds.
const READINGS: [(usize, u32); 4] = [(1, 1), (5, 1), (50, 2), (500, 10)];
const RIGHT: Limits = Limits {
    ratio: 1.1,
    covered: [0.92, 0.98],
};
const GUESSED: Limits = Limits {
    ratio: 1.1,
    covered: [0.85, 1.0],
};

/// A locator, and what it is told.
#[derive(Clone, Copy)]
enum Kind {
    Robust(Told, Limits),
    Clean(f64),
}

/// Runs all numbers of readings in both orders, each in turns with each source.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let kinds = [
        ("right", "told right", Kind::Robust(config::stops(), RIGHT)),
        (
            "guessed",
            "told 5 degrees",
            Kind::Robust(config::nothing(GUESSED_SIGMA), GUESSED),
        ),
        ("clean", "clean, told 5 degrees", Kind::Clean(GUESSED_SIGMA)),
    ];
    let mut figures = Vec::new();
    let mut table = table(HEADER, 1);
    for (readings, divisor) in READINGS {
        for order in ["in order", "mixed"] {
            for (key, name, kind) in kinds {
                let what = format!("{readings} a stop, {order}, {name}");
                let all = of(
                    kind,
                    readings,
                    order == "mixed",
                    runs.div_ceil(divisor),
                    seed,
                    &what,
                )?;
                table.add_row(all.row(&what));
                let order = order.replace(' ', "_");
                let prefix = format!("field.stops.n{readings}.{order}.{key}");
                figures.extend(match kind {
                    Kind::Robust(_, limits) => all.figures(&prefix, &limits),
                    Kind::Clean(_) => all.kept(&prefix),
                });
            }
        }
    }
    println!(
        "Stops with an error of 15 degrees each and 3 degrees a reading, 21 of them round a square of 400 m; {runs} runs in \
         turns with four sources 100 to 200 m from the road (fewer where there are many readings); the exact \
         posterior knows the errors. Lost is beyond five of its standard deviations.\n\n{table}\n"
    );
    Ok(figures)
}

fn of(kind: Kind, readings: usize, mixed: bool, runs: u32, seed: u64, what: &str) -> Result<Runs> {
    let stops = Stops {
        readings,
        stop_sigma: STOP_SIGMA,
        sigma: READING_SIGMA,
    };
    Runs::new(runs, what, |run| {
        let source = Stops::SOURCES[run as usize % Stops::SOURCES.len()];
        let mut sights = stops.bearings(source, &mut generator(seed, run));
        if mixed {
            shuffle(&mut sights, &mut generator(!seed, run));
        }
        let last = sights[sights.len() - 1].position;
        let exact = exact(&stops.summary(&sights), Model::default())?;
        let with = |sigma| {
            let sights = sights.iter().map(move |sight| Sight { sigma, ..*sight });
            sights.collect::<Vec<Sight>>()
        };
        let seed = seed ^ run;
        let answer = match kind {
            Kind::Robust(told, _) => locate(&told.config, &with(told.sigma), seed)?,
            Kind::Clean(sigma) => locate_by::<Clean<256>>(&CLEAN, &with(sigma), seed)?,
        };
        Ok(Run::new(answer, &exact, source, last))
    })
}
