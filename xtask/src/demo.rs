//! The task `demo`: a drive through the firmware `vehicle` on the emulated board, or people through that of a tunnel.

mod assessment;
mod scene;
mod tunnel;

use std::{
    io::{IsTerminal, stdout},
    path::PathBuf,
    thread,
    time::Duration,
};

use anyhow::{Context, Result, bail};
use foxhunt_host::{drive, geodesy::Place, measured::SIGMA_DEGREES, replay::Replay};
use indicatif::{ProgressBar, ProgressStyle};

use self::{assessment::Assessment, scene::Scene};
use crate::{
    board::{PLAIN, QUERY, ensure_same, has_status},
    project,
    qemu::Machine,
    reports::vehicle::{self, Report},
    setup,
};

/// The options of `cargo xtask demo`.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    other: Option<Other>,
    /// Run measured bearings instead of the simulated drive: a file of the WSR toolbox's data set.
    #[arg(long, value_name = "FILE", requires = "transmitter")]
    bearings: Option<PathBuf>,
    /// The transmitter of the file to locate.
    #[arg(long, value_name = "NAME", requires = "bearings")]
    transmitter: Option<String>,
    /// Standard deviation of the measured bearings, in degrees. Where the sight was free, 90 % of the data
    /// set's bearings are within 6.6 degrees, as those of a normal distribution with the default are.
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = SIGMA_DEGREES,
        requires = "bearings"
    )]
    sigma: f64,
}

/// What else there is to show.
#[derive(clap::Subcommand)]
enum Other {
    /// Track people in a tunnel with the firmware `beacon_gateway` in the emulator, and draw them.
    Tunnel(tunnel::Options),
}

/// The board is switched off after this time at the latest.
const LIMIT: Duration = Duration::from_secs(120);
/// Time on a terminal for a second of the drive, so that the fixes can be seen to come.
const PACE: Duration = Duration::from_millis(15);

/// Streams the drive through the firmware and says how good its answer is; or what else is asked for.
pub fn run(options: &Options) -> Result<()> {
    if let Some(Other::Tunnel(options)) = &options.other {
        return tunnel::run(options);
    }
    let scene = match (&options.bearings, &options.transmitter) {
        (Some(file), Some(transmitter)) => Scene::measured(file, transmitter, options.sigma)?,
        _ => Scene::example()?,
    };
    let truth =
        drive::truth(&scene.bytes).context("the drive does not tell where the transmitter is")?;

    setup::ensure(setup::FIRMWARE)?;
    println!("building the firmware `vehicle` for {}", project::BOARD);
    let elf = project::firmware(PLAIN)?;
    println!("booting it on QEMU's mps2-an386, a Cortex-M4F");
    let mut machine = Machine::boot(&elf, LIMIT)?;
    let output = stream(&mut machine, &scene.bytes, truth)?;

    let mut replay = Replay::of(&scene.bytes);
    replay.push(QUERY);
    ensure_same(&output, replay.output())?;
    println!("the gateway on this machine gives the same reports, byte for byte");

    let reports = vehicle::parse(&output);
    if let Some(Report::Status(status)) = reports.last() {
        println!("{status}");
    }
    let fix = match reports
        .iter()
        .rev()
        .find(|report| !matches!(report, Report::Status(_)))
    {
        Some(Report::Fix(fix)) => fix,
        Some(Report::NoFix(reason)) => bail!("the transmitter was not located: {reason}"),
        _ => bail!("the firmware reported nothing"),
    };
    let assessment = Assessment::new(fix, truth, &replay)?;
    println!("{assessment}");

    let stem = project::root().join("target/demo").join(&scene.name);
    assessment.draw(&scene, &replay, &stem)?;
    println!(
        "pictures: {} and .png",
        stem.with_extension("svg").display()
    );
    assessment.check()
}

/// Sends the drive and a query, prints the fixes as they come, and returns all that the firmware sent.
fn stream(machine: &mut Machine, bytes: &[u8], truth: Place) -> Result<Vec<u8>> {
    let bar = ProgressBar::new(bytes.len() as u64).with_style(ProgressStyle::with_template(
        "{wide_bar} {bytes} of {total_bytes}",
    )?);
    let pace = if stdout().is_terminal() {
        PACE
    } else {
        Duration::ZERO
    };
    let mut output = Vec::new();
    let mut shown = 0;
    let mut latest = None;
    let mut show = |output: &[u8]| {
        // A report may come in pieces: only whole lines are shown.
        let end = output
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |last| last + 1);
        for report in vehicle::parse(&output[shown..end]) {
            // The answer to the query repeats the last one.
            if let Report::Fix(fix) = report
                && latest.as_ref() != Some(&fix)
            {
                bar.suspend(|| println!("{}", fix.line(truth)));
                latest = Some(fix);
            }
        }
        shown = end;
    };
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        machine.send(line)?;
        bar.inc(line.len() as u64);
        if line.starts_with(b"$GPRMC") {
            thread::sleep(pace);
        }
        output.extend(machine.received());
        show(&output);
    }
    machine.send(QUERY)?;
    // The status is the last of the answer.
    while !has_status(&output) {
        output.extend(
            machine
                .receive()
                .context("the firmware ended before it answered")?,
        );
        show(&output);
    }
    bar.finish_and_clear();
    Ok(output)
}
