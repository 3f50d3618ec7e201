//! The robust locator on bearings of which some are wild, mirrored or biased, beside the exact posterior that knows how
//! many and by how much, and the locator that knows of none; on a parked vehicle; and on measured bearings.

use anyhow::Result;

use super::Study;

mod measured;
mod parked;
mod pictures;
mod simulated;

/// Runs all experiments.
pub fn run(study: &Study) -> Result<()> {
    let runs = study.runs.unwrap_or(1000);
    let mut figures = simulated::run(runs, study.seed)?;
    figures.extend(parked::run(runs.div_ceil(5), study.seed)?);
    figures.extend(measured::run(runs.div_ceil(20), study.seed)?);
    pictures::draw(study.seed)?;
    study.conclude(&figures)
}
