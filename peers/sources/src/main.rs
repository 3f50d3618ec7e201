//! Prints, as a JSON list of figures, how far a labelled multi-Bernoulli filter is from the sources of the scenarios of
//! `cargo xtask papers sources`.

mod lmb;

use anyhow::Result;
use clap::Parser;
use foxhunt_host::figures::Figure;
use foxhunt_studies::papers::sources::{Assignment, Gospa, Scenario};
use rayon::prelude::*;

/// The options.
#[derive(Parser)]
struct Options {
    /// Runs of each scenario [default: as many as its figures ask for].
    #[arg(long)]
    runs: Option<u32>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 2016)]
    seed: u64,
    /// Scenarios, by the first dotted words of their names [default: all].
    scenarios: Vec<String>,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let mut figures = Vec::new();
    for scenario in Scenario::asked(&options.scenarios)? {
        figures.extend(measure(&scenario, options.runs, options.seed));
    }
    serde_json::to_writer_pretty(std::io::stdout(), &figures)?;
    println!();
    Ok(())
}

fn measure(scenario: &Scenario, runs: Option<u32>, seed: u64) -> [Figure; 5] {
    let runs = u64::from(runs.unwrap_or(scenario.runs).min(scenario.runs));
    let one = |run: u64| {
        let (channel, readings) = scenario.readings(seed, run);
        let places = lmb::locate(&channel, &readings, 4.0 * scenario.cutoff_m);
        let assigned = Assignment::new(&channel.sources, &places, scenario.cutoff_m);
        let complete = assigned.estimates.iter().all(Option::is_some);
        (assigned.gospa, complete)
    };
    let all: Vec<(Gospa, bool)> = (0..runs).into_par_iter().map(one).collect();
    let sum: Gospa = all.iter().map(|(gospa, _)| *gospa).sum();
    let incomplete = all.iter().filter(|(_, complete)| !complete).count();
    let root = |sum: f64| (sum / runs as f64).sqrt();
    let figure = |what: &str, value, unit| {
        Figure::new(format!("sources.{}.{what}", scenario.name), value, unit)
    };
    [
        figure("lmb.incomplete", incomplete as f64 / runs as f64, "of runs"),
        figure("gospa_lmb", root(sum.total()), "m"),
        figure("gospa_lmb.placed", root(sum.localisation), "m"),
        figure("gospa_lmb.missed", root(sum.missed), "m"),
        figure("gospa_lmb.false", root(sum.ghosts), "m"),
    ]
}
