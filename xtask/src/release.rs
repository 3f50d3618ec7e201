//! The task `release`: what is checked before a release, and takes too long for every change.

use anyhow::{Result, ensure};

use crate::{
    boards, load, machines,
    project::{cargo, run},
    replay, restarts,
    setup::{self, Need},
    steps::{self, Step},
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
    ("licences and sources of dependencies", || {
        setup::ensure(&[Need::CargoDeny])?;
        let mut deny = cargo();
        deny.args(["deny", "--workspace", "--all-features", "check"]);
        run(deny.args(["licenses", "bans", "sources"]))
    }),
    ("the same bits on every machine", machines::check_all),
    ("the load of many gateways on a broker", load::check),
    ("ten minutes of random restarts", restarts::check),
    ("firmwares of real boards", boards::check),
    ("the same drive through every build", replay::run),
];

/// Runs every check.
pub fn run_all(options: &Options) -> Result<()> {
    let chosen = |name: &str| steps::is_chosen(name, &options.words);
    let steps: Vec<&Step> = STEPS.iter().filter(|(name, _)| chosen(name)).collect();
    ensure!(!steps.is_empty(), "no check has such a name");
    steps::run(&steps, "release")
}
