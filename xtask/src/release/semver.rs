//! That a version does not hide a change of the library's interface: held against the last release.

use std::process::Command;

use anyhow::{Context, Result};

use crate::{
    project::{self, cargo, run},
    setup::Need,
    steps::Skipped,
};

/// Compares the library with the one that has the newest tag of a release, such as `v0.1.0`.
pub fn check() -> Result<()> {
    let Some(tag) = newest()? else {
        let why = "no release has a tag yet, so there is nothing to compare with";
        return Err(Skipped(why.to_owned()).into());
    };
    super::need(&[Need::CargoSemverChecks])?;
    let mut check = cargo();
    check.args(["semver-checks", "--package", "foxhunt", "--all-features"]);
    run(check.args(["--baseline-rev", &tag]))
}

/// The newest tag of a release before this one.
fn newest() -> Result<Option<String>> {
    let mut git = Command::new("git");
    git.current_dir(project::root());
    git.args(["tag", "--list", "v[0-9]*", "--sort=-version:refname"]);
    let output = git.output().context("cannot run git")?;
    let tags = String::from_utf8(output.stdout)?;
    Ok(tags.lines().next().map(str::to_owned))
}
