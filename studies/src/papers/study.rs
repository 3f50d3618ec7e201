//! How an experiment is run.

use std::{borrow::Cow, path::PathBuf};

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};

use super::instructions::Instructions;

/// How an experiment is run.
pub struct Study {
    /// Runs of every method, unless as many as its figures ask for.
    pub runs: Option<u32>,
    /// Seed of all random numbers: the same seed gives the same tables.
    pub seed: u64,
    /// The directory of the measured data, if they are at hand.
    pub data: Option<PathBuf>,
    /// The directory of the pictures.
    pub pictures: PathBuf,
    /// Runs the firmware `studies` on the board for the study of this name, and returns what it printed.
    pub board: fn(&str) -> Result<String>,
}

impl Study {
    /// What a run of each method of the study of this name takes on the board.
    pub(super) fn instructions(&self, name: &str) -> Result<Instructions> {
        Instructions::read(&(self.board)(name)?)
    }

    /// The directory of a measured data set; if it is missing, says so of these things, which need it.
    pub(super) fn data(&self, set: &str, things: &str) -> Option<PathBuf> {
        if self.data.is_none() {
            println!(
                "the measured {things}, and their figures, are skipped: FOXHUNT_DATA does not name the directory of the \
                 measured data\n"
            );
        }
        Some(self.data.as_ref()?.join(set))
    }

    /// Writes a picture.
    pub(super) fn save(&self, picture: &str, name: &str) -> Result<()> {
        let stem = self.pictures.join(name);
        foxhunt_host::picture::save(picture, &stem)?;
        println!("picture: {}", stem.with_extension("svg").display());
        Ok(())
    }
}

/// A bar that shows how many of the runs are done.
pub(super) fn progress(runs: u64, what: impl Into<Cow<'static, str>>) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} runs, {eta} left")?;
    Ok(ProgressBar::new(runs).with_message(what).with_style(style))
}
