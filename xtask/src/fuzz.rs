//! The task `fuzz`: no input panics, and a rejected message changes nothing.

use std::{
    fs,
    process::{Command, Stdio},
    time::Duration,
};

use anyhow::{Context, Result, bail, ensure};
use foxhunt_host::figures::Figure;
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::{figures, project, setup};

/// The options of `cargo xtask fuzz`.
#[derive(clap::Args)]
pub struct Options {
    /// How long each format is tried, in seconds.
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u32).range(1..))]
    seconds: u32,
    /// Only this format.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(FORMATS))]
    format: Option<String>,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<std::path::PathBuf>,
}

/// All that comes from outside.
const FORMATS: [&str; 9] = [
    "nmea",
    "ubx",
    "finders",
    "spectra",
    "beacon_lines",
    "beacon_frames",
    "messages",
    "radio_map",
    "snapshot",
];

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    let formats = match &options.format {
        Some(format) => vec![format.as_str()],
        None => FORMATS.to_vec(),
    };
    let found = try_all(&formats, options.seconds)?;
    figures::print(&found);
    match &options.json {
        Some(file) => figures::write_json(&found, file),
        None => Ok(()),
    }
}

/// A short look at every format.
pub fn check() -> Result<()> {
    try_all(&FORMATS, 12).map(drop)
}

/// Tries the formats for so many seconds each, two at a time.
fn try_all(formats: &[&str], seconds: u32) -> Result<Vec<Figure>> {
    setup::ensure(setup::FUZZ)?;
    let mut build = fuzz();
    project::run(build.args(["build", "--sanitizer", "none"]))?;

    let bar = ProgressBar::new(formats.len() as u64).with_style(ProgressStyle::with_template(
        "fuzzing {wide_bar} {pos} of {len} formats, {elapsed}",
    )?);
    bar.enable_steady_tick(Duration::from_millis(200));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let runs = pool.install(|| {
        let formats = formats.par_iter().progress_with(bar.clone());
        formats.map(|format| try_one(format, seconds)).collect()
    });
    bar.finish_and_clear();
    runs
}

/// cargo-fuzz on the stable compiler, which takes its flags if told to.
fn fuzz() -> Command {
    let mut fuzz = project::cargo();
    fuzz.arg("fuzz").env("RUSTC_BOOTSTRAP", "1");
    fuzz
}

fn try_one(format: &str, seconds: u32) -> Result<Figure> {
    let folder = project::root().join("fuzz");
    let found = folder.join("corpus").join(format);
    fs::create_dir_all(&found)?;
    let output = fuzz()
        .args(["run", "--sanitizer", "none", format])
        .arg(&found)
        .arg(folder.join("seeds").join(format))
        .args(["--", &format!("-max_total_time={seconds}")])
        // No line may take longer than that, at which a board would be a hundred times slower.
        .args(["-timeout=5", "-print_final_stats=1"])
        .stdout(Stdio::null())
        .output()?;
    let log = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{log}\nthe format {format} is not safe");
    }
    let stat = "stat::number_of_executed_units:";
    let inputs = log.lines().find_map(|line| line.strip_prefix(stat));
    let inputs: f64 = inputs
        .context("the fuzzer tells no number")?
        .trim()
        .parse()?;
    ensure!(inputs > 100.0, "{format}: hardly anything was tried");
    Ok(Figure::new(
        format!("fuzz.{format}.inputs"),
        inputs,
        "without a fault",
    ))
}
