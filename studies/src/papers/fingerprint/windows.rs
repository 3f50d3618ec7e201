//! Packets that come one by one while the person walks.

use anyhow::{Context, Result};
use foxhunt::fingerprint::{
    RadioMap,
    tracker::{Config, Site},
};
use foxhunt_host::{
    experiment::{SAMPLES, SURVEYED, WALKED},
    figures::Figure,
    walks::{follow, of_simulated_packets, tunnel_map},
};
use foxhunt_simulation::{
    random::generator,
    tunnel::{Radio, Tunnel},
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::errors::Errors;
use crate::papers::{
    study::{Study, progress},
    table::table,
};

/// Metres a second, and packets a second of every beacon.
pub const SPEED: f64 = 2.5;
pub const RATE: f64 = 2.0;
pub const NOISE: f64 = 4.0;
/// Milliseconds of packets that make one update.
const WINDOWS: [u32; 4] = [250, 500, 1000, 2000];

/// Runs all windows on the same packets.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = u64::from(study.runs.unwrap_or(1000));
    let walks: Vec<[Vec<f64>; WINDOWS.len()]> = (0..runs)
        .into_par_iter()
        .progress_with(progress(runs, "packets")?)
        .map(|run| one_run(run, study.seed))
        .collect::<Result<_>>()?;
    let mut table = table(["window", "RMSE m", "< 2 m", "90 % below m", "> 20 m"], 0);
    let default = default_window()?;
    let mut figures = Vec::new();
    for (number, window) in WINDOWS.iter().enumerate() {
        let mut errors = Errors::default();
        for walk in &walks {
            errors.push(walk[number].clone());
        }
        table.add_row([
            format!("{window} ms"),
            errors.rmse().to_string(),
            format!("{:.1} %", 100.0 * errors.near().value),
            format!("{:.2}", errors.quantile(0.9)),
            format!("{:.2} %", 100.0 * errors.lost()),
        ]);
        let prefix = format!("papers.fingerprint.packets.window_{window}_ms");
        let beyond = 1.0 - errors.near().value;
        let mut beyond = Figure::new(format!("{prefix}.beyond_2_m"), beyond, "of steps");
        if *window == default {
            beyond = beyond.at_most(0.15);
        }
        figures.push(beyond);
        figures.push(Figure::new(
            format!("{prefix}.rmse"),
            errors.rmse().value,
            "m",
        ));
    }
    println!(
        "The same tunnel, walked at {SPEED} m/s, every beacon heard {RATE} times a second with {NOISE} dB of noise; {runs} \
         runs, the place asked for every 2 s, where it is then. By how long packets are collected for an update (default: \
         {default} ms):"
    );
    println!("{table}");
    println!();
    Ok(figures)
}

/// The window that the library begins with.
fn default_window() -> Result<u32> {
    let is_default = |window: &u32| *window == Config::DEFAULT.window_ms;
    let default = WINDOWS.into_iter().find(is_default);
    default.context("none of the windows is the default")
}

fn one_run(run: u64, seed: u64) -> Result<[Vec<f64>; WINDOWS.len()]> {
    let mut rng = generator(seed ^ 0x77, run);
    let site = Tunnel::default().draw(&mut rng);
    let places: Vec<[f64; 2]> = (0..=80).map(|x| [f64::from(x), SURVEYED]).collect();
    let radio = Radio::new(NOISE);
    let map = tunnel_map(&site.survey(&places, SAMPLES, &radio, &mut rng))?;
    let seconds = site.tunnel.length / SPEED;
    let path = |time: f64| [SPEED * time, WALKED];
    let packets = site.walk(path, seconds, RATE, &radio, &mut rng);
    let times: Vec<f64> = (1..=(seconds / 2.0) as u32)
        .map(|k| 2.0 * f64::from(k))
        .collect();
    let errors = |window_ms| {
        let config = Config {
            window_ms,
            ..of_simulated_packets()
        };
        let tracked = Site::new(RadioMap::new(&map)?, config)?;
        let found = follow(&tracked, &packets, &times, run)?;
        let pairs = found.iter().zip(&times);
        Ok(pairs
            .map(|(place, time)| place[0] - path(*time)[0])
            .collect())
    };
    let errors: Vec<Vec<f64>> = WINDOWS.into_iter().map(errors).collect::<Result<_>>()?;
    errors.try_into().ok().context("one result for each window")
}
