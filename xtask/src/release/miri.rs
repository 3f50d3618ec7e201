//! The `unsafe` code of the library for C in an interpreter that finds undefined behaviour. It needs a nightly compiler.

use anyhow::Result;

use crate::{
    project::{self, run},
    setup::{self, Need},
};

/// As wide as the boards are; and on it no crate takes instructions that the interpreter does not know.
const TARGET: &str = "arm-unknown-linux-gnueabi";

/// Runs the tests of the library for C, in which all pointers are, in the interpreter.
pub fn check() -> Result<()> {
    super::need(&[Need::Miri])?;
    let mut miri = setup::nightly();
    run(miri
        .current_dir(project::root().join("ffi"))
        .args(["miri", "test", "--lib", "--target", TARGET]))
}
