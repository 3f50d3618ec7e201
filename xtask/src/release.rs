//! The task `release`: what is checked before a release, and takes too long for every change.

use std::process::Command;

use anyhow::{Result, ensure};

mod coverage;
mod miri;
mod semver;

use crate::{
    boards, features, fuzz, load, machines,
    project::{cargo, run},
    replay, restarts,
    setup::{self, Need},
    steps::{self, Skipped, Step},
    trace,
};

/// The options of `cargo xtask release`.
#[derive(clap::Args)]
pub struct Options {
    /// Only the checks whose names contain one of these words.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
}

const STEPS: &[Step] = &[
    ("the package by itself", || {
        run(cargo().args(["package", "--package", "foxhunt", "--all-features"]))
    }),
    (
        "no change of the interface that the version hides",
        semver::check,
    ),
    ("licences and sources of dependencies", || {
        setup::ensure(&[Need::CargoDeny])?;
        run(deny().args(["check", "licenses", "bans", "sources"]))
    }),
    ("known faults of dependencies", || {
        setup::ensure(&[Need::CargoDeny])?;
        if run(deny().args(["fetch", "db"])).is_err() {
            let why = "the database of advisories is on the internet, and cannot be had here";
            return Err(Skipped(why.to_owned()).into());
        }
        run(deny().args(["check", "advisories"]))
    }),
    ("no undefined behaviour of the library for C", miri::check),
    (
        "every combination of features, on every target",
        features::check_every_combination,
    ),
    ("how much of the library its tests run", coverage::print),
    ("tests that take too long for every change", || {
        run(cargo().args(["test", "--workspace", "--tests", "--", "--ignored"]))
    }),
    ("all whole drives, board against host", trace::compare_all),
    ("the same bits on every machine", machines::check_all),
    ("random input over a line", fuzz::check),
    ("the load of many gateways on a broker", load::check),
    ("ten minutes of random restarts", restarts::check),
    ("firmwares of real boards", boards::check),
    ("the same drive through every build", replay::run),
];

fn deny() -> Command {
    let mut deny = cargo();
    deny.args(["deny", "--workspace", "--all-features"]);
    deny
}

/// Installs what a check needs, or skips it.
fn need(needs: &[Need]) -> Result<()> {
    setup::ensure(needs).map_err(|error| Skipped(format!("{error:#}")).into())
}

/// Runs every check.
pub fn run_all(options: &Options) -> Result<()> {
    let chosen = |name: &str| steps::is_chosen(name, &options.words);
    let steps: Vec<&Step> = STEPS.iter().filter(|(name, _)| chosen(name)).collect();
    ensure!(!steps.is_empty(), "no check has such a name");
    steps::run(&[steps], "release")
}
