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
use foxhunt::aoa::{Clean, Locate};
use foxhunt_gateways::plain;
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

/// What the header is for, beside the C of its tests.
const LANGUAGES: [(&str, [&str; 3]); 2] = [
    ("cc", ["-x", "c", "-std=c99"]),
    ("c++", ["-x", "c++", "-std=c++17"]),
];

/// Every warning is an error.
const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// The pages that say how to write the header, and how.
const PAGES: [&str; 2] = [CHAPTER, "ffi/README.md"];
const WRITE: [&str; 4] = ["run", "--package", "foxhunt-ffi-header", "--"];

const CHAPTER: &str = "docs/src/from-c.md";

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
    let has_same_sizes = sizes()? == sizes_of(&plain::Locator::EMPTY);
    if has_same_sizes {
        ensure_same(&on_host, expected)
            .context("the example in C on this computer, expected as in Rust")?;
    }
    let (elf, on_board) = replay_on_board(&out, &board)?;
    ensure!(
        panics::functions(&elf)? == 0,
        "the example can panic on the board"
    );
    ensure_same(&on_board, &on_host)
        .context("the example in C on the board, expected as on this computer")?;
    let occupied = sections::occupied(&elf)?;
    let drive = u64::try_from(drive.len())?;
    println!(
        "{} bytes of reports, the same in C here and in C on the board",
        on_host.len()
    );
    println!(
        "{}",
        match has_same_sizes {
            true => "they are those of the gateway in Rust",
            false => "they are not compared with the gateway in Rust, which has other sizes",
        }
    );
    println!(
        "the example in C takes {} bytes of flash beside its drive, and {} of RAM",
        occupied.flash - drive,
        occupied.ram
    );
    Ok(())
}

/// How many particles and bearings the gateway in C has.
fn sizes() -> Result<[usize; 2]> {
    let text = fs::read_to_string(folder().join("src/sizes.rs"))?;
    let of = |name: &str| -> Result<usize> {
        let (_, rest) = text
            .split_once(&format!("{name}: usize = "))
            .with_context(|| format!("no {name}"))?;
        let number = rest.split(';').next().unwrap_or_default();
        Ok(number.replace('_', "").parse()?)
    };
    Ok([of("FOXHUNT_PARTICLES")?, of("FOXHUNT_BEARINGS")?])
}

/// How many a locator in Rust has.
fn sizes_of<const N: usize, const B: usize>(_: &Clean<N, B>) -> [usize; 2] {
    [N, B]
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
    for page in PAGES {
        let command = format!("cargo {} include ", WRITE.join(" "));
        let text = fs::read_to_string(project::root().join(page))?;
        ensure!(text.contains(&command), "{page} has no `{command}`");
    }
    quietly(cargo().args(WRITE).arg(out).arg(board).arg(host))?;
    for name in HEADERS {
        let (new, kept) = (out.join(name), folder().join("include").join(name));
        if bless {
            fs::copy(&new, &kept)?;
        }
        ensure!(
            fs::read(&new)? == fs::read(&kept).unwrap_or_default(),
            "{name} is not that of the library: ffi/README.md says how to write it"
        );
    }
    for (program, language) in LANGUAGES {
        let mut compiler = Command::new(program);
        compiler.args(language).args(WARNINGS);
        compiler.arg("-fsyntax-only");
        quietly(compiler.arg(folder().join("include/foxhunt.h")))?;
    }
    Ok(())
}

/// Runs what calls every function.
fn functions(out: &Path, host: &Path) -> Result<()> {
    let file = on_host(out, host, &["tests/door.c", "tests/locators.c"])?;
    quietly(Command::new(file).arg(project::root().join("examples/data")))
}

/// Compiles and runs the program of the chapter.
fn chapter(out: &Path, host: &Path) -> Result<()> {
    let file = out.join("ten_lines.c");
    fs::write(&file, of_chapter("```c\n")?)?;
    let file = file.to_str().context("the path is text")?;
    let output = Command::new(on_host(out, host, &[file])?).output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(
        output.status.success() && said.contains(" m east, ") && said.ends_with("all is well\n"),
        "the program of the chapter says: {said}"
    );
    Ok(())
}

/// What the chapter has from there on to the end of the block of code.
fn of_chapter(beginning: &str) -> Result<String> {
    let text = fs::read_to_string(project::root().join(CHAPTER))?;
    let rest = text.split_once(beginning).map(|(_, rest)| rest);
    let code = rest.and_then(|rest| rest.split_once("```"));
    let (code, _) = code.with_context(|| format!("{CHAPTER} has no `{beginning}`"))?;
    Ok(code.to_owned())
}

/// Builds a program for this computer, with `cc` or the compiler that `CC` names.
fn on_host(out: &Path, library: &Path, sources: &[&str]) -> Result<PathBuf> {
    let name = Path::new(sources[0]).file_stem().context("it has a name")?;
    let file = out.join(name);
    let mut compiler = Command::new(env::var("CC").unwrap_or_else(|_| "cc".into()));
    compiler.current_dir(folder()).args(WARNINGS);
    compiler.args(["-std=c11", "-O2", "-Iinclude", "-Iexamples"]);
    let drive = project::root().join(EXAMPLE);
    compiler.arg(format!("-DDRIVE=\"{}\"", drive.display()));
    compiler.args(sources);
    compiler.args(["examples/drive.S", "examples/host.c"]);
    quietly(compiler.arg(library).args(["-lm", "-o"]).arg(&file))?;
    Ok(file)
}

/// Builds the example for the emulated board, by the command of the chapter.
fn on_board(out: &Path, library: &Path) -> Result<PathBuf> {
    const COMPILER: &str = "arm-none-eabi-gcc";
    let file = out.join("vehicle.elf");
    let command = of_chapter("```sh\ncd foxhunt/ffi\narm-none-eabi-gcc")?;
    let command = command.lines().take_while(|line| !line.starts_with("qemu"));
    let command = command.collect::<Vec<_>>().join("\n");
    let kept = format!("target/{BOARD}/release/libfoxhunt_ffi.a");
    ensure!(command.contains(&kept), "the command links no library");
    let command = command.replace(&kept, "\"$LIBRARY\"");
    let command = command.replace("-o vehicle.elf", "-o \"$FILE\"");
    let mut shell = Command::new("sh");
    shell.current_dir(folder());
    shell.env("LIBRARY", library).env("FILE", &file);
    let warnings = WARNINGS.join(" ");
    shell
        .arg("-ec")
        .arg(format!("{COMPILER}{command} {warnings}"));
    quietly(&mut shell)?;
    Ok(file)
}
