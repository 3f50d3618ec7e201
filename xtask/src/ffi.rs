//! The task `c`: the library for C and its header, with programs in C on this computer and on the emulated board.

use std::{
    env, fs,
    io::BufReader,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use cargo_metadata::Message;
use foxhunt_host::replay::Replay;

use crate::{
    board::ensure_same,
    drive::EXAMPLE,
    measure::{panics, sections},
    project::{self, BOARD, run as quietly},
    qemu::Machine,
    setup::{self, Need},
};

/// The options of `cargo xtask c`.
#[derive(clap::Args)]
pub struct Options {
    /// Write the header anew, from the library as it is.
    #[arg(long)]
    bless: bool,
}

/// The files of the header.
const HEADERS: [&str; 2] = ["foxhunt.h", "foxhunt_sizes.h"];

/// Every warning is an error.
const WARNINGS: [&str; 5] = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// The core of the emulated board.
const CORE: [&str; 4] = [
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv4-sp-d16",
];

const NEEDS: &[Need] = &[Need::Target(BOARD), Need::Qemu, Need::Cxx, Need::ArmC];

/// Longer than the drive takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// Checks everything, and says how large the program on the board is.
pub fn run(options: &Options) -> Result<()> {
    audited()?;
    style()?;
    setup::ensure(NEEDS)?;
    let [board, host] = [library(Some(BOARD))?, library(None)?];
    let out = host.with_file_name("c");
    fs::create_dir_all(&out)?;
    header(&out, &board, &host, options.bless)?;
    functions(&out, &host)?;
    chapter(&out, &host)?;
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let expected = Replay::of(&drive);
    let expected = expected.output();
    let on_host = replay_on_host(&out, &host)?;
    ensure_same(&on_host, expected).context("the example in C on this computer")?;
    let (elf, output) = replay_on_board(&out, &board)?;
    ensure!(
        panics::functions(&elf)? == 0,
        "the example can panic on the board"
    );
    ensure_same(&output, expected).context("the example in C on the board")?;
    let occupied = sections::occupied(&elf)?;
    let drive = u64::try_from(drive.len())?;
    println!(
        "{} bytes of reports, the same in Rust, in C here, and in C on the board",
        expected.len()
    );
    println!(
        "the example in C takes {} bytes of flash beside its drive, and {} of RAM",
        occupied.flash - drive,
        occupied.ram
    );
    Ok(())
}

/// What the example sends, which holds the recorded drive, on the board and on this computer.
pub fn replays() -> Result<[Vec<u8>; 2]> {
    setup::ensure(NEEDS)?;
    let [board, host] = [library(Some(BOARD))?, library(None)?];
    let out = host.with_file_name("c");
    fs::create_dir_all(&out)?;
    Ok([
        replay_on_board(&out, &board)?.1,
        replay_on_host(&out, &host)?,
    ])
}

fn replay_on_host(out: &Path, library: &Path) -> Result<Vec<u8>> {
    let output = Command::new(on_host(out, library, &["examples/vehicle.c"])?).output()?;
    ensure!(output.status.success(), "the example failed on the host");
    Ok(output.stdout)
}

/// The file of the example, and what it sends.
fn replay_on_board(out: &Path, library: &Path) -> Result<(PathBuf, Vec<u8>)> {
    let elf = on_board(out, library)?;
    let mut machine = Machine::boot(&elf, LIMIT)?;
    let mut output = Vec::new();
    while let Some(bytes) = machine.receive() {
        output.extend(bytes);
    }
    machine.finish()?;
    Ok((elf, output))
}

/// The same as a check.
pub fn check() -> Result<()> {
    run(&Options { bless: false })
}

/// Fails if a file but the door has code that the compiler does not check.
fn audited() -> Result<()> {
    for entry in fs::read_dir(folder().join("src"))? {
        let path = entry?.path();
        let text = fs::read_to_string(&path)?;
        let is_checked = ["unsafe {", "unsafe fn", "unsafe impl", "unsafe extern"]
            .iter()
            .all(|unchecked| !text.contains(unchecked));
        ensure!(
            is_checked || path.ends_with("door.rs"),
            "{} has unsafe code: it belongs into door.rs",
            path.display()
        );
    }
    Ok(())
}

/// Formats nothing, but says whether something is formatted otherwise, and lints the library.
fn style() -> Result<()> {
    let mut format = cargo();
    format.args(["fmt", "--package", "foxhunt-ffi"]);
    quietly(format.args(["--package", "foxhunt-ffi-header", "--check"]))?;
    let mut clippy = cargo();
    clippy.args(["clippy", "--quiet", "--locked", "--package", "foxhunt-ffi"]);
    quietly(clippy.args(["--", "--deny", "warnings"]))
}

fn folder() -> PathBuf {
    project::root().join("ffi")
}

fn cargo() -> Command {
    let mut cargo = project::cargo();
    cargo.current_dir(folder());
    cargo
}

/// Builds the library and returns its file.
fn library(target: Option<&str>) -> Result<PathBuf> {
    let mut cargo = cargo();
    cargo.args(["build", "--quiet", "--release", "--locked"]);
    cargo.args(["--package", "foxhunt-ffi"]);
    cargo.arg("--message-format=json-render-diagnostics");
    if let Some(target) = target {
        cargo.args(["--target", target]);
    }
    let mut child = cargo.stdout(Stdio::piped()).spawn()?;
    let messages = BufReader::new(child.stdout.take().context("stdout is piped")?);
    let mut archive = None;
    for message in Message::parse_stream(messages) {
        if let Message::CompilerArtifact(artifact) = message? {
            let mut files = artifact.filenames.into_iter();
            archive = files.find(|file| file.extension() == Some("a")).or(archive);
        }
    }
    ensure!(child.wait()?.success(), "the library for C does not build");
    Ok(archive.context("cargo made no archive")?.into())
}

/// Compares the header with what the library says, or writes it.
fn header(out: &Path, board: &Path, host: &Path, bless: bool) -> Result<()> {
    let mut generator = cargo();
    generator.args(["run", "--quiet", "--locked"]);
    generator.args(["--package", "foxhunt-ffi-header", "--"]);
    quietly(generator.arg(out).arg(board).arg(host))?;
    for name in HEADERS {
        let (new, kept) = (out.join(name), folder().join("include").join(name));
        if bless {
            fs::copy(&new, &kept)?;
        }
        ensure!(
            fs::read(&new)? == fs::read(&kept).unwrap_or_default(),
            "{name} is not that of the library: `cargo xtask c --bless` writes it"
        );
    }
    // Also in C++.
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]);
    compiler.args(["-x", "c++"]);
    quietly(compiler.arg(folder().join("include/foxhunt.h")))
}

/// Runs what calls every function.
fn functions(out: &Path, host: &Path) -> Result<()> {
    let file = on_host(out, host, &["tests/door.c", "tests/locators.c"])?;
    quietly(Command::new(file).arg(project::root().join("examples/data")))
}

/// Compiles and runs the program of the chapter.
fn chapter(out: &Path, host: &Path) -> Result<()> {
    let text = fs::read_to_string(project::root().join("docs/src/from-c.md"))?;
    let program = text
        .split_once("```c\n")
        .and_then(|(_, rest)| rest.split_once("```"));
    let (program, _) = program.context("the chapter has no program")?;
    let file = out.join("ten_lines.c");
    fs::write(&file, program)?;
    let file = file.to_str().context("the path is text")?;
    let output = Command::new(on_host(out, host, &[file])?).output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(
        output.status.success() && said.contains(" m east, ") && said.ends_with("all is well\n"),
        "the program of the chapter says: {said}"
    );
    Ok(())
}

/// What both compilers are told.
fn compiler(program: &str, sources: &[&str]) -> Command {
    let mut compiler = Command::new(program);
    compiler.current_dir(folder()).args(WARNINGS);
    compiler.args(["-O2", "-Iinclude", "-Iexamples"]);
    let drive = project::root().join(EXAMPLE);
    compiler.arg(format!("-DDRIVE=\"{}\"", drive.display()));
    compiler.args(sources).arg("examples/drive.S");
    compiler
}

/// Builds a program for this computer, with `cc` or the compiler that `CC` names.
fn on_host(out: &Path, library: &Path, sources: &[&str]) -> Result<PathBuf> {
    let program = env::var("CC").unwrap_or_else(|_| "cc".into());
    let name = Path::new(sources[0]).file_stem().context("it has a name")?;
    let file = out.join(name);
    let mut compiler = compiler(&program, sources);
    compiler.arg("examples/host.c").arg(library);
    quietly(compiler.args(["-lm", "-o"]).arg(&file))?;
    Ok(file)
}

/// Builds the example for the emulated board.
fn on_board(out: &Path, library: &Path) -> Result<PathBuf> {
    let file = out.join("vehicle.elf");
    let mut compiler = compiler("arm-none-eabi-gcc", &["examples/vehicle.c"]);
    compiler.args(CORE);
    compiler.args(["-ffreestanding", "-nostdlib", "-Wl,--gc-sections"]);
    compiler.args(["-Texamples/mps2.ld", "examples/mps2.c"]);
    quietly(compiler.arg(library).arg("-o").arg(&file))?;
    Ok(file)
}
