//! The robust locator on bearings of which some are outliers, mirrored or biased, beside the exact posterior that knows how
//! many and by how much, and the plain locator that expects none; from a stationary vehicle; and on measured bearings.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::study::Study;

mod measured;
mod others;
mod outcome;
mod pictures;
mod simulated;
mod stationary;

/// Runs all experiments.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = study.runs.unwrap_or(1000);
    let mut figures = simulated::run(runs, study.seed)?;
    figures.extend(stationary::run(runs.div_ceil(5), study.seed)?);
    figures.extend(measured::run(study, runs.div_ceil(20))?);
    pictures::draw(study)?;
    Ok(figures)
}
