//! The robust locator on bearings of which some are outliers, mirrored or biased, beside the exact posterior that knows how
//! many and by how much, and the plain locator that expects none; and from a stationary vehicle.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::study::Study;

mod pictures;
mod simulated;
mod stationary;

/// Runs all experiments.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = study.runs.unwrap_or(1000);
    let mut figures = simulated::run(runs, study.seed)?;
    figures.extend(stationary::run(runs.div_ceil(5), study.seed)?);
    pictures::draw(study)?;
    Ok(figures)
}
