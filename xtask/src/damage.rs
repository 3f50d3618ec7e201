//! The task `damage`: how often a vehicle's gateway believes a position that its receiver never had.

use std::{env, path::PathBuf};

use anyhow::{Context, Result};
use foxhunt_host::damage::{LIMIT, Logs, Outcome};

use crate::figures;

/// The options of `cargo xtask damage`.
#[derive(clap::Args)]
pub struct Options {
    /// How many sentences, of which one in ten is damaged.
    #[arg(long, default_value_t = 2_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    sentences: u64,
    /// The seed of the damage.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the figures as JSON, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Runs the task; fails if too many wrong positions are believed, or two in a row.
pub fn run(options: &Options) -> Result<()> {
    let data = env::var_os("FOXHUNT_DATA")
        .context("FOXHUNT_DATA does not name the directory of the measured data")?;
    let logs = Logs::read(data.as_ref())?;
    let study = |confirmed| Outcome::of(&logs, options.sentences, options.seed, confirmed);
    let mut found = study(true).figures("damage");
    for figure in &mut found {
        match figure.name.as_str() {
            "damage.wrong" => figure.limit = Some(LIMIT),
            "damage.in_a_row" => figure.limit = Some(1.0),
            _ => {}
        }
    }
    found.extend(study(false).figures("damage.at_once"));
    figures::print(&found);
    println!("at_once: where no position waits for another that agrees");
    if let Some(file) = &options.json {
        figures::write_json(&found, file)?;
    }
    figures::check(&found)
}
