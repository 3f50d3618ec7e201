//! Prints what a step of each filter costs on this machine, as a JSON list of figures.

use std::time::Duration;

use cpu_time::ThreadTime;
use foxhunt_peers::filters::{BayesEstimate, Filter, Foxhunt, Multicalc};
use foxhunt_peers::workload::{SEED, STEPS, Sighting, error_m, sightings};
use serde::Serialize;

const PARTICLES: usize = 1000;
/// Drives whose median time is one sample, and samples of which the best counts. Every drive has a
/// seed of its own.
const DRIVES: usize = 31;
const SAMPLES: usize = 5;

#[derive(Serialize)]
struct Figure {
    name: String,
    value: f64,
    unit: &'static str,
    limit: Option<f64>,
}

/// One filter in the comparison, and what its drives gave.
struct Entry {
    name: &'static str,
    drive: fn(&[Sighting; STEPS], seed: u64) -> Drive,
    best: Duration,
    squared_errors: Vec<f64>,
}

/// What one drive past the source gave.
struct Drive {
    /// CPU time of every step but the first, which warms the caches.
    time: Duration,
    /// How far the last mean is off, in metres; `None` if the filter gave up on the way.
    error: Option<f32>,
}

impl Entry {
    fn new<F: Filter<PARTICLES>>(name: &'static str) -> Self {
        Self {
            name,
            drive: drive::<F>,
            best: Duration::MAX,
            squared_errors: Vec::new(),
        }
    }

    fn figures(&self) -> Vec<Figure> {
        let figure = |name, value, unit| Figure {
            name: format!("host.peer.{}.{name}", self.name),
            value,
            unit,
            limit: None,
        };
        let particle_steps = ((STEPS - 1) * PARTICLES) as f64;
        let nanoseconds = self.best.as_nanos() as f64 / particle_steps;
        let lost = SAMPLES * DRIVES - self.squared_errors.len();
        let mut figures = vec![
            figure("step.n1000.ns", nanoseconds, "ns"),
            figure("lost_drives", lost as f64, "drives of 155"),
        ];
        if !self.squared_errors.is_empty() {
            let sum: f64 = self.squared_errors.iter().sum();
            let error = (sum / self.squared_errors.len() as f64).sqrt();
            figures.push(figure("final_error_m", error, "m"));
        }
        figures
    }
}

fn drive<F: Filter<PARTICLES>>(sightings: &[Sighting; STEPS], seed: u64) -> Drive {
    let mut filter = F::new(seed);
    let mut sound = true;
    let mut mean = None;
    let mut step = |sighting| {
        mean = filter.step(sighting);
        sound &= mean.is_some();
    };
    step(&sightings[0]);
    let start = ThreadTime::now();
    sightings[1..].iter().for_each(&mut step);
    let time = start.elapsed();
    let error = mean.map(error_m).filter(|error| sound && error.is_finite());
    Drive { time, error }
}

fn main() -> serde_json::Result<()> {
    let sightings = sightings();
    let mut entries = [
        Entry::new::<Foxhunt<PARTICLES>>("foxhunt"),
        Entry::new::<Multicalc<f32>>("multicalc"),
        Entry::new::<Multicalc<f64>>("multicalc_f64"),
        Entry::new::<BayesEstimate>("bayes_estimate"),
    ];

    // The entries take turns within a sample, so that a change of the clock rate meets all of them.
    for sample in 0..SAMPLES {
        let mut times = entries.each_ref().map(|_| [Duration::ZERO; DRIVES]);
        for turn in 0..DRIVES {
            let seed = SEED + (sample * DRIVES + turn) as u64;
            for (entry, times) in entries.iter_mut().zip(&mut times) {
                let drive = (entry.drive)(&sightings, seed);
                times[turn] = drive.time;
                entry
                    .squared_errors
                    .extend(drive.error.map(|error| f64::from(error).powi(2)));
            }
        }
        for (entry, times) in entries.iter_mut().zip(&mut times) {
            times.sort_unstable();
            entry.best = entry.best.min(times[DRIVES / 2]);
        }
    }

    let figures: Vec<Figure> = entries.iter().flat_map(Entry::figures).collect();
    serde_json::to_writer_pretty(std::io::stdout(), &figures)?;
    println!();
    Ok(())
}
