//! Checks, one after the other.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use console::style;
use indicatif::ProgressBar;

/// A check, and what it is called while it runs.
pub type Step = (&'static str, fn() -> Result<()>);

/// Whether a name is chosen: by one of some words that it contains, or because there are none.
pub fn is_chosen(name: &str, words: &[String]) -> bool {
    words.is_empty() || words.iter().any(|word| name.contains(word))
}

/// Runs all, and fails if one does; `task` repeats them.
pub fn run(steps: &[&Step], task: &str) -> Result<()> {
    let failed = steps
        .iter()
        .filter(|(name, check)| timed(name, check, task).is_err());
    let failed: Vec<&str> = failed.map(|(name, _)| *name).collect();
    let passed = steps.len() - failed.len();
    println!("\n{passed} passed, {} failed", failed.len());
    ensure!(failed.is_empty(), "{}", failed.join("; "));
    Ok(())
}

/// Runs a check under a spinner and prints its verdict, its time, and what it found.
fn timed(name: &str, check: &fn() -> Result<()>, task: &str) -> Result<()> {
    let start = Instant::now();
    let spinner = ProgressBar::new_spinner().with_message(name.to_owned());
    spinner.enable_steady_tick(Duration::from_millis(100));
    let result = check();
    spinner.finish_and_clear();
    let verdict = if result.is_ok() {
        style("ok    ").green()
    } else {
        style("FAILED").red()
    };
    println!("{verdict} {:6.1} s  {name}", start.elapsed().as_secs_f64());
    if let Err(error) = &result {
        println!("\n{error:#}\nto repeat: cargo xtask {task} \"{name}\"\n");
    }
    result
}
