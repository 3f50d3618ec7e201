//! Several sources at rest on one channel: found by default, and told apart; beside locators that are told whose each reading
//! is.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::{study::Study, table::table};

mod gospa;
mod locators;
mod mixture;
mod runs;
mod scenarios;

pub use gospa::{Assignment, Gospa};
use runs::{HEADER, Runs};
pub use scenarios::Scenario;

/// Prints the table of the scenarios whose names begin like one of these, or of all, and returns their figures.
///
/// # Errors
/// When no scenario has such a name, or a reading is none.
pub fn run(study: &Study, asked: &[String]) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut table = table(HEADER, 1);
    let scenarios = Scenario::asked(asked)?;
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
