//! The task `map`: from a survey to a radio map, for the flash of a gateway.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result, bail};
use foxhunt::fingerprint::{self, RadioMap};
use foxhunt_host::radio_map::{Options as Building, SiteSurvey, rust_constant};

/// The options of `cargo xtask map`.
#[derive(clap::Args)]
pub struct Options {
    /// The survey: CSV with the columns x, y (metres), beacon (a number) and rssi (dBm).
    survey: PathBuf,
    /// Where the map is written: as Rust if it ends in .rs, otherwise as the bytes themselves.
    #[arg(long, value_name = "FILE")]
    output: PathBuf,
    /// Metres from one point of the map to the next.
    #[arg(long, value_name = "METRES", default_value_t = 1.0)]
    spacing: f64,
    /// What the map holds of each beacon at each point.
    #[arg(long, value_enum, default_value_t = Encoding::Moments)]
    encoding: Encoding,
    /// Width of the kernel of levels, in dB: how much a scan differs from a survey.
    #[arg(long, value_name = "DB", default_value_t = Building::default().bandwidth)]
    bandwidth: f64,
    /// How many levels there are.
    #[arg(long, value_name = "NUMBER", default_value_t = Building::default().levels)]
    levels: u8,
    /// Name of the Rust constant.
    #[arg(long, value_name = "NAME", default_value = "MAP")]
    name: String,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Encoding {
    /// Mean and sigma, in two bytes: what the tracker needs.
    Moments,
    /// The logarithm of a kernel density by level: what the table matcher needs.
    Levels,
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    let survey = SiteSurvey::open(&options.survey)?;
    let lattice = survey.lattice(options.spacing)?;
    let encoding = match options.encoding {
        Encoding::Moments => fingerprint::Encoding::Moments,
        Encoding::Levels => fingerprint::Encoding::Levels,
    };
    let building = Building {
        bandwidth: options.bandwidth,
        levels: options.levels,
        ..Building::default()
    };
    let bytes = survey.radio_map(&lattice, encoding, &building)?;
    if let Err(error) = RadioMap::new(&bytes) {
        bail!("the map that was made is not one: {error}");
    }

    let file = &options.output;
    let is_rust = file.extension().is_some_and(|extension| extension == "rs");
    let written = if is_rust {
        fs::write(file, rust_constant(&options.name, &bytes))
    } else {
        fs::write(file, &bytes)
    };
    written.with_context(|| format!("cannot write {}", file.display()))?;
    println!(
        "{}: {} bytes, {} beacons at {} x {} points",
        file.display(),
        bytes.len(),
        survey.beacons().len(),
        lattice.columns(),
        lattice.rows(),
    );
    if survey.gated() > 0 {
        println!(
            "{} readings left out: no radio measures such strengths",
            survey.gated()
        );
    }
    Ok(())
}
