//! Fixed arrays round a room, each of which has a bias of its own, and a tag at rest: simulated and measured.

use anyhow::Result;
use foxhunt::{
    aoa::{Answer, Locate, Observation},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    figures::Figure,
    reference::Model,
    stations::Stations,
    xplr::{self, Stop},
};
use foxhunt_simulation::{Sight, random::generator};
use nalgebra::Vector2;
use rayon::prelude::*;

use super::{
    config::{self, ByStation, STATION_READING_SIGMA, STATION_SIGMA, STATION_TIME_S, Told},
    runs::{HEADER, Limits, Run, Runs, exact_within},
};
use crate::papers::{
    others::nearest_to_lines, outcome::Outcome, statistics::median, study::Study, table::table,
};

const LIMITS: Limits = Limits {
    ratio: 1.1,
    covered: [0.92, 0.98],
};
/// Seconds of readings.
const SECONDS: [usize; 3] = [1, 10, 60];
/// Milliseconds of measured readings that are located by themselves.
const WINDOW_MS: u32 = 5_000;

/// Runs the simulated and the measured arrays.
pub fn run(study: &Study, runs: u32) -> Result<Vec<Figure>> {
    let seed = study.seed;
    let mut figures = Vec::new();
    let mut table = table(HEADER, 1);
    for seconds in SECONDS {
        // A minute has 2,400 readings.
        let runs = if seconds > 10 { runs.div_ceil(5) } else { runs };
        let all = simulated(seconds, runs, seed)?;
        table.add_row(all.row(&format!("{seconds} s")));
        figures.extend(all.figures(&format!("field.stations.s{seconds}"), &LIMITS));
    }
    println!(
        "Four arrays round a room with a bias of 10 degrees each and 3 degrees a reading, a tag at rest anywhere, {runs} runs\n\n\
         {table}\n"
    );
    if let Some(data) = study.data("xplr", "arrays") {
        figures.extend(measured(&xplr::stops(&data, STATION_READING_SIGMA)?, seed)?);
    }
    Ok(figures)
}

fn simulated(seconds: usize, runs: u32, seed: u64) -> Result<Runs> {
    let stations = Stations {
        readings: 10 * seconds,
        bias_sigma: STATION_SIGMA,
        sigma: STATION_READING_SIGMA,
        time_s: STATION_TIME_S,
    };
    let told = config::stations();
    Runs::new(runs, &format!("arrays, {seconds} s"), |run| {
        let heard = stations.hear(&mut generator(seed, run));
        let exact = exact_within(config::ROOM_M, &stations.summary(&heard), Model::default())?;
        let answer = locate(&told, &heard.sights, seed ^ run)?;
        Ok(Run::new(answer, &exact, heard.tag, Stations::PLACES[3]))
    })
}

/// The last answer to the bearings of several stations.
fn locate(told: &Told, sights: &[(u8, Sight)], seed: u64) -> Result<Answer> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(ByStation::EMPTY);
    for (station, sight) in sights {
        let sigma = told.sigma;
        let observation = Observation::try_from(Sight { sigma, ..*sight })?;
        let observation = observation.from_station(*station);
        locator.push(&observation, &told.config, &mut rng)?;
    }
    Ok(locator.answer())
}

/// What came of some seconds at a stop.
#[derive(Clone, Copy)]
struct Window {
    ours: Outcome,
    /// Of the lines of bearing, in metres.
    least_squares: f64,
}

/// The measured stops, in windows; told what holds in the simulation, and nothing of these arrays.
fn measured(stops: &[Stop], seed: u64) -> Result<Vec<Figure>> {
    let told = config::stations();
    let windows: Vec<Vec<Window>> = stops
        .par_iter()
        .map(|stop| {
            (stop.sights.chunk_by(|a, b| window(a) == window(b)))
                .map(|sights| {
                    let answer = locate(&told, sights, seed)?;
                    let lines: Vec<Sight> = sights.iter().map(|(_, sight)| *sight).collect();
                    let off = nearest_to_lines(&lines) - Vector2::from(stop.tag);
                    Ok(Window {
                        ours: Outcome::of(answer, stop.tag),
                        least_squares: off.norm(),
                    })
                })
                .collect::<Result<_>>()
        })
        .collect::<Result<_>>()?;
    let all: Vec<Window> = windows.iter().flatten().copied().collect();
    let ours = median(all.iter().map(|window| window.ours.error));
    let lines = median(all.iter().map(|window| window.least_squares));
    let covered = covered(windows.iter().flatten());
    let [low, high] = interval(&windows, seed);
    println!(
        "Measured arrays, {} stops of a minute in windows of {} s, told what holds in the simulation: median error {ours:.2} m \
         (least squares of the lines {lines:.2} m); the 95 % ellipse holds the tag in {:.0} %, {:.0} to {:.0} % over bootstrap \
         samples of stops\n",
        stops.len(),
        WINDOW_MS / 1000,
        100.0 * covered,
        100.0 * low,
        100.0 * high,
    );
    let figure =
        |what: &str, value, unit| Figure::new(format!("field.stations.xplr.{what}"), value, unit);
    let fixed = all.iter().filter(|w| w.ours.error.is_finite()).count();
    Ok(vec![
        figure("median", ours, "m"),
        figure("median_over_least_squares", ours / lines, "").at_most(1.0),
        figure("covered", covered, "of windows"),
        figure("covered_at_least", low, "of windows").at_most(0.95),
        figure("missed_at_least", 1.0 - high, "of windows").at_most(0.05),
        figure("no_fix", (all.len() - fixed) as f64, "windows"),
    ])
}

fn window((_, sight): &(u8, Sight)) -> u32 {
    sight.time_ms / WINDOW_MS
}

fn covered<'a>(windows: impl Iterator<Item = &'a Window>) -> f64 {
    let (count, covered) = windows.fold((0.0, 0.0), |(count, covered), window| {
        let covers = f64::from(u8::from(window.ours.covered));
        (count + 1.0, covered + covers)
    });
    covered / count
}

/// The 95 % interval of the coverage over samples of whole stops: the windows of a stop share the biases.
fn interval(stops: &[Vec<Window>], seed: u64) -> [f64; 2] {
    use rand::RngExt;

    const SAMPLES: usize = 2000;
    let mut rng = generator(seed, u64::MAX);
    let mut samples: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let picked: Vec<&Vec<Window>> = (stops.iter())
                .map(|_| &stops[rng.random_range(0..stops.len())])
                .collect();
            covered(picked.into_iter().flatten())
        })
        .collect();
    samples.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|q| samples[((SAMPLES - 1) as f64 * q) as usize])
}
