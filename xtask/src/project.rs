//! Where things are, and how cargo is called.

use std::{
    env,
    ffi::OsStr,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::{Artifact, Message, Metadata, MetadataCommand, camino::Utf8PathBuf};

/// The target of the emulated board: a Cortex-M4 with its single-precision FPU.
pub const BOARD: &str = "thumbv7em-none-eabihf";

/// The target of the page's code.
pub const BROWSER: &str = "wasm32-unknown-unknown";

/// Every bare-metal target on which the library must compile: soft float, M4F, M33 with FPU.
pub const BARE_METAL: [&str; 3] = ["thumbv6m-none-eabi", BOARD, "thumbv8m.main-none-eabihf"];

/// The repository's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("xtask lies in the repository's root")
}

/// Cargo in the repository's root. `RUSTFLAGS` is dropped, because it would replace the flags of
/// `.cargo/config.toml` and lose the linker script; `CARGO_INCREMENTAL`, because firmware that is built in increments is
/// other firmware: it takes up to 75 % more instructions.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(root())
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_INCREMENTAL");
    cargo
}

/// What cargo knows of the workspace.
pub fn metadata() -> Result<Metadata> {
    Ok(MetadataCommand::new()
        .current_dir(root())
        .no_deps()
        .exec()?)
}

/// Where cargo puts what it builds.
pub fn target_directory() -> Result<PathBuf> {
    Ok(metadata()?.target_directory.into())
}

/// Builds the firmware `example` for the board in release mode and returns its ELF file.
pub fn firmware(example: &str) -> Result<PathBuf> {
    executable(&["--release", "--target", BOARD, "--example", example])
}

/// Builds several of them at once, which takes less time than one after the other.
pub fn build_firmwares(examples: &[&str]) -> Result<()> {
    let mut build = cargo();
    build.args(["build", "--release", "--target", BOARD]);
    run(build.args(examples.iter().flat_map(|example| ["--example", example])))
}

/// Builds a firmware at the level of optimisation for size. It also links if a panic is left in it, so that it can be measured.
pub fn small_firmware(example: &str) -> Result<PathBuf> {
    let example = [
        "--profile",
        "small",
        "--target",
        BOARD,
        "--example",
        example,
    ];
    let link = ["--", "-C", "link-arg=--defsym=the_firmware_can_panic=0"];
    built(cargo(), "rustc", &[&example[..], &link].concat())
}

/// The firmware in release mode with variables in the compiler's environment.
pub fn firmware_with(example: &str, variables: &[(&str, &OsStr)]) -> Result<PathBuf> {
    let mut cargo = cargo();
    cargo.envs(variables.iter().copied());
    built(
        cargo,
        "build",
        &["--release", "--target", BOARD, "--example", example],
    )
}

/// Builds the one executable that `arguments` of `cargo build` select and returns its file.
pub fn executable(arguments: &[&str]) -> Result<PathBuf> {
    executable_in(root(), arguments)
}

/// The same for the workspace in `directory`.
pub fn executable_in(directory: &Path, arguments: &[&str]) -> Result<PathBuf> {
    let mut cargo = cargo();
    cargo.current_dir(directory);
    built(cargo, "build", arguments)
}

/// The same with a cargo that was prepared.
pub fn executable_by(cargo: Command, arguments: &[&str]) -> Result<PathBuf> {
    built(cargo, "build", arguments)
}

fn built(mut cargo: Command, command: &str, arguments: &[&str]) -> Result<PathBuf> {
    let mut child = cargo
        .args([
            command,
            "--quiet",
            "--message-format=json-render-diagnostics",
        ])
        .args(arguments)
        .stdout(Stdio::piped())
        .spawn()
        .context("cannot run cargo")?;
    let messages = std::io::BufReader::new(child.stdout.take().expect("stdout is piped"));
    let mut executables: Vec<Utf8PathBuf> = Vec::new();
    for message in Message::parse_stream(messages) {
        if let Message::CompilerArtifact(Artifact {
            executable: Some(file),
            ..
        }) = message?
        {
            executables.push(file);
        }
    }
    ensure!(
        child.wait()?.success(),
        "cargo {command} {} failed",
        arguments.join(" ")
    );
    match executables.as_slice() {
        [file] => Ok(file.into()),
        _ => bail!(
            "cargo {command} {} made {} executables",
            arguments.join(" "),
            executables.len()
        ),
    }
}

/// Runs a command; its output is shown only if it fails.
pub fn run(command: &mut Command) -> Result<()> {
    let line = command_line(command);
    let output = command
        .output()
        .with_context(|| format!("cannot run {line}"))?;
    if !output.status.success() {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        bail!(
            "{}{}\n`{line}` failed",
            text(&output.stdout),
            text(&output.stderr)
        );
    }
    Ok(())
}

/// The directory of the compiler.
pub fn sysroot() -> Result<PathBuf> {
    Ok(rustc(&["--print", "sysroot"])?.into())
}

/// What the repository's compiler answers to `arguments`, trimmed.
pub fn rustc(arguments: &[&str]) -> Result<String> {
    let output = Command::new("rustc")
        .args(arguments)
        .current_dir(root())
        .output()
        .context("cannot run rustc")?;
    ensure!(
        output.status.success(),
        "rustc {} failed",
        arguments.join(" ")
    );
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

/// The command as one would type it.
pub fn command_line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}
