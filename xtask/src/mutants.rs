//! The task `mutants`: how many small faults, put into the library one at a time, its tests notice.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result, ensure};
use foxhunt_host::figures::Figure;
use serde::Deserialize;

use crate::{
    figures, project,
    setup::{self, Need},
};

/// The options of `cargo xtask mutants`.
#[derive(clap::Args)]
pub struct Options {
    /// How many faults are tried, about: one in so many of all. Each takes some minutes.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..))]
    sample: u32,
    /// Which of them is the first: another seed tries others.
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The largest part of the faults that may go unnoticed.
const MISSED: f64 = 0.05;

/// What cargo-mutants found.
#[derive(Deserialize)]
struct Found {
    outcomes: Vec<Outcome>,
}

#[derive(Deserialize)]
struct Outcome {
    scenario: Scenario,
    summary: String,
}

#[derive(Deserialize)]
enum Scenario {
    Baseline,
    Mutant { name: String },
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[Need::CargoMutants])?;
    let folder = project::target_directory()?.join("mutants");
    fs::create_dir_all(&folder)?;
    let shards = count()?.div_ceil(options.sample);
    let mut test = project::cargo();
    test.args([
        "mutants",
        "--package",
        "foxhunt",
        "--sharding",
        "round-robin",
    ]);
    test.args(["--shard", &format!("{}/{shards}", options.seed % shards)]);
    test.args(["--profile", "mutants", "--features", "gateway", "--output"]);
    test.arg(&folder)
        .args(["--", "--lib", "--test", "portable"]);
    // It fails if a fault goes unnoticed: what it has written says which.
    let _ = test.status().context("cannot run cargo mutants")?;

    let file = folder.join("mutants.out/outcomes.json");
    let text = fs::read_to_string(&file)
        .with_context(|| format!("cargo mutants has not written {}", file.display()))?;
    let figures = judge(&serde_json::from_str(&text)?)?;
    figures::print(&figures);
    if let Some(file) = &options.json {
        figures::write_json(&figures, file)?;
    }
    figures::check(&figures)
}

/// How many faults there are.
fn count() -> Result<u32> {
    let mut list = project::cargo();
    let list = list.args(["mutants", "--list", "--package", "foxhunt"]);
    let output = list.output().context("cannot run cargo mutants")?;
    let names = output.stdout.split(|byte| *byte == b'\n');
    let count = names.filter(|name| !name.is_empty()).count();
    ensure!(count > 0, "cargo mutants finds nothing to change");
    Ok(count.try_into()?)
}

/// Counts what was noticed, and names what was not. What does not compile is no fault.
fn judge(found: &Found) -> Result<Vec<Figure>> {
    let mut missed = Vec::new();
    let mut noticed = 0_u32;
    for outcome in &found.outcomes {
        match (&outcome.scenario, outcome.summary.as_str()) {
            (Scenario::Baseline, summary) => {
                ensure!(summary == "Success", "the tests fail without a fault");
            }
            (Scenario::Mutant { .. }, "CaughtMutant" | "Timeout") => noticed += 1,
            (Scenario::Mutant { name }, "MissedMutant") => missed.push(name),
            (Scenario::Mutant { .. }, _) => {}
        }
    }
    for name in &missed {
        println!("not noticed: {name}");
    }
    let all = f64::from(noticed) + missed.len() as f64;
    ensure!(all > 0.0, "none of the faults compiles");
    let [least, most] = wilson(missed.len() as f64, all);
    Ok(vec![
        Figure::new("mutants.viable", all, ""),
        Figure::new("mutants.missed", missed.len() as f64 / all, "of viable").at_most(MISSED),
        Figure::new("mutants.missed.least", least, "of viable, 95 %"),
        Figure::new("mutants.missed.most", most, "of viable, 95 %"),
    ])
}

/// The 95 % interval of a rate by so many of all (Wilson 1927).
fn wilson(some: f64, all: f64) -> [f64; 2] {
    const Z: f64 = 1.959_964;
    let (rate, square) = (some / all, Z * Z);
    let middle = rate + square / (2.0 * all);
    let half = Z * (rate * (1.0 - rate) / all + square / (4.0 * all * all)).sqrt();
    let scale = 1.0 + square / all;
    [(middle - half) / scale, (middle + half) / scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_compile_does_not_count() {
        let json = r#"{"outcomes": [
            {"scenario": "Baseline", "summary": "Success"},
            {"scenario": {"Mutant": {"name": "a"}}, "summary": "CaughtMutant"},
            {"scenario": {"Mutant": {"name": "b"}}, "summary": "MissedMutant"},
            {"scenario": {"Mutant": {"name": "c"}}, "summary": "Unviable"},
            {"scenario": {"Mutant": {"name": "d"}}, "summary": "Timeout"}
        ]}"#;
        let figures = judge(&serde_json::from_str(json).unwrap()).unwrap();
        assert_eq!(figures[0].value, 3.0);
        assert_eq!(figures[1].value, 1.0 / 3.0);
        assert!(!figures[1].ok());
        let none = r#"{"outcomes": [{"scenario": "Baseline", "summary": "Failure"}]}"#;
        assert!(judge(&serde_json::from_str(none).unwrap()).is_err());
    }

    /// As tabulated for 2 of 30.
    #[test]
    fn the_interval_is_that_of_wilson() {
        let [least, most] = wilson(2.0, 30.0);
        assert!(
            (least - 0.0185).abs() < 5e-4 && (most - 0.2132).abs() < 5e-4,
            "{least} {most}"
        );
    }
}
