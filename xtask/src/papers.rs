//! The task `papers`.

use anyhow::{Result, bail};

/// The options of `cargo xtask papers`.
#[derive(clap::Args)]
pub struct Options {}

/// Runs the task.
pub fn run(_options: &Options) -> Result<()> {
    bail!("not written yet")
}
