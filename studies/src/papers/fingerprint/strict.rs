//! A map that is wrong: whether the tracker knows, beside a filter that is told how.

use anyhow::Result;
use foxhunt::fingerprint::{
    Lattice, RadioMap,
    tracker::{Config, Fix, Site},
};
use foxhunt_host::{
    figures::Figure,
    radio_map::{Reading, Recipe, Shape, SiteSurvey},
    reference::{
        corridor::LineMap,
        remembering::{self, Model},
    },
    walks::{self, fixes},
};
use foxhunt_simulation::{
    random::{generator, normal},
    tunnel::Packet,
};
use indicatif::ParallelProgressIterator;
use rand::{Rng, RngExt};
use rayon::prelude::*;

use super::coverage::Coverage;
use crate::papers::{
    statistics::root_mean_square,
    study::{Study, progress},
    table::table,
};

const LENGTHS: [f64; 3] = [2.0, 5.0, 10.0];
const SPEEDS: [f64; 4] = [0.0, 0.15, 1.0, 2.5];
/// The tunnel, in metres, and where its beacons are.
const TUNNEL: f64 = 80.0;
const BEACONS: [f64; 4] = [10.0, 30.0, 50.0, 70.0];
/// Of the map, and of a packet, in dB; packets of each beacon a second.
const ERROR: f64 = 4.0;
const NOISE: f64 = 4.0;
const RATE: f64 = 2.0;
/// Particles of the filter that is told. With 1,000 its errors at 2.5 m/s are 5 % larger than with 10,000, with 4,000 they are
/// those of 8,000.
const PARTICLES: usize = 4000;
/// Runs of that. The ratio of the errors of both scatters by 1 % then, so it is judged by the mean of all lengths and speeds.
const TWICE: u64 = 400;
/// Steps of the levels, in metres.
const STEP: f64 = 0.25;

/// What came of a walk: errors in metres, of the tracker and of the filter with so many particles, with twice as many and with
/// as many as the tracker; and whether the tracker's regions held the truth.
struct Outcome {
    ours: Vec<f64>,
    held: Vec<bool>,
    told: [Vec<f64>; 3],
}

/// A tracker that knows how people walk here, and a radio that is that of the survey.
fn config() -> Config {
    Config {
        velocity_sigma_m_s: 1.0,
        mismatch_sigma_db: 0.1,
        offset_probability: 0.0,
        ..Config::TUNNEL
    }
}

/// Runs all lengths and speeds.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = u64::from(study.runs.unwrap_or(1000));
    println!(
        "A tunnel whose map is off by {ERROR} dB, alike over some metres; packets with {NOISE} dB of noise, {RATE} a second of each \
         of four beacons; {runs} walks of up to a minute, asked every 2 s. Beside it a filter of {PARTICLES} particles that each \
         remember the error where they were, told of its sigma and length; and the same with {}, as many as the tracker has.",
        walks::PARTICLES
    );
    let header = [
        "length m",
        "m/s",
        "RMSE m",
        "of that told",
        "ratio",
        "told, twice as many",
        "told, as many",
        "95 % regions hold",
    ];
    let mut rows = table(header, 2);
    let mut figures = Vec::new();
    let mut ratios = Vec::new();
    for length in LENGTHS {
        for speed in SPEEDS {
            let bar = progress(runs, format!("error alike over {length} m, {speed} m/s"))?;
            let outcomes: Vec<Outcome> = (0..runs)
                .into_par_iter()
                .progress_with(bar)
                .map(|run| walk(length, speed, study.seed, run))
                .collect::<Result<_>>()?;
            let rmse = |of: &dyn Fn(&Outcome) -> &Vec<f64>| {
                root_mean_square(
                    outcomes
                        .iter()
                        .flat_map(|outcome| of(outcome).iter().copied()),
                )
            };
            let ours = rmse(&|outcome| &outcome.ours);
            let [told, twice, as_many] =
                [0, 1, 2].map(|n| rmse(&|outcome: &Outcome| &outcome.told[n]));
            // Of the same runs.
            let both = outcomes.iter().take(TWICE as usize);
            let first = root_mean_square(both.flat_map(|outcome| outcome.told[0].iter().copied()));
            let mut held = Coverage::default();
            for outcome in &outcomes {
                held.push(outcome.held.clone());
            }
            let coverage = held.value();
            rows.add_row([
                format!("{length}"),
                format!("{speed}"),
                format!("{ours:.2}"),
                format!("{told:.2}"),
                format!("{:.3}", ours / told),
                format!("{:.3}", twice / first),
                format!("{:.3}", as_many / told),
                format!("{:.1} %", 100.0 * coverage),
            ]);
            let prefix = format!("papers.fingerprint.wrong_map.{length}_m.{speed}_m_s");
            let figure = |name: &str, value| Figure::new(format!("{prefix}.{name}"), value, "");
            let off = f64::max(0.92 - coverage, coverage - 0.98).max(0.0);
            figures.push(figure("rmse_over_told", ours / told).at_most(1.10));
            figures.push(figure("coverage_off_92_to_98", off).at_most(0.0));
            figures.push(figure("told_by_as_many_over_told", as_many / told));
            ratios.push(twice / first);
        }
    }
    println!("{rows}\n");
    let off = (ratios.iter().sum::<f64>() / ratios.len() as f64 - 1.0).abs();
    let name = "papers.fingerprint.wrong_map.told_by_twice_as_many_off";
    figures.push(Figure::new(name, off, "").at_most(0.01));
    Ok(figures)
}

/// An Ornstein-Uhlenbeck process along the tunnel.
fn field(sigma: f64, length: f64, rng: &mut impl Rng) -> Vec<f64> {
    let kept = (-STEP / length).exp();
    let fresh = (1.0 - kept * kept).sqrt();
    let mut value = sigma * normal(rng);
    let mut next = || {
        let now = value;
        value = kept * value + fresh * sigma * normal(rng);
        now
    };
    (0..=(TUNNEL / STEP) as usize).map(|_| next()).collect()
}

fn at(field: &[f64], place: f64) -> f64 {
    let steps = place / STEP;
    let first = (steps as usize).min(field.len() - 2);
    let part = steps - first as f64;
    (1.0 - part) * field[first] + part * field[first + 1]
}

/// The map as it is surveyed, its bytes, and by beacon by how much it is wrong.
fn draw(length: f64, rng: &mut impl Rng) -> Result<(LineMap, Vec<u8>, Vec<Vec<f64>>)> {
    let points = TUNNEL as usize + 1;
    let mut readings = Vec::new();
    let mut errors = Vec::new();
    let mut levels = vec![Vec::new(); points];
    for (beacon, source) in BEACONS.into_iter().enumerate() {
        let shadow = field(4.0, 5.0, rng);
        errors.push(field(ERROR, length, rng));
        for (point, levels) in levels.iter_mut().enumerate() {
            let x = point as f64;
            let level = -40.0 - 10.0 * ((x - source).powi(2) + 3.0).log10() + at(&shadow, x);
            levels.push([level, 1.0]);
            // Two that are alike: the recipe sees that the survey has no noise, and smooths nothing. The filter that is told
            // knows the levels as they were heard, too.
            readings.extend([(); 2].map(|()| Reading {
                x,
                y: 0.0,
                beacon: beacon as u32,
                rssi: level,
            }));
        }
    }
    let map = LineMap {
        spacing: 1.0,
        levels,
    };
    let recipe = Recipe {
        cell_m: Some(0.0),
        shape: Some(Shape {
            length_m: 20.0,
            noise: 0.001,
        }),
        sigma_db: Some(ERROR),
        length_m: Some(length),
        packet_sigma_db: Some(NOISE),
        ..Recipe::on(Lattice::new([0.0, 0.0], 1.0, points as u16, 1)?)
    };
    let made = SiteSurvey::new(readings).map(&recipe, &mut |_| ())?;
    Ok((map, made.bytes, errors))
}

fn walk(length: f64, speed: f64, seed: u64, run: u64) -> Result<Outcome> {
    let mut rng = generator(seed ^ 0x51, run);
    let (map, bytes, errors) = draw(length, &mut rng)?;
    let seconds = if speed > 1.0 { 28.0 } else { 60.0 };
    let span = speed * seconds;
    let first = rng.random::<f64>() * (TUNNEL - span);
    let is_forward = rng.random_bool(0.5);
    let path = |time: f64| {
        first
            + if is_forward {
                speed * time
            } else {
                span - speed * time
            }
    };
    let mut packets = Vec::new();
    for (beacon, errors) in errors.iter().enumerate() {
        for period in 0..(seconds * RATE) as u32 {
            let time = (f64::from(period) + rng.random::<f64>()) / RATE;
            let x = path(time);
            let level = map.at(x, beacon)[0] + at(errors, x) + NOISE * normal(&mut rng);
            packets.push(Packet {
                time,
                beacon,
                level: level.round(),
            });
        }
    }
    packets.sort_by(|a, b| a.time.total_cmp(&b.time));
    let times: Vec<f64> = (1..=(seconds / 2.0) as u32)
        .map(|step| 2.0 * f64::from(step))
        .collect();

    let site = Site::new(RadioMap::new(&bytes)?, config())?;
    let found: Vec<Fix> = fixes(&site, &packets, &times, run)?;
    let told = [PARTICLES, 2 * PARTICLES, walks::PARTICLES].map(|particles| {
        if particles > PARTICLES && run >= TWICE {
            return Vec::new();
        }
        let places =
            remembering::follow(&map, &model(length), &packets, &times, particles, &mut rng);
        let pairs = places.iter().zip(&times);
        pairs.map(|(place, time)| place - path(*time)).collect()
    });
    let pairs = || found.iter().zip(&times);
    Ok(Outcome {
        ours: pairs()
            .map(|(fix, time)| f64::from(fix.position[0]) - path(*time))
            .collect(),
        held: pairs()
            .map(|(fix, time)| fix.contains([path(*time) as f32, 0.0], 0.95))
            .collect(),
        told,
    })
}

/// The same motion as that of the tracker.
fn model(length: f64) -> Model {
    let config = config();
    Model {
        length: TUNNEL,
        velocity: config.velocity_sigma_m_s.into(),
        acceleration: config.velocity_noise_m2_s3.into(),
        error: ERROR,
        error_length: length,
        noise: NOISE,
        window: f64::from(config.window_ms) / 1000.0,
    }
}
