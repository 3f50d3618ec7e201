//! The drive that comes with the project, and the task `drive` that remakes it.

use std::fs;

use anyhow::{Context, Result};
use foxhunt_host::drive::{EXAMPLE_SEED, example};

use crate::project;

/// The drive that comes with the project.
pub const EXAMPLE: &str = "examples/data/drive.nmea";

/// Simulates the drive and writes its file.
pub fn run() -> Result<()> {
    let drive = example(EXAMPLE_SEED);
    let bytes = drive.bytes();
    fs::write(project::root().join(EXAMPLE), bytes)
        .with_context(|| format!("cannot write {EXAMPLE}"))?;
    println!("{EXAMPLE}: {} bytes, seed {EXAMPLE_SEED}", bytes.len());
    Ok(())
}
