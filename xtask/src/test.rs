//! The task `test`: everything that is checked, in order, up to the first failure.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use console::style;
use indicatif::ProgressBar;

use crate::{
    cost,
    expected::Expected,
    fuzz,
    project::{self, BARE_METAL, BOARD, cargo, run},
    qemu::Machine,
    reset, setup, trace,
};

/// The options of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Options {
    /// Take the firmware's figures, and what the portable tests compute, as the expected ones.
    #[arg(long)]
    bless: bool,
}

/// A check, and what it is called while it runs.
type Step = (&'static str, fn() -> Result<()>);

const STEPS: &[Step] = &[
    ("format", || run(cargo().args(["fmt", "--all", "--check"]))),
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
    ("unit, property and portable tests, host", || {
        run(cargo().args(["test", "--workspace", "--lib", "--bins", "--tests"]))
    }),
    ("documentation tests", || {
        run(cargo().args(["test", "--workspace", "--doc"]))
    }),
    ("portable tests, emulated board", portable_on_board),
    ("whole drives, board against host", trace::compare),
    ("a reset in the middle of a drive", reset::compare),
    (
        "people in a tunnel, board against host",
        trace::compare_tunnel,
    ),
    ("random input over a line", fuzz::check),
    ("no panic can happen", || {
        project::firmware("no_panic")
            .map(drop)
            .context("a panic is possible: its handler was linked")
    }),
    ("every combination of features, on every target", features),
    ("documentation", || {
        run(cargo()
            .args(["doc", "--workspace", "--no-deps", "--all-features"])
            .env("RUSTDOCFLAGS", "-D warnings"))
    }),
];

/// Runs every check.
pub fn run_all(options: &Options) -> Result<()> {
    setup::ensure(setup::TEST)?;
    if options.bless {
        run(cargo()
            .args(["test", "--package", "foxhunt", "--test", "portable"])
            .env("BLESS", "1"))?;
    }
    let figures: Step = match options.bless {
        true => ("figures of the firmware, rewritten", || figures()?.write()),
        false => ("figures of the firmware", || {
            Expected::read()?.compare(&figures()?)
        }),
    };
    for (passed, (name, check)) in STEPS.iter().chain([&figures]).enumerate() {
        if let Err(error) = timed(name, check) {
            println!("\n{error:#}\n\n{passed} passed, 1 failed");
            bail!("{name}");
        }
    }
    println!("\n{} passed, 0 failed", STEPS.len() + 1);
    Ok(())
}

/// Runs a check under a spinner and prints its verdict and its time.
fn timed(name: &str, check: &fn() -> Result<()>) -> Result<()> {
    let start = Instant::now();
    let spinner = ProgressBar::new_spinner().with_message(name.to_owned());
    spinner.enable_steady_tick(Duration::from_millis(100));
    let result = check();
    spinner.finish_and_clear();
    let verdict = if result.is_ok() {
        style("ok    ").green()
    } else {
        style("FAILED").red()
    };
    println!("{verdict} {:6.1} s  {name}", start.elapsed().as_secs_f64());
    result
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

/// Compiles the library alone with every subset of its features, for every target.
fn features() -> Result<()> {
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
    for target in BARE_METAL.map(Some).into_iter().chain([None]) {
        for subset in 0..1_u32 << features.len() {
            let chosen = features
                .iter()
                .enumerate()
                .filter(|(bit, _)| subset >> bit & 1 == 1);
            let chosen: Vec<&str> = chosen.map(|(_, name)| *name).collect();
            let mut build = cargo();
            build.args(["build", "--quiet", "--package", "foxhunt", "--lib"]);
            build.args(["--no-default-features", "--features", &chosen.join(",")]);
            if let Some(target) = target {
                build.args(["--target", target]);
            }
            run(&mut build)?;
        }
    }
    Ok(())
}

fn figures() -> Result<Expected> {
    Expected::of(&cost::firmware()?)
}
