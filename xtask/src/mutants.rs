//! The task `mutants`: how many small faults, put into the library one at a time, its tests notice.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

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
    /// How many faults are tried, about: one in so many of all.
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

/// Faults that change nothing that a test could notice, each with the reason.
const EQUIVALENT: &str = "xtask/expected/mutants.toml";

/// What the names of the tests contain that take longest: more than a second without optimisation.
const SLOW: &[&str] = &[
    "advice::tests::who_drives",
    "clean::tests::common_errors",
    "clean::tests::greedy_refinements",
    "clean::tests::refinements_that_keep",
    "geodesy::tests::the_error",
    "manoeuvring::tests",
    "multi::tests::alternatives",
    "multi::tests::anything",
    "multi::tests::one_source",
    "multi::tests::outliers",
    "multi::tests::stops",
    "multi::tests::the_track_of",
    "multi::tests::two_sources",
    "proposal::tests",
    "random::tests::uniforms_are",
    "refine::neighbours::tests",
    "refine::tests",
    "resample::tests::expected_copies",
    "robust::tests::a_small_buffer",
    "robust::tests::a_wrong_start",
    "robust::tests::alternatives",
    "robust::tests::bearings_are_told_apart",
    "robust::tests::biases",
    "robust::tests::position",
    "robust::tests::retract",
    "robust::tests::search",
    "snapshot::tests::so_does",
];

/// Some of the library's tests. A fault that some notice is not tried with the others.
struct Stage {
    name: &'static str,
    /// The level of optimisation: the best for building and running once.
    level: &'static str,
    /// What cargo builds and runs.
    targets: &'static [&'static str],
    /// Which of its tests are run.
    tests: fn() -> Vec<&'static str>,
    /// The files of which they can notice nothing.
    without: &'static [&'static str],
}

/// Together they are all of the library's tests, the quickest first.
const STAGES: &[Stage] = &[
    Stage {
        name: "portable",
        level: "0",
        targets: &["--test=portable"],
        tests: Vec::new,
        without: &[],
    },
    Stage {
        name: "quick",
        level: "0",
        targets: &[
            "--lib",
            "--test=empty",
            "--test=kraken",
            "--test=nmea",
            "--test=serde",
        ],
        tests: || SLOW.iter().flat_map(|word| ["--skip", word]).collect(),
        without: &[],
    },
    Stage {
        name: "gateway",
        level: "1",
        targets: &["--test=gateway"],
        tests: Vec::new,
        without: &["src/fingerprint/"],
    },
    Stage {
        name: "slow",
        level: "1",
        targets: &["--lib"],
        tests: || SLOW.to_vec(),
        without: &["src/fingerprint/", "src/gateway/"],
    },
];

impl Stage {
    fn is_blind_to(&self, fault: &str) -> bool {
        self.without.iter().any(|folder| fault.starts_with(folder))
    }
}

/// A fault that can be put into the library.
#[derive(Deserialize)]
struct Fault {
    /// Where it is, and what it does there.
    name: String,
    /// The fault as a change of its file.
    diff: String,
}

impl Fault {
    /// The fault without its place in the file, and the line that it makes.
    fn identity(&self) -> (String, String) {
        let (file, what) = self.name.split_once(".rs:").unwrap_or(("", &self.name));
        let what = what.split_once(": ").map_or(what, |(_, what)| what);
        let added = self
            .diff
            .lines()
            .skip(2)
            .find_map(|line| line.strip_prefix('+'));
        let line = added.unwrap_or_default();
        let line = line.replace(" /* ~ changed by cargo-mutants ~ */", "");
        (format!("{file}.rs: {what}"), line.trim().to_owned())
    }
}

/// The file of equivalent faults.
#[derive(Deserialize)]
struct Equivalents {
    equivalent: Vec<Equivalent>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Equivalent {
    fault: String,
    line: String,
    #[expect(dead_code, reason = "it is for readers, and must be there")]
    why: String,
}

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

/// How many faults were noticed, and which were not.
#[derive(Default)]
struct Judgement {
    noticed: usize,
    missed: BTreeSet<String>,
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[Need::CargoMutants])?;
    let folder = project::target_directory()?.join("mutants");
    let faults = faults()?;
    let equivalent = equivalent(&faults)?;
    let every = faults.len().div_ceil(options.sample as usize);
    let sample = faults.iter().skip(options.seed as usize % every);
    let sample = sample.step_by(every).map(|fault| fault.name.clone());
    let (named, mut left): (BTreeSet<String>, BTreeSet<String>) =
        sample.partition(|name| equivalent.contains(name));
    let mut noticed = 0;
    for stage in STAGES {
        let (mut rest, tried): (BTreeSet<String>, BTreeSet<String>) =
            left.into_iter().partition(|name| stage.is_blind_to(name));
        if !tried.is_empty() {
            let judgement = try_out(stage, &faults, &tried, &folder.join(stage.name))?;
            noticed += judgement.noticed;
            rest.extend(judgement.missed);
        }
        left = rest;
    }
    for name in &left {
        println!("not noticed: {name}");
    }
    let figures = summary(noticed, left.len(), named.len())?;
    figures::print(&figures);
    if let Some(file) = &options.json {
        figures::write_json(&figures, file)?;
    }
    figures::check(&figures)
}

/// Every fault.
fn faults() -> Result<Vec<Fault>> {
    let mut list = project::cargo();
    let list = list.args(["mutants", "--list", "--json", "--diff"]);
    let output = list.args(["--package", "foxhunt"]).output();
    let output = output.context("cannot run cargo mutants")?;
    let faults: Vec<Fault> =
        serde_json::from_slice(&output.stdout).context("cargo mutants does not list the faults")?;
    ensure!(!faults.is_empty(), "cargo mutants finds nothing to change");
    Ok(faults)
}

/// The names of the equivalent faults. One that is no fault any more must leave the file.
fn equivalent(faults: &[Fault]) -> Result<BTreeSet<String>> {
    let text = fs::read_to_string(project::root().join(EQUIVALENT))
        .with_context(|| format!("cannot read {EQUIVALENT}"))?;
    let file: Equivalents = toml::from_str(&text).context(EQUIVALENT)?;
    let mut names = BTreeSet::new();
    for Equivalent { fault, line, .. } in file.equivalent {
        let identity = (fault, line);
        let same = faults.iter().filter(|fault| fault.identity() == identity);
        let before = names.len();
        names.extend(same.map(|fault| fault.name.clone()));
        ensure!(
            names.len() > before,
            "{EQUIVALENT}: there is no fault {identity:?}"
        );
    }
    Ok(names)
}

/// Tries some faults, one at a time, with the tests of a stage.
fn try_out(
    stage: &Stage,
    all: &[Fault],
    tried: &BTreeSet<String>,
    folder: &Path,
) -> Result<Judgement> {
    println!("{}: {} faults", stage.name, tried.len());
    // cargo-mutants cannot be told which ones to try, but which ones were noticed before.
    let written = folder.join("mutants.out");
    fs::create_dir_all(&written)?;
    let others = all.iter().map(|fault| fault.name.as_str());
    let others: Vec<&str> = others.filter(|name| !tried.contains(*name)).collect();
    for file in ["caught.txt", "unviable.txt"] {
        fs::write(written.join(file), "")?;
    }
    fs::write(written.join("previously_caught.txt"), others.join("\n"))?;

    // It fails if a fault goes unnoticed: what it has written says which.
    let _ = command(stage, folder)
        .status()
        .context("cannot run cargo mutants")?;
    let file = written.join("outcomes.json");
    let text = fs::read_to_string(&file)
        .with_context(|| format!("cargo mutants has not written {}", file.display()))?;
    let found: Found = serde_json::from_str(&text)?;
    let judgement = judge(&found)?;
    // The first is of no fault.
    let ended = found.outcomes.len() == tried.len() + 1;
    ensure!(ended, "cargo mutants did not end");
    Ok(judgement)
}

/// How cargo-mutants is called for a stage. What it builds once for all faults, and for the next sample, is beside its
/// results.
fn command(stage: &Stage, folder: &Path) -> Command {
    let mut command = project::cargo();
    command
        .env("CARGO_TARGET_DIR", folder.with_file_name("target"))
        .env("CARGO_PROFILE_MUTANTS_OPT_LEVEL", stage.level)
        .args(["mutants", "--package", "foxhunt", "--iterate", "--output"])
        .arg(folder)
        .args(["--profile", "mutants", "--features", "gateway,serde"])
        .args(stage.targets.iter().map(|target| format!("-C{target}")))
        .args(["--", "--"])
        .args((stage.tests)());
    command
}

/// Counts what was noticed, and names what was not. What does not compile is no fault.
fn judge(found: &Found) -> Result<Judgement> {
    let mut judgement = Judgement::default();
    for outcome in &found.outcomes {
        match (&outcome.scenario, outcome.summary.as_str()) {
            (Scenario::Baseline, summary) => {
                ensure!(summary == "Success", "the tests fail without a fault");
            }
            (Scenario::Mutant { .. }, "CaughtMutant" | "Timeout") => judgement.noticed += 1,
            (Scenario::Mutant { name }, "MissedMutant") => {
                judgement.missed.insert(name.clone());
            }
            (Scenario::Mutant { .. }, _) => {}
        }
    }
    Ok(judgement)
}

/// The figures of a sample.
fn summary(noticed: usize, missed: usize, equivalent: usize) -> Result<Vec<Figure>> {
    let (viable, missed) = ((noticed + missed) as f64, missed as f64);
    ensure!(viable > 0.0, "none of the faults compiles");
    let [least, most] = wilson(missed, viable);
    Ok(vec![
        Figure::new("mutants.equivalent", equivalent as f64, ""),
        Figure::new("mutants.viable", viable, "others"),
        Figure::new("mutants.missed", missed / viable, "of viable").at_most(MISSED),
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
    use cargo_metadata::TargetKind;

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
        let judgement = judge(&serde_json::from_str(json).unwrap()).unwrap();
        assert_eq!(judgement.noticed, 2);
        assert!(judgement.missed.iter().eq(["b"]));
        let none = r#"{"outcomes": [{"scenario": "Baseline", "summary": "Failure"}]}"#;
        assert!(judge(&serde_json::from_str(none).unwrap()).is_err());
    }

    #[test]
    fn more_than_one_in_twenty_is_too_much() {
        assert!(summary(57, 3, 1).unwrap()[2].ok());
        assert!(!summary(56, 4, 0).unwrap()[2].ok());
        assert!(summary(0, 0, 7).is_err());
    }

    #[test]
    fn a_fault_keeps_its_identity_when_lines_move() {
        let fault = |line: u32| Fault {
            name: format!("src/a.rs:{line}:9: replace < with <= in f"),
            diff: format!(
                "--- src/a.rs\n+++ replace\n@@ -{line} @@\n-    x < y\n+    x <= /* ~ changed by cargo-mutants ~ */ y\n"
            ),
        };
        let identity = fault(3).identity();
        assert_eq!(identity.0, "src/a.rs: replace < with <= in f");
        assert_eq!(identity.1, "x <= y");
        assert_eq!(identity, fault(70).identity());
    }

    /// Otherwise a test would be run by no stage.
    #[test]
    fn the_stages_are_all_tests() {
        let [_, quick, _, slow] = STAGES else {
            panic!("there are other stages")
        };
        let skipped = (quick.tests)();
        let skipped = skipped.chunks(2).map(|pair| pair[1]);
        assert!(skipped.eq((slow.tests)()));
        let metadata = project::metadata().unwrap();
        for target in &metadata.root_package().unwrap().targets {
            let argument = match target.kind[..] {
                [TargetKind::Lib] => "--lib".to_owned(),
                [TargetKind::Test] => format!("--test={}", target.name),
                _ => continue,
            };
            let mut targets = STAGES.iter().flat_map(|stage| stage.targets);
            assert!(targets.any(|target| *target == argument), "{argument}");
        }
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
