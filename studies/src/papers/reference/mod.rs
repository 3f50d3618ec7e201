//! The exact posterior of bearings beside uniform grids: on all tracks, in measured rooms and on random geometries, with each
//! kind of fault.
//!
//! The papers print tracks A1, A2, A5 and B2, as pictures; A3, A4 and B1 are ours and stand in for other ways to the same sources.
//! Grids are told nothing of where the posterior looks.

use std::time::Instant;

use anyhow::Result;
use foxhunt_host::{
    figures::Figure,
    reference::{Brute, Difference, Model, Posterior},
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use self::cases::Case;
use super::{
    statistics::median,
    study::{Study, progress},
    table::table,
};

mod cases;
mod measured;
mod random;

/// Runs of each kind of random geometry are a quarter of this many, unless told otherwise, and of each track a twelfth.
const RUNS: u32 = 12;

/// Prints the table, and returns its figures.
///
/// # Errors
/// If measured data cannot be read.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = u64::from(study.runs.unwrap_or(RUNS));
    let mut cases = cases::tracks(runs.div_ceil(12), study.seed);
    cases.extend(random::cases(runs.div_ceil(4), study.seed));
    if let Some(data) = study.data("wsr", "rooms") {
        cases.extend(measured::rooms(&data)?);
    }
    if let Some(data) = study.data("xplr", "stops") {
        cases.extend(measured::stops(&data)?);
    }
    let outcomes: Vec<Outcome> = cases
        .par_iter()
        .progress_with(progress(cases.len() as u64, "grids")?)
        .map(Outcome::new)
        .collect();
    let mut groups: Vec<&str> = cases.iter().map(|case| case.group.as_str()).collect();
    groups.dedup();
    let header = [
        "bearings",
        "posteriors",
        "too coarse a grid",
        "mean off, sigmas",
        "sigma off, %",
        "log-evidence off",
        "mode below, nats",
        "grid itself off, sigmas",
        "median time, ms",
    ];
    let mut table = table(header, 1);
    let mut figures = Vec::new();
    for group in groups {
        let members = cases.iter().zip(&outcomes);
        let members = members.filter(|(case, _)| case.group == group);
        let worst = Worst::new(members.map(|(_, outcome)| outcome));
        table.add_row(worst.row(group));
        figures.extend(worst.figures(group));
    }
    println!(
        "The exact posterior beside a uniform grid, in the square in which it is sought: the worst of each group. A grid is too \
         coarse where one of half as many cells a side says something else.\n\n{table}\n"
    );
    Ok(figures)
}

/// How far the posterior is from the grid.
struct Outcome {
    /// `None` if the grid is too coarse.
    off: Option<Difference>,
    evidence: f64,
    /// Of the posterior's mode below the highest maximum that was found, in nats.
    below: f64,
    /// Of the grid, from one half as fine.
    grid: f64,
    /// In milliseconds.
    time: f64,
}

impl Outcome {
    fn new(case: &Case) -> Self {
        let Case {
            square,
            sights,
            faults,
            ..
        } = case;
        let started = Instant::now();
        let model = Model::with_faults(faults);
        let posterior = Posterior::within(square, sights, &model);
        let time = 1e3 * started.elapsed().as_secs_f64();
        let brute = Brute::new(square, sights, &model, case.finest());
        let below = posterior.as_ref().map_or(f64::INFINITY, |posterior| {
            brute.maximum.0 - posterior.log_likelihood(posterior.mode)
        });
        let Some(grid) = brute.grid else {
            return Self {
                off: None,
                evidence: 0.0,
                below,
                grid: 0.0,
                time,
            };
        };
        let lost = Difference {
            mean: f64::INFINITY,
            sigma: f64::INFINITY,
        };
        let compare = |p: &Posterior| {
            let off = Difference::new(p.mean, &p.covariance, (grid.mean, &grid.covariance));
            (off, (p.log_evidence - grid.log_evidence).abs())
        };
        let (off, evidence) = posterior.as_ref().map_or((lost, f64::INFINITY), compare);
        Self {
            off: Some(off),
            evidence,
            below,
            grid: grid.error.mean,
            time,
        }
    }
}

/// The worst of a group.
struct Worst {
    count: usize,
    coarse: usize,
    mean: f64,
    sigma: f64,
    evidence: f64,
    below: f64,
    grid: f64,
    time: f64,
}

impl Worst {
    fn new<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Self {
        let all: Vec<&Outcome> = outcomes.collect();
        let worst = |of: fn(&Outcome) -> f64| all.iter().map(|o| of(o)).fold(0.0, f64::max);
        Self {
            count: all.len(),
            coarse: all.iter().filter(|o| o.off.is_none()).count(),
            mean: worst(|o| o.off.map_or(0.0, |off| off.mean)),
            sigma: worst(|o| o.off.map_or(0.0, |off| off.sigma)),
            evidence: worst(|o| o.evidence),
            below: worst(|o| o.below),
            grid: worst(|o| o.grid),
            time: median(all.iter().map(|o| o.time)),
        }
    }

    fn row(&self, group: &str) -> [String; 9] {
        [
            group.replace('.', ", "),
            self.count.to_string(),
            self.coarse.to_string(),
            format!("{:.1e}", self.mean),
            format!("{:.1e}", 100.0 * self.sigma),
            format!("{:.1e}", self.evidence),
            format!("{:.1e}", self.below),
            format!("{:.1e}", self.grid),
            format!("{:.1}", self.time),
        ]
    }

    fn figures(&self, group: &str) -> [Figure; 5] {
        let figure = |what, value, unit| {
            Figure::new(format!("papers.reference.{group}.{what}"), value, unit)
        };
        [
            figure("mean_off", self.mean, "sigmas").at_most(0.01),
            figure("sigma_off", 100.0 * self.sigma, "%").at_most(1.0),
            figure("evidence_off", self.evidence, "nats").at_most(0.01),
            figure("mode_below", self.below, "nats").at_most(1e-3),
            figure("coarse_grids", self.coarse as f64, "posteriors"),
        ]
    }
}
