//! Sigmas that are not as stated, and tracks of any size.

use anyhow::Result;
use foxhunt_host::{figures::Figure, reference::Model, simulate, tracks::Track};
use foxhunt_simulation::{Sight, faults::Faults, random::generator};

use super::{
    config::{BIAS_SIGMA, SCALE_SIGMA, nothing},
    runs::{HEADER, Limits, Run, Runs, exact},
};
use crate::papers::{outcome::locate, table::table};

const LIMITS: Limits = Limits {
    ratio: 1.05,
    covered: [0.93, 0.97],
};
/// Sigmas are so many times as large as stated: with a key.
const FACTORS: [(&str, f64); 5] = [
    ("third", 1.0 / 3.0),
    ("half", 0.5),
    ("stated", 1.0),
    ("twice", 2.0),
    ("thrice", 3.0),
];
/// Ranges of the source from the first receiver, in metres: with a key.
const RANGES: [(&str, f64); 6] = [
    ("5m", 5.0),
    ("20m", 20.0),
    ("100m", 100.0),
    ("1km", 1e3),
    ("5km", 5e3),
    ("20km", 2e4),
];

/// Runs both tracks.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for track in [Track::a1(), Track::a2()] {
        let mut table = table(HEADER, 1);
        let name = track.name.to_lowercase();
        for (key, factor) in FACTORS {
            let all = of(&track, factor, runs, seed)?;
            table.add_row(all.row(&format!("errors {factor:.2} times as stated")));
            figures.extend(all.figures(&format!("field.scale.{name}.{key}"), &LIMITS));
        }
        for (key, range) in RANGES {
            let all = of(&of_size(&track, range), 1.0, runs, seed)?;
            table.add_row(all.row(&format!("a source {range} m away")));
            figures.extend(all.figures(&format!("field.scale.{name}.{key}"), &LIMITS));
        }
        println!(
            "Track {}, {runs} runs; the exact posterior knows the scale of the errors and their bias as little as the \
             locator, which expects a bias of four degrees by default\n\n{table}\n",
            track.name
        );
    }
    Ok(figures)
}

/// The same track, with its source at another range from the first receiver.
fn of_size(track: &Track, range: f64) -> Track {
    let first = track.receivers[0];
    let now = (track.source[0] - first[0]).hypot(track.source[1] - first[1]);
    let place = |[x, y]: [f64; 2]| [x, y].map(|v| v * range / now);
    Track {
        source: place(track.source),
        receivers: track.receivers.iter().copied().map(place).collect(),
        ..track.clone()
    }
}

/// Where errors are so many times as large as stated.
fn of(track: &Track, factor: f64, runs: u32, seed: u64) -> Result<Runs> {
    let told = nothing(track.sigma);
    let track = Track {
        sigma: factor * track.sigma,
        ..track.clone()
    };
    Runs::new(runs, &format!("{}, x {factor:.2}", track.name), |run| {
        let sights: Vec<Sight> = simulate::bearings(&track, &mut generator(seed, run))
            .into_iter()
            .map(|sight| Sight {
                sigma: told.sigma,
                ..sight
            })
            .collect();
        let model = Model {
            scale_sigma: SCALE_SIGMA,
            ..Model::with_faults(&Faults {
                bias_sigma: BIAS_SIGMA,
                ..Faults::default()
            })
        };
        let exact = exact(&sights, model)?;
        let answer = locate(&told.config, &sights, seed ^ run)?;
        let last = track.receivers[track.receivers.len() - 1];
        Ok(Run::new(answer, &exact, track.source, last))
    })
}
