//! The task `test`: everything that is checked.

use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::{
    book, chapter, constants, cost,
    expected::Expected,
    features, ffi, figures, house, page,
    project::{self, BOARD, cargo, run},
    qemu::Machine,
    reset, setup,
    steps::{self, Step},
    trace,
};

/// The options of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Options {
    /// Take the firmware's figures, and what the portable tests compute, as the expected ones.
    #[arg(long)]
    bless: bool,
    /// Only the checks whose names contain one of these words.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
}

/// The check in which the portable tests compare what they compute with what is expected.
const PORTABLE: &str = "unit, property and portable tests, host";

/// What is built for this computer.
const HOST: &[Step] = &[
    ("format", || run(cargo().args(["fmt", "--all", "--check"]))),
    ("files, functions and words", house::check),
    ("chapters and links of the guide", book::check),
    ("tuned constants of the guide", constants::check),
    ("lints, host", || clippy(&["--workspace", "--all-targets"])),
    ("lints, board", || {
        clippy(&[
            "--target",
            BOARD,
            "--package",
            "foxhunt",
            "--lib",
            "--examples",
            "--test",
            "portable",
        ])
    }),
    (PORTABLE, || {
        run(cargo().args(["test", "--workspace", "--lib", "--bins", "--tests"]))
    }),
    ("documentation tests", || {
        run(cargo().args(["test", "--workspace", "--doc"]))
    }),
    ("every feature, on every target", features::check_each),
    ("documentation", || {
        run(cargo()
            .args(["doc", "--workspace", "--no-deps", "--all-features"])
            .env("RUSTDOCFLAGS", "-D warnings"))
    }),
];

/// What is built for the board and for others: in other directories, so that cargo builds either while the other runs.
const OTHERS: &[Step] = &[
    ("portable tests, emulated board", portable_on_board),
    ("whole drives, board against host", trace::compare),
    ("a reset in the middle of a drive", reset::compare),
    (
        "people in a tunnel, board against host",
        trace::compare_tunnel,
    ),
    ("the library for C", ffi::check),
    ("no panic can happen", || {
        project::firmware("no_panic")
            .map(drop)
            .context("a panic is possible: its handler was linked")
    }),
    ("the page's WebAssembly", page::check),
    ("the chapter about your board", chapter::check),
];

/// Runs every check.
pub fn run_all(options: &Options) -> Result<()> {
    setup::ensure(setup::TEST)?;
    let chosen = |name: &str| steps::is_chosen(name, &options.words);
    let figures: Step = match options.bless {
        true => ("figures of the firmware, rewritten", || {
            let figures = cost::firmware()?;
            Expected::of(&figures)?.write()?;
            figures::check(&figures)
        }),
        false => ("figures of the firmware", || {
            let figures = cost::firmware()?;
            let same = Expected::read()?.compare(&Expected::of(&figures)?);
            all([same, figures::check(&figures)])
        }),
    };
    if options.bless && chosen(PORTABLE) {
        run(cargo()
            .args(["test", "--package", "foxhunt", "--test", "portable"])
            .env("BLESS", "1"))?;
    }
    let host = HOST.iter().filter(|(name, _)| chosen(name)).collect();
    let others = OTHERS.iter().chain([&figures]);
    let others = others.filter(|(name, _)| chosen(name)).collect();
    let lanes: [Vec<&Step>; 2] = [host, others];
    ensure!(
        lanes.iter().any(|lane| !lane.is_empty()),
        "no check has such a name"
    );
    steps::run(&lanes, "test")
}

/// Fails if one of the results does, with what all of them say.
fn all(results: impl IntoIterator<Item = Result<()>>) -> Result<()> {
    let errors = results.into_iter().filter_map(Result::err);
    let errors: Vec<String> = errors.map(|error| format!("{error:#}")).collect();
    ensure!(errors.is_empty(), "{}", errors.join("\n"));
    Ok(())
}

fn clippy(what: &[&str]) -> Result<()> {
    run(cargo()
        .args(["clippy", "--quiet"])
        .args(what)
        .args(["--", "--deny", "warnings"]))
}

/// The same cases as on the host, from the same source.
fn portable_on_board() -> Result<()> {
    let elf = project::executable(&["--release", "--target", BOARD, "--test", "portable"])?;
    Machine::boot(&elf, Duration::from_secs(120))?
        .finish()
        .map(drop)
}
