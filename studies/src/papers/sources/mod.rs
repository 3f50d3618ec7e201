//! Several sources at rest on one channel: found by default, and told apart; beside locators that are told whose each reading
//! is.

use anyhow::{Result, ensure};
use foxhunt_host::figures::Figure;

use super::{study::Study, table::table};

mod gospa;
mod locators;
mod runs;
mod scenarios;

use runs::{HEADER, Runs};
use scenarios::Scenario;

/// The names of all scenarios.
pub fn names() -> Vec<String> {
    let all = Scenario::all().into_iter();
    all.map(|scenario| scenario.name).collect()
}

/// Prints the table of the scenarios whose names begin like one of these, or of all, and returns their figures.
///
/// # Errors
/// When no scenario has such a name, or a reading is none.
pub fn run(study: &Study, asked: &[String]) -> Result<Vec<Figure>> {
    let is_asked = |scenario: &Scenario| {
        asked.is_empty() || asked.iter().any(|name| scenario.name.starts_with(name))
    };
    let mut figures = Vec::new();
    let mut table = table(HEADER, 1);
    let scenarios: Vec<Scenario> = Scenario::all().into_iter().filter(is_asked).collect();
    ensure!(
        !scenarios.is_empty(),
        "no scenario begins like this: they are {}",
        names().join(", ")
    );
    for scenario in &scenarios {
        let runs = study.runs.unwrap_or(scenario.runs).min(scenario.runs);
        let runs = Runs::new(scenario, runs, study.seed)?;
        table.add_row(runs.row());
        figures.extend(runs.figures());
    }
    println!(
        "Sources at rest, default configuration with {} tracks:\n\n{table}\n",
        locators::TRACKS
    );
    Ok(figures)
}
