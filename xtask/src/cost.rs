//! The task `cost`: what the library and its firmware take, beside what others take.

use std::{
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use foxhunt_host::figures::Figure;
use rayon::prelude::*;

use crate::{
    board::{BEACON, BEACONS, PLAIN, ROBUST, VEHICLES},
    choice,
    expected::Expected,
    figures::{self, KIB},
    kernels,
    measure::{panics, regions, sections, stack},
    project::{self, BOARD},
    qemu::Machine,
    setup,
};

/// The options of `cargo xtask cost`.
#[derive(clap::Args)]
pub struct Options {
    /// Write the figures as JSON, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Take the figures of the firmware as the expected ones of `cargo xtask test`.
    #[arg(long)]
    bless: bool,
    /// Only compare the elementary functions, and write their table into a page of the guide.
    #[arg(long, value_name = "FILE")]
    kernels: Option<PathBuf>,
    /// Only measure few and many particles, and write their tables into a page of the guide.
    #[arg(long, value_name = "FILE")]
    choice: Option<PathBuf>,
    /// Leave out the other filters.
    #[arg(long)]
    no_peers: bool,
}

/// The most that a figure may be.
const LIMITS: [(&str, f64); 22] = [
    ("m4f.step.n200.instructions", 300.0),
    ("m4f.refine.fish.n1000.cycles_modelled", 1500.0),
    ("host.step.n1000.ns", 25.0),
    ("filter.d2.n200.bytes", 16.0 * 200.0 + 256.0),
    ("vehicle.flash.bytes", 60.0 * KIB),
    ("vehicle.flash.s.bytes", 44.0 * KIB),
    ("vehicle.robust.flash.bytes", 154.0 * KIB),
    ("vehicle.robust.flash.s.bytes", 98.0 * KIB),
    ("beacon.flash.bytes", 50.0 * KIB),
    ("vehicle.robust.memory.bytes", 98_304.0),
    ("vehicle.kept.memory.bytes", 98_304.0),
    // At 168 MHz.
    ("robust.update.worst.modelled", 100.0),
    ("m4f.fingerprint.match.gaussian.instructions", 6_000.0),
    ("m4f.fingerprint.match.table.instructions", 6_000.0),
    ("m4f.tracker.n300.update.instructions", 90_000.0),
    ("m4f.tracker.n300.plane.update.instructions", 300_000.0),
    ("tracker.n300.bytes", 1_500.0),
    ("tracker.n300.plane.bytes", 2_200.0),
    ("beacon.ram.bytes", 200.0 * KIB),
    ("beacon.t64.load.modelled", 70.0),
    ("fingerprint.map.moments.bytes", 1_024.0),
    ("fingerprint.map.levels.bytes", 5_427.0),
];

/// The firmwares that are also built for size.
const SMALL: [&str; 3] = [PLAIN, ROBUST, BEACON];

/// The firmwares of which the emulator logs every instruction, and those that count theirs themselves.
const LOGGED: [&str; 3] = ["cost", "fingerprint_cost", "beacon_cost"];
const COUNTED: [&str; 2] = ["updates", "choose_n"];

/// The most that a figure of any firmware may be, by the end of its name: variables with an initial value other than zero
/// take flash, too.
const ANY: [(&str, f64); 2] = [(".data.bytes", 256.0), (".panics.s", 0.0)];

/// Instructions and modelled cycles that short polynomials with errors of about 1e-6 are known to take, per
/// call in a loop over an array. They are rounded, so a kernel may take half an instruction or cycle more, and a
/// quarter for what the loop takes to begin, over its 200 calls.
const KERNELS: [(&str, f64, f64); 5] = [
    // In two chains: one instruction more than by Horner's rule, and four cycles less.
    ("m4f.math.exp", 25.0, 39.0),
    ("m4f.math.ln", 28.0, 45.0),
    ("m4f.math.atan2", 35.0, 65.0),
    ("m4f.math.sin_cos", 37.0, 54.0),
    ("m4f.math.sqrt", 6.4, 22.0),
];

/// Measures everything, prints it, and fails if a limit is missed.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(setup::COST)?;
    if let Some(page) = &options.kernels {
        let mut figures = regions::measure(&project::firmware("cost")?)?;
        figures.retain(|figure| figure.name.contains(".math."));
        let mut figures = with_limits(figures);
        figures.extend(kernels::errors()?);
        figures::print(&figures);
        return kernels::write(&figures, page);
    }
    if let Some(page) = &options.choice {
        let mut figures = counted(&project::firmware("choose_n")?)?;
        figures.extend(regions::measure(&project::firmware("cost")?)?);
        figures.extend(choice::distances()?);
        figures::print(&figures);
        return choice::write(&figures, page);
    }
    let firmware = firmware()?;
    let mut figures = firmware.clone();
    figures.extend(choice::distances()?);
    figures.extend(kernels::errors()?);
    figures.extend(formats()?);
    figures.extend(host()?);
    if !options.no_peers {
        figures.extend(peers()?);
    }
    figures::print(&figures);
    println!(
        "modelled: cycles of a Cortex-M4F by its manual's timings, with memory that never waits"
    );
    let path = stack::deepest(&project::firmware(PLAIN)?)?.path;
    let path = path
        .iter()
        .map(|(function, frame)| format!("\n  {frame:5}  {function}"));
    println!(
        "the deepest stack of the vehicle's main thread:{}",
        path.collect::<String>()
    );
    if let Some(file) = &options.json {
        figures::write_json(&figures, file)?;
    }
    if options.bless {
        Expected::of(&firmware)?.write()?;
    }
    figures::check(&figures)
}

/// The figures that the firmware alone decides: they do not depend on the machine that measures them.
pub fn firmware() -> Result<Vec<Figure>> {
    project::build_firmwares(&[&LOGGED[..], &COUNTED, &VEHICLES, &BEACONS].concat())?;
    // While these run, those for size are built: cargo builds one after the other.
    let small = || SMALL.map(small).into_iter().collect::<Result<Vec<_>>>();
    let (large, small) = rayon::join(measured, small);
    let mut figures = load(phases([large?.concat(), small?.concat()].concat())?)?;
    let milliseconds = worst_milliseconds(&figures)?;
    figures.push(milliseconds);
    Ok(with_limits(figures))
}

/// What firmwares that are built say, and what they take of the memories.
fn measured() -> Result<Vec<Vec<Figure>>> {
    let elfs = |names: &[&str]| (names.iter().map(|name| project::firmware(name))).collect();
    let [logs, counts]: [Result<Vec<_>>; 2] = [elfs(&LOGGED), elfs(&COUNTED)];
    let logs = logs?.into_par_iter().map(|elf| regions::measure(&elf));
    let counts = counts?.into_par_iter().map(|elf| counted(&elf));
    let mut figures = logs.chain(counts).collect::<Result<Vec<_>>>()?;
    for firmware in VEHICLES.into_iter().chain(BEACONS) {
        figures.push(memory(firmware)?);
    }
    Ok(figures)
}

/// What a firmware takes if it is built for size, and whether it could panic.
fn small(firmware: &str) -> Result<Vec<Figure>> {
    let elf = project::small_firmware(firmware)?;
    let (flash, panics) = (sections::occupied(&elf)?.flash, panics::functions(&elf)?);
    let name = figure_of(firmware);
    Ok(vec![
        Figure::new(format!("{name}.flash.s.bytes"), flash as f64, "bytes"),
        Figure::new(format!("{name}.panics.s"), panics as f64, "functions"),
    ])
}

/// What a full gateway takes of the time of a Cortex-M4 at 64 MHz, beside what its second was measured to take.
fn load(mut figures: Vec<Figure>) -> Result<Vec<Figure>> {
    const CYCLES: f64 = 64e6;
    let name = "m4f.beacon.t64.second.cycles_modelled";
    let second = figures.iter().find(|figure| figure.name == name);
    let second = second.with_context(|| format!("no {name} was measured"))?;
    let percent = 100.0 * second.value / CYCLES;
    figures.push(Figure::new("beacon.t64.load.modelled", percent, "%"));
    Ok(figures)
}

/// What a firmware takes of the memories.
fn memory(firmware: &str) -> Result<Vec<Figure>> {
    let elf = project::firmware(firmware)?;
    let occupied = sections::occupied(&elf)?;
    let (ram, stack) = (occupied.ram as f64, f64::from(stack::deepest(&elf)?.bytes));
    let parts = [
        ("flash", occupied.flash as f64),
        ("data", occupied.data as f64),
        ("ram", ram),
        ("stack", stack),
        ("memory", ram + stack),
    ];
    let name = figure_of(firmware);
    let figures =
        parts.map(|(part, bytes)| Figure::new(format!("{name}.{part}.bytes"), bytes, "bytes"));
    Ok(figures.into())
}

/// What each format adds to the flash of a vehicle that reads NMEA, in the order of the example `one_format`.
fn formats() -> Result<Vec<Figure>> {
    const NAMES: [&str; 7] = [
        "ubx",
        "agrelo",
        "kraken",
        "kraken.spectrum",
        "ublox",
        "kn5r",
        "aprs",
    ];
    let flash = |number: usize| {
        let number = number.to_string();
        let elf = project::firmware_with("one_format", &[("FOXHUNT_FORMAT", number.as_ref())])?;
        anyhow::Ok(sections::occupied(&elf)?.flash as f64)
    };
    let nmea = flash(0)?;
    let mut figures = vec![Figure::new(
        "format.nmea.vehicle.flash.bytes",
        nmea,
        "bytes",
    )];
    for (index, name) in NAMES.iter().enumerate() {
        let name = format!("format.{name}.flash.bytes");
        figures.push(Figure::new(name, flash(index + 1)? - nmea, "bytes"));
    }
    Ok(figures)
}

/// What the figures of a firmware begin with.
fn figure_of(firmware: &str) -> String {
    firmware
        .replace("beacon_gateway", "beacon")
        .replace('_', ".")
}

/// The longest that a bearing takes of which much may be wrong, with one locator, several, or all of the gateway: its
/// instructions, at as many cycles as those of the locator take. These are modelled for few particles, for a log of all
/// instructions; what there is to do grows by the same with each.
fn worst_milliseconds(figures: &[Figure]) -> Result<Figure> {
    /// Cycles in a millisecond at 168 MHz.
    const CYCLES: f64 = 168e3;
    let value = |name: &str| {
        let figure = figures.iter().find(|figure| figure.name == name);
        let figure = figure.with_context(|| format!("no {name} was measured"));
        figure.map(|figure| figure.value)
    };
    let with_256 = |what: &str| -> Result<f64> {
        let few = value(&format!("m4f.robust.n16.update.{what}"))?;
        let more = value(&format!("m4f.robust.n64.update.{what}"))?;
        Ok(few + (more - few) * (256.0 - 16.0) / (64.0 - 16.0))
    };
    let cycles = with_256("cycles_modelled")? / with_256("instructions")?;
    let mut worst = 0.0;
    for what in [
        "robust",
        "sources",
        "vehicle.robust",
        "vehicle.robust.sources",
    ] {
        worst = f64::max(worst, value(&format!("{what}.update.worst.instructions"))?);
    }
    let milliseconds = worst * cycles / CYCLES;
    Ok(Figure::new(
        "robust.update.worst.modelled",
        milliseconds,
        "ms",
    ))
}

/// What gateways take for recorded bearings and packets. They are too many instructions for a log; the firmware counts them
/// itself, by a clock that ticks with them.
fn counted(elf: &Path) -> Result<Vec<Figure>> {
    let clock = ["-icount", "shift=6"];
    let mut machine = Machine::boot_with(elf, Duration::from_secs(120), &clock)?;
    // The emulator writes the firmware's text where it writes the bytes of the UART, which this one does not use.
    let mut printed = Vec::new();
    while let Some(bytes) = machine.receive() {
        printed.extend(bytes);
    }
    machine.finish()?;
    regions::figures(&[], &String::from_utf8(printed)?)
}

/// Splits the update into its phases: weighing, which was measured alone, and normalising, the rest of it.
fn phases(mut figures: Vec<Figure>) -> Result<Vec<Figure>> {
    for measure in ["instructions", "cycles_modelled"] {
        let name = |phase: &str| format!("m4f.step.n200.{phase}.{measure}");
        let value = |phase: &str| {
            let mut figures = figures.iter();
            let figure = figures.find(|figure| figure.name == name(phase));
            figure
                .map(|figure| figure.value)
                .with_context(|| format!("no {} was measured", name(phase)))
        };
        let normalise = value("update")? - value("weigh")?;
        for figure in figures
            .iter_mut()
            .filter(|figure| figure.name == name("update"))
        {
            (figure.name, figure.value) = (name("normalise"), normalise);
        }
    }
    Ok(figures)
}

/// The figures of this machine.
fn host() -> Result<Vec<Figure>> {
    let program = project::executable(&["--release", "--example", "cost"])?;
    let output = Command::new(program).output()?;
    ensure!(
        output.status.success(),
        "the measurement on the host failed"
    );
    Ok(with_limits(regions::figures(
        &[],
        &String::from_utf8(output.stdout)?,
    )?))
}

/// The figures of other filters on the same work, from a workspace of its own. It is built in its directory,
/// so that it takes its own lock file and the flags of the repository's firmware.
fn peers() -> Result<Vec<Figure>> {
    let peers = project::root().join("peers");
    let host = project::executable_in(&peers, &["--release", "--bin", "peers"])?;
    let output = Command::new(host).output()?;
    ensure!(
        output.status.success(),
        "the measurement of the other filters failed"
    );
    let mut figures: Vec<Figure> = serde_json::from_slice(&output.stdout)?;
    let board = ["--release", "--target", BOARD, "--bin", "peers_m4"];
    figures.extend(regions::measure(&project::executable_in(&peers, &board)?)?);
    Ok(figures)
}

fn with_limits(figures: Vec<Figure>) -> Vec<Figure> {
    let figures = figures.into_iter();
    figures
        .map(|figure| limit(&figure.name).map_or(figure.clone(), |limit| figure.at_most(limit)))
        .collect()
}

fn limit(name: &str) -> Option<f64> {
    let kernel = KERNELS.iter().find_map(|&(kernel, instructions, cycles)| {
        match name.strip_prefix(kernel)? {
            ".instructions" => Some(instructions + 0.75),
            ".cycles_modelled" => Some(cycles + 0.75),
            _ => None,
        }
    });
    let known = LIMITS.iter().find(|(known, _)| *known == name);
    let of_any = ANY.iter().find(|(end, _)| name.ends_with(end));
    kernel.or(known.or(of_any).map(|&(_, limit)| limit))
}
