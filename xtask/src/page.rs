//! The task `page`: the WebAssembly of the page, built from the code and kept beside its other files.

use std::{env, fs, path::PathBuf};

use anyhow::{Context, Result, ensure};

use crate::{
    project::{self, BROWSER, cargo, run},
    setup,
};

/// The options of `cargo xtask page`.
#[derive(clap::Args)]
pub struct Options {
    /// Compare with what is checked in, instead of writing it.
    #[arg(long)]
    check: bool,
}

/// Builds the code of the page, and writes or compares it.
pub fn run_task(options: &Options) -> Result<()> {
    setup::ensure(setup::PAGE)?;
    if options.check {
        return check();
    }
    let bytes = build()?;
    fs::write(file(), &bytes).with_context(|| format!("cannot write {}", file().display()))?;
    fs::write(compiler_file(), project::rustc(&["--version"])? + "\n")?;
    println!("{}: {} bytes", file().display(), bytes.len());
    Ok(())
}

/// Fails unless the checked-in file is what the code gives. Another compiler gives other bytes: then there is nothing to
/// compare, and the page's own test says whether it computes the same.
pub fn check() -> Result<()> {
    let compiler = project::rustc(&["--version"])?;
    let kept = fs::read_to_string(compiler_file())?;
    if kept.trim() != compiler {
        println!(
            "the page was built by {}, this is {compiler}: not compared",
            kept.trim()
        );
        return Ok(());
    }
    ensure!(
        build()? == fs::read(file())?,
        "{} is not what the code gives: cargo xtask page",
        file().display()
    );
    Ok(())
}

/// The bytes that the code gives, the same in every directory.
fn build() -> Result<Vec<u8>> {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(env::home_dir()?.join(".cargo")));
    let home = home.context("there is no home directory")?;
    let mut flags = vec![format!(
        "--remap-path-prefix={}=foxhunt",
        project::root().display()
    )];
    // What panics name lies in a folder of the registry, whose name says where that is.
    let sources = home.join("registry/src");
    for registry in fs::read_dir(&sources).into_iter().flatten().flatten() {
        let from = registry.path();
        flags.push(format!("--remap-path-prefix={}=crates", from.display()));
    }
    let mut build = cargo();
    build
        .args(["build", "--locked", "--package", "foxhunt-wasm"])
        .args(["--target", BROWSER, "--profile", "page"])
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    run(&mut build)?;
    let built = project::target_directory()?
        .join(BROWSER)
        .join("page/foxhunt_wasm.wasm");
    fs::read(&built).with_context(|| format!("cannot read {}", built.display()))
}

fn file() -> PathBuf {
    project::root().join("page/static/foxhunt.wasm")
}

fn compiler_file() -> PathBuf {
    project::root().join("page/wasm/compiler.txt")
}
