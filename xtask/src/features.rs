//! Whether the library compiles for every target with whichever of its features are chosen. What is built from it is built by
//! other checks.

use anyhow::{Context, Result};

use crate::project::{self, BARE_METAL, BOARD, cargo, run};

/// With none, with all, and for the board with each of them alone.
pub fn check_each() -> Result<()> {
    check(|target, chosen, all| chosen == 0 || chosen == all || is_one_for_board(target, chosen))
}

/// With every combination of them.
pub fn check_every_combination() -> Result<()> {
    check(|_, _, _| true)
}

fn is_one_for_board(target: Option<&str>, chosen: u32) -> bool {
    target == Some(BOARD) && chosen.is_power_of_two()
}

/// Checks the types of the library alone, for those targets and sets of features that are wanted. The host has no name.
fn check(is_wanted: fn(Option<&str>, u32, u32) -> bool) -> Result<()> {
    let metadata = project::metadata()?;
    let package = metadata
        .root_package()
        .context("the repository's root is a package")?;
    let features: Vec<&str> = package
        .features
        .keys()
        .map(String::as_str)
        .filter(|name| *name != "default")
        .collect();
    let all = (1_u32 << features.len()) - 1;
    for target in BARE_METAL.map(Some).into_iter().chain([None]) {
        for chosen in (0..=all).filter(|chosen| is_wanted(target, *chosen, all)) {
            let names = features.iter().enumerate();
            let names = names.filter(|(bit, _)| chosen >> bit & 1 == 1);
            let names: Vec<&str> = names.map(|(_, name)| *name).collect();
            let mut check = cargo();
            check.args(["check", "--quiet", "--package", "foxhunt", "--lib"]);
            check.args(["--no-default-features", "--features", &names.join(",")]);
            if let Some(target) = target {
                check.args(["--target", target]);
            }
            run(&mut check)?;
        }
    }
    Ok(())
}
