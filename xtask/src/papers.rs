//! The task `papers`: published experiments, run again and compared with their figures.

use anyhow::Result;

mod aoa;
mod statistics;

/// The options of `cargo xtask papers`.
#[derive(clap::Args)]
pub struct Options {
    #[command(subcommand)]
    paper: Paper,
}

#[derive(clap::Subcommand)]
enum Paper {
    /// Locate a transmitter by bearings: the particle filter of Du et al. (2016), the locator and
    /// Gauss-Newton, beside the exact posterior.
    Aoa(aoa::Options),
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    match &options.paper {
        Paper::Aoa(options) => aoa::run(options),
    }
}
