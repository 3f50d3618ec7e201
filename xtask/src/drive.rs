//! The task `drive`: remakes the drive that comes with the project.

use std::fs;

use anyhow::{Context, Result};
use foxhunt_host::drive::{EXAMPLE_SEED, example};

use crate::{demo::EXAMPLE, project};

/// Simulates the drive and writes its file.
pub fn run() -> Result<()> {
    let drive = example(EXAMPLE_SEED);
    fs::write(project::root().join(EXAMPLE), drive.bytes())
        .with_context(|| format!("cannot write {EXAMPLE}"))?;
    println!(
        "{EXAMPLE}: {} bytes, seed {EXAMPLE_SEED}",
        drive.bytes().len()
    );
    Ok(())
}
