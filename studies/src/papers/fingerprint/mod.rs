//! Cui, Wu, He, Wu: fingerprint tracking in a tunnel, Application Research of Computers 34(5), 2017.
//!
//! Their match with a filter after it, as they give it, beside our tracker and exact filters: in a simulated tunnel of the
//! size of theirs, and on walks that were measured in an office.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::study::Study;

mod coverage;
mod errors;
mod measured;
mod pictures;
mod robot;
mod simulated;
mod strict;
mod two_stage;
mod windows;

/// Runs all experiments.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut figures = simulated::run(study)?;
    figures.extend(windows::run(study)?);
    pictures::simulated(study)?;
    figures.extend(strict::run(study)?);
    figures.extend(robot::run(study)?);
    figures.extend(measured::run(study)?);
    Ok(figures)
}
