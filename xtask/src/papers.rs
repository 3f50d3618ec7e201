//! The task `papers`: published experiments, run again and compared with their figures.

use std::path::PathBuf;

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    figures::{self, Figure},
    project,
};

mod aoa;
mod bearings;
mod cost;
mod counted;
mod evolution;
mod fingerprint;
mod firefly;
mod fish;
mod instructions;
mod methods;
mod scalar;
mod statistics;
mod wild;

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
    Aoa(Study),
    /// Its particles refined by a fish school (the same paper), as published and with the posterior kept.
    Fish(Study),
    /// Track the growth model, and locate a transmitter, with fireflies: Du, Li and Jiang (2017).
    Firefly(Study),
    /// Track a model with gamma noise with differential evolution and unscented proposals: Li, Wang and Wang (2011).
    Evolution(Study),
    /// Track a person in a tunnel by radio fingerprints: Cui, Wu, He and Wu (2017), and the tracker, simulated and
    /// measured.
    Fingerprint(Study),
    /// Locate a transmitter by bearings of which some are wild, mirrored or biased: the robust locator, simulated and
    /// measured.
    Bearings(Study),
    /// What each method of these is worth beside the bootstrap filter that costs as much.
    Cost(Study),
}

/// How a study is run.
#[derive(clap::Args)]
pub struct Study {
    /// Runs of every method [default: as many as its figures ask for].
    #[arg(long, value_parser = clap::value_parser!(u32).range(10..))]
    runs: Option<u32>,
    /// Seed of all random numbers: the same seed gives the same tables.
    #[arg(long, default_value_t = 2016)]
    seed: u64,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Study {
    /// Prints the figures, writes them if asked to, and fails if one misses its limit.
    fn conclude(&self, figures: &[Figure]) -> Result<()> {
        figures::print(figures);
        if let Some(file) = &self.json {
            figures::write_json(figures, file)?;
        }
        figures::check(figures)
    }
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    match &options.paper {
        Paper::Aoa(study) => aoa::run(study),
        Paper::Fish(study) => fish::run(study),
        Paper::Firefly(study) => firefly::run(study),
        Paper::Evolution(study) => evolution::run(study),
        Paper::Fingerprint(study) => fingerprint::run(study),
        Paper::Bearings(study) => wild::run(study),
        Paper::Cost(study) => cost::run(study),
    }
}

/// Where a picture is written, without its ending.
fn picture(name: &str) -> PathBuf {
    project::root().join("target/papers").join(name)
}

fn progress(runs: u64, what: impl Into<std::borrow::Cow<'static, str>>) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} runs, {eta} left")?;
    Ok(ProgressBar::new(runs).with_message(what).with_style(style))
}
