//! The task `demo`.

use anyhow::{Result, bail};

/// The options of `cargo xtask demo`.
#[derive(clap::Args)]
pub struct Options {}

/// Runs the task.
pub fn run(_options: &Options) -> Result<()> {
    bail!("not written yet")
}
