//! Cui, Wu, He, Wu: fingerprint tracking in a tunnel, Application Research of Computers 34(5), 2017.
//!
//! Their match with a filter after it, as they give it, beside our tracker and exact filters: in a simulated tunnel of the
//! size of theirs, and on walks that were measured in an office.

use anyhow::Result;

use super::Study;

mod errors;
mod measured;
mod pictures;
mod simulated;
mod windows;

/// Runs all experiments.
pub fn run(study: &Study) -> Result<()> {
    let mut figures = simulated::run(study)?;
    figures.extend(windows::run(study)?);
    pictures::simulated(study.seed)?;
    figures.extend(measured::run(study)?);
    study.conclude(&figures)
}
