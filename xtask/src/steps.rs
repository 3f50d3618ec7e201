//! Checks, in lanes side by side.

use std::{
    error::Error,
    fmt::{self, Display},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Result, ensure};
use console::style;
use indicatif::{MultiProgress, ProgressBar};

/// Why a check could not be made, as the error of one that is no failure for that.
#[derive(Debug)]
pub struct Skipped(pub String);

impl Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for Skipped {}

/// A check, and what it is called while it runs.
pub type Step = (&'static str, fn() -> Result<()>);

/// Whether a name is chosen: by one of some words that it contains, or because there are none.
pub fn is_chosen(name: &str, words: &[String]) -> bool {
    words.is_empty() || words.iter().any(|word| name.contains(word))
}

/// What became of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Passed,
    Skipped,
    Failed,
}

impl From<&Result<()>> for Verdict {
    fn from(result: &Result<()>) -> Self {
        match result {
            Ok(()) => Self::Passed,
            Err(error) if error.is::<Skipped>() => Self::Skipped,
            Err(_) => Self::Failed,
        }
    }
}

/// Runs the steps of each lane one after the other, beside those of the others, and fails if one does; `task` repeats them.
pub fn run(lanes: &[Vec<&Step>], task: &str) -> Result<()> {
    let spinners = MultiProgress::new();
    let lane = |steps: &[&Step]| {
        let verdicts = steps
            .iter()
            .map(|(name, check)| (*name, timed(name, check, task, &spinners)));
        verdicts.collect::<Vec<(&str, Verdict)>>()
    };
    let verdicts: Vec<(&str, Verdict)> = thread::scope(|scope| {
        let lanes = lanes.iter().map(|steps| scope.spawn(|| lane(steps)));
        let lanes: Vec<_> = lanes.collect();
        let joined = lanes.into_iter().map(|lane| lane.join());
        joined
            .flat_map(|lane| lane.expect("a check fails without a panic"))
            .collect()
    });
    let of = |sought| {
        let found = verdicts
            .iter()
            .filter(move |(_, verdict)| *verdict == sought);
        found.map(|(name, _)| *name).collect::<Vec<_>>()
    };
    let [passed, skipped, failed] = [Verdict::Passed, Verdict::Skipped, Verdict::Failed].map(of);
    print!("\n{} passed, {} failed", passed.len(), failed.len());
    match skipped[..] {
        [] => println!(),
        _ => println!(", {} skipped", skipped.len()),
    }
    ensure!(failed.is_empty(), "{}", failed.join("; "));
    Ok(())
}

/// Runs a check under a spinner and prints its verdict, its time, and what it found.
fn timed(name: &str, check: &fn() -> Result<()>, task: &str, spinners: &MultiProgress) -> Verdict {
    let start = Instant::now();
    let spinner = spinners.add(ProgressBar::new_spinner().with_message(name.to_owned()));
    spinner.enable_steady_tick(Duration::from_millis(100));
    let result = check();
    spinner.finish_and_clear();
    let verdict = Verdict::from(&result);
    let word = match verdict {
        Verdict::Passed => style("ok     ").green(),
        Verdict::Skipped => style("skipped").yellow(),
        Verdict::Failed => style("FAILED ").red(),
    };
    spinners.suspend(|| {
        println!("{word} {:6.1} s  {name}", start.elapsed().as_secs_f64());
        if let Err(error) = &result {
            println!("\n{error:#}");
        }
        if verdict == Verdict::Failed {
            println!("to repeat: cargo xtask {task} \"{name}\"\n");
        }
    });
    verdict
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    #[test]
    fn what_was_skipped_is_no_failure() {
        let skipped: &Step = &("a", || Err(Skipped("there is none".to_owned()).into()));
        let passed: &Step = &("b", || Ok(()));
        assert!(run(&[vec![skipped], vec![passed]], "test").is_ok());
        let failed: &Step = &("c", || Err(std::fmt::Error).context("it failed"));
        assert!(run(&[vec![skipped, failed], vec![passed]], "test").is_err());
    }
}
