//! `foxhunt init`: a settings file to begin with.

use std::{fs::OpenOptions, io::Write, path::PathBuf};

use anyhow::{Context, Result};
use serde_json::json;

use crate::{screen, settings};

/// Write a settings file with comments, for `foxhunt live`
#[derive(clap::Args)]
#[command(after_help = "Example:\n  foxhunt init\n  foxhunt live foxhunt.toml")]
pub struct Options {
    /// The file; one that is there is kept.
    #[arg(default_value = "foxhunt.toml")]
    file: PathBuf,
    /// Overwrite a file that is there.
    #[arg(long)]
    force: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let name = options.file.display();
    let mut open = OpenOptions::new();
    open.write(true);
    if options.force {
        open.create(true).truncate(true);
    } else {
        open.create_new(true);
    }
    let mut file = open
        .open(&options.file)
        .with_context(|| format!("cannot write {name}; --force overwrites a file"))?;
    file.write_all(settings::EXAMPLE.as_bytes())
        .with_context(|| format!("cannot write {name}"))?;
    if options.json {
        screen::json(&json!({"file": options.file}))
    } else {
        screen::line(format_args!(
            "{name}: say there what comes in, then run `foxhunt live {name}`"
        ))
    }
}
