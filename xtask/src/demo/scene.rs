//! The drive that is shown.

use std::path::Path;

use anyhow::{Context, Result};
use foxhunt_host::measured::Measured;

use crate::{drive::EXAMPLE, project};

/// A drive to be shown.
pub struct Scene {
    /// Name of the pictures.
    pub name: String,
    pub title: String,
    /// Whether the bearings were taken on one way.
    pub joined: bool,
    pub bytes: Vec<u8>,
}

impl Scene {
    /// The drive that comes with the project.
    pub fn example() -> Result<Self> {
        let file = project::root().join(EXAMPLE);
        let bytes = std::fs::read(&file)
            .with_context(|| format!("cannot read {}: run `cargo xtask drive`", file.display()))?;
        Ok(Self {
            name: "drive".into(),
            title: "A transmitter located from a moving vehicle".into(),
            joined: true,
            bytes,
        })
    }

    /// The measured bearings of a file on a transmitter, with a standard deviation in degrees.
    pub fn measured(file: &Path, transmitter: &str, sigma: f64) -> Result<Self> {
        let measured = Measured::read(file, transmitter)?;
        let set = file.file_stem().unwrap_or_default().to_string_lossy();
        println!(
            "{} bearings on {transmitter} of {set}, taken to be good to {sigma} degrees",
            measured.bearings.len(),
        );
        Ok(Self {
            name: format!("{set}-{transmitter}"),
            title: format!("{transmitter}, located by the measured bearings of {set}"),
            joined: false,
            bytes: measured.drive(sigma)?.bytes().to_vec(),
        })
    }
}
