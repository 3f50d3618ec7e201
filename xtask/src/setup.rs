//! What the tasks need beside a stable Rust toolchain: checked, and installed where it is missing.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::{
    llvm,
    project::{self, BARE_METAL, BOARD, BROWSER},
};

/// Something that a task needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// The standard library of a bare-metal target.
    Target(&'static str),
    /// `cargo fmt`.
    Rustfmt,
    /// `cargo clippy`.
    Clippy,
    /// The LLVM tools that belong to the compiler.
    LlvmTools,
    /// The emulator of the board.
    Qemu,
    /// That of RISC-V machines.
    QemuRiscV,
    /// Node.js, which runs WebAssembly.
    Node,
    /// A compiler of C and C++, for SQLite, the library for C, and the fuzzer's engine.
    Cxx,
    /// A compiler of C for the emulated board.
    ArmC,
    /// `cargo fuzz`.
    CargoFuzz,
    /// `cargo deny`.
    CargoDeny,
    /// `cargo mutants`.
    CargoMutants,
    /// `cargo semver-checks`.
    CargoSemverChecks,
    /// `cargo llvm-cov`.
    CargoLlvmCov,
    /// A nightly compiler with Miri.
    Miri,
    /// A broker of MQTT, and its clients.
    Mosquitto,
    /// gpsd.
    Gpsd,
    /// A browser, for the page.
    Chromium,
}

/// To build the page.
pub const PAGE: &[Need] = &[Need::Target(BROWSER)];

/// To build firmware and to run it in the emulator.
pub const FIRMWARE: &[Need] = &[Need::Target(BOARD), Need::Qemu];

/// To measure firmware.
pub const COST: &[Need] = &[Need::Target(BOARD), Need::LlvmTools, Need::Qemu];

/// To fuzz.
pub const FUZZ: &[Need] = &[Need::Cxx, Need::CargoFuzz];

/// To run every check.
pub const TEST: &[Need] = &[
    Need::Target(BARE_METAL[0]),
    Need::Target(BARE_METAL[1]),
    Need::Target(BARE_METAL[2]),
    Need::Rustfmt,
    Need::Clippy,
    Need::LlvmTools,
    Need::Qemu,
    Need::Cxx,
    Need::ArmC,
    Need::Mosquitto,
    Need::Gpsd,
    Need::Target(BROWSER),
    Need::Chromium,
];

/// Installs everything that any task needs.
pub fn run() -> Result<()> {
    ensure(TEST)?;
    ensure(FUZZ)?;
    println!("everything that the tasks need is installed");
    Ok(())
}

/// Checks the needs and installs what is missing, saying so.
pub fn ensure(needs: &[Need]) -> Result<()> {
    for need in needs {
        if !need.is_met()? {
            need.install()?;
            ensure!(
                need.is_met()?,
                "{need:?} is still missing after its installation"
            );
        }
    }
    Ok(())
}

impl Need {
    fn is_met(self) -> Result<bool> {
        Ok(match self {
            Self::Target(name) => project::sysroot()?
                .join("lib/rustlib")
                .join(name)
                .join("lib")
                .exists(),
            Self::Rustfmt => works(project::cargo().args(["fmt", "--version"])),
            Self::Clippy => works(project::cargo().args(["clippy", "--version"])),
            Self::LlvmTools => llvm::tool("llvm-objdump")?.exists(),
            Self::Qemu => works(Command::new("qemu-system-arm").arg("--version")),
            Self::QemuRiscV => works(Command::new("qemu-system-riscv32").arg("--version")),
            Self::Node => works(Command::new("node").arg("--version")),
            Self::Cxx => works(Command::new("c++").arg("--version")),
            Self::ArmC => works(Command::new("arm-none-eabi-gcc").arg("--version")),
            Self::CargoDeny => works(project::cargo().args(["deny", "--version"])),
            Self::CargoMutants => works(project::cargo().args(["mutants", "--version"])),
            Self::CargoSemverChecks => works(project::cargo().args(["semver-checks", "--version"])),
            Self::CargoLlvmCov => works(project::cargo().args(["llvm-cov", "--version"])),
            Self::Miri => works(nightly().args(["miri", "--version"])),
            Self::CargoFuzz => works(project::cargo().args(["fuzz", "--version"])),
            Self::Mosquitto => runs("mosquitto", "-h") && runs("mosquitto_sub", "--version"),
            Self::Gpsd => runs("gpsd", "-V"),
            Self::Chromium => ["chromium", "chromium-browser", "google-chrome"]
                .iter()
                .any(|program| works(Command::new(program).arg("--version"))),
        })
    }

    fn install(self) -> Result<()> {
        match self {
            Self::Target(name) => rustup(&["target", "add", name]),
            Self::Rustfmt => rustup(&["component", "add", "rustfmt"]),
            Self::Clippy => rustup(&["component", "add", "clippy"]),
            Self::LlvmTools => rustup(&["component", "add", "llvm-tools"]),
            Self::Qemu => install_packages(|manager| &manager.qemu),
            Self::Cxx => install_packages(|manager| &manager.cxx),
            Self::ArmC => install_packages(|manager| &manager.arm_c),
            Self::Mosquitto => install_packages(|manager| manager.mosquitto),
            Self::Gpsd => install_packages(|manager| &manager.gpsd),
            Self::Chromium => install_packages(|_| &["chromium"]),
            Self::QemuRiscV => install_packages(|manager| &manager.qemu_riscv),
            Self::Node => install_packages(|manager| &manager.node),
            Self::CargoFuzz => install_tool("cargo-fuzz"),
            Self::CargoDeny => install_tool("cargo-deny"),
            Self::CargoMutants => install_tool("cargo-mutants"),
            Self::CargoSemverChecks => install_tool("cargo-semver-checks"),
            Self::CargoLlvmCov => install_tool("cargo-llvm-cov"),
            Self::Miri => {
                rustup(&["toolchain", "install", "nightly", "--profile", "minimal"])?;
                rustup(&[
                    "component",
                    "add",
                    "--toolchain",
                    "nightly",
                    "miri",
                    "rust-src",
                ])
            }
        }
    }
}

fn install_tool(name: &str) -> Result<()> {
    announce(project::cargo().args(["install", "--locked", name]))
}

/// The nightly compiler's cargo, which rustup finds.
pub fn nightly() -> Command {
    let mut cargo = Command::new("rustup");
    cargo.args(["run", "nightly", "cargo"]);
    // These would lead back to the compiler of the repository.
    for variable in ["CARGO", "RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN"] {
        cargo.env_remove(variable);
    }
    cargo.current_dir(project::root());
    cargo
}

/// Runs rustup in the repository, so that it acts on the repository's toolchain.
fn rustup(arguments: &[&str]) -> Result<()> {
    announce(
        Command::new("rustup")
            .args(arguments)
            .current_dir(project::root()),
    )
    .context("install it by hand if this toolchain does not come from rustup")
}

/// A package manager of the system.
struct PackageManager {
    program: &'static str,
    needs_root: bool,
    /// What comes before an installation.
    prepare: Option<&'static str>,
    /// What installs the package whose name follows.
    install: &'static [&'static str],
    qemu: [&'static str; 1],
    cxx: [&'static str; 1],
    arm_c: [&'static str; 1],
    mosquitto: &'static [&'static str],
    gpsd: [&'static str; 1],
    qemu_riscv: [&'static str; 1],
    node: [&'static str; 1],
}

const PACKAGE_MANAGERS: [PackageManager; 5] = [
    PackageManager {
        program: "apt-get",
        needs_root: true,
        prepare: Some("update"),
        install: &["install", "--yes", "--no-install-recommends"],
        qemu: ["qemu-system-arm"],
        cxx: ["g++"],
        arm_c: ["gcc-arm-none-eabi"],
        mosquitto: &["mosquitto", "mosquitto-clients"],
        gpsd: ["gpsd"],
        qemu_riscv: ["qemu-system-misc"],
        node: ["nodejs"],
    },
    PackageManager {
        program: "dnf",
        needs_root: true,
        prepare: None,
        install: &["install", "--assumeyes"],
        qemu: ["qemu-system-arm"],
        cxx: ["gcc-c++"],
        arm_c: ["arm-none-eabi-gcc-cs"],
        mosquitto: &["mosquitto"],
        gpsd: ["gpsd"],
        qemu_riscv: ["qemu-system-riscv"],
        node: ["nodejs"],
    },
    PackageManager {
        program: "pacman",
        needs_root: true,
        prepare: None,
        install: &["--sync", "--refresh", "--noconfirm"],
        qemu: ["qemu-system-arm"],
        cxx: ["gcc"],
        arm_c: ["arm-none-eabi-gcc"],
        mosquitto: &["mosquitto"],
        gpsd: ["gpsd"],
        qemu_riscv: ["qemu-system-riscv"],
        node: ["nodejs"],
    },
    PackageManager {
        program: "zypper",
        needs_root: true,
        prepare: None,
        install: &["--non-interactive", "install"],
        qemu: ["qemu-arm"],
        cxx: ["gcc-c++"],
        arm_c: ["cross-arm-none-gcc14"],
        mosquitto: &["mosquitto"],
        gpsd: ["gpsd"],
        qemu_riscv: ["qemu-extra"],
        node: ["nodejs"],
    },
    PackageManager {
        program: "brew",
        needs_root: false,
        prepare: None,
        install: &["install"],
        qemu: ["qemu"],
        cxx: ["gcc"],
        arm_c: ["arm-none-eabi-gcc"],
        mosquitto: &["mosquitto"],
        gpsd: ["gpsd"],
        qemu_riscv: ["qemu"],
        node: ["node"],
    },
];

fn install_packages(names: fn(&PackageManager) -> &[&'static str]) -> Result<()> {
    let Some(manager) = PACKAGE_MANAGERS
        .iter()
        .find(|manager| works(Command::new(manager.program).arg("--version")))
    else {
        bail!(
            "no known package manager was found: install QEMU, Node.js, compilers of C++ and for Arm, Chromium, mosquitto and gpsd by hand"
        );
    };
    let sudo = manager.needs_root && !is_root();
    let packages = names(manager).iter().copied();
    let install = manager.install.iter().copied().chain(packages);
    for arguments in manager
        .prepare
        .map(|prepare| vec![prepare])
        .into_iter()
        .chain([install.collect()])
    {
        let mut command = Command::new(if sudo { "sudo" } else { manager.program });
        if sudo {
            command.arg(manager.program);
        }
        announce(command.args(arguments))?;
    }
    Ok(())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Whether the command can be run and succeeds; its output is dropped.
fn works(command: &mut Command) -> bool {
    let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// Whether the program is there, whatever it says.
fn runs(program: &str, argument: &str) -> bool {
    let mut command = Command::new(program);
    let silent = command.arg(argument).stdout(Stdio::null());
    silent.stderr(Stdio::null()).status().is_ok()
}

/// Says what is run, and runs it.
fn announce(command: &mut Command) -> Result<()> {
    let line = project::command_line(command);
    eprintln!("setup: {line}");
    let status = command
        .status()
        .with_context(|| format!("cannot run `{line}`"))?;
    ensure!(status.success(), "`{line}` failed");
    Ok(())
}
