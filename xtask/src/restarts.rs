//! The task `restarts`: sources and a broker are killed and begun again at random while `foxhunt live` runs.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use serde_json::Value;

use crate::{
    project::{self, cargo},
    setup::{self, Need},
};

/// The options of `cargo xtask restarts`.
#[derive(clap::Args)]
pub struct Options {
    /// For so long.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=600))]
    minutes: u64,
    /// The seed of what happens.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[Need::Mosquitto, Need::Gpsd])?;
    let file = project::target_directory()?.join("restarts.json");
    // A run that is skipped or fails leaves none of another.
    let _ = fs::remove_file(&file);
    project::run(
        cargo()
            .args(["test", "--package", "foxhunt-cli", "--test", "tool"])
            .args(["what_was_acknowledged_arrives"])
            .env(
                "FOXHUNT_RESTARTS_SECONDS",
                (60 * options.minutes).to_string(),
            )
            .env("FOXHUNT_RESTARTS_SEED", options.seed.to_string())
            .env("FOXHUNT_RESTARTS_JSON", &file),
    )?;
    let text = fs::read_to_string(&file).context("the test was skipped")?;
    let figures: Value = serde_json::from_str(&text)?;
    let mut table = Table::new();
    table
        .load_style(ASCII_MARKDOWN)
        .set_header(["what", "figures"]);
    for (what, counts) in figures.as_object().into_iter().flatten() {
        let counts = counts.as_object().into_iter().flatten();
        let counts: Vec<String> = counts
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        table.add_row([what.clone(), counts.join(", ")]);
    }
    println!(
        "{} minutes of restarts, seed {}\n{table}",
        options.minutes, options.seed
    );
    match &options.json {
        Some(file) => {
            fs::write(file, text).with_context(|| format!("cannot write {}", file.display()))
        }
        None => Ok(()),
    }
}

/// As a check: ten minutes.
pub fn check() -> Result<()> {
    run(&Options {
        minutes: 10,
        seed: 1,
        json: None,
    })
}
