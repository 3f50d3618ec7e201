//! The task `machines`: the portable tests, a whole drive and a whole walk on emulated machines of other cores.

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail, ensure};
use comfy_table::Table;
use indicatif::ProgressBar;

use crate::{
    project,
    setup::{self, Need},
    steps,
};

/// The options of `cargo xtask machines`.
#[derive(clap::Args)]
pub struct Options {
    /// Only the machines whose names contain one of these words.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
}

/// A machine on which every case must compute what it computes on the host.
struct Machine {
    /// The core.
    name: &'static str,
    target: &'static str,
    /// More arguments of the compiler.
    flags: &'static str,
    /// The name of its linker script.
    memory: &'static str,
    runs: Runs,
}

/// What runs its programs.
enum Runs {
    /// QEMU for Arm: a board, and its core.
    Arm(&'static str, &'static str),
    /// QEMU's RISC-V machine.
    RiscV,
    /// Node.js.
    WebAssembly,
}

const MACHINES: [Machine; 8] = [
    Machine {
        name: "Cortex-M0+ code on an M3",
        target: "thumbv6m-none-eabi",
        flags: "",
        memory: "mps2",
        runs: Runs::Arm("mps2-an385", "cortex-m3"),
    },
    Machine {
        name: "Cortex-M4F",
        target: project::BOARD,
        flags: "-Ctarget-cpu=cortex-m4",
        memory: "mps2",
        runs: Runs::Arm("mps2-an386", "cortex-m4"),
    },
    Machine {
        name: "Cortex-M7",
        target: project::BOARD,
        flags: "-Ctarget-cpu=cortex-m7",
        memory: "mps2",
        runs: Runs::Arm("mps2-an500", "cortex-m7"),
    },
    Machine {
        name: "Cortex-M33",
        target: "thumbv8m.main-none-eabihf",
        flags: "-Ctarget-cpu=cortex-m33",
        memory: "an505",
        runs: Runs::Arm("mps2-an505", "cortex-m33"),
    },
    Machine {
        name: "Cortex-M55 with MVE",
        target: "thumbv8m.main-none-eabihf",
        flags: "-Ctarget-cpu=cortex-m55",
        memory: "an547",
        runs: Runs::Arm("mps3-an547", "cortex-m55"),
    },
    Machine {
        name: "RISC-V imac",
        target: "riscv32imac-unknown-none-elf",
        flags: "",
        memory: "virt",
        runs: Runs::RiscV,
    },
    Machine {
        name: "RISC-V imafc",
        target: "riscv32imafc-unknown-none-elf",
        flags: "",
        memory: "virt",
        runs: Runs::RiscV,
    },
    Machine {
        name: "WebAssembly",
        target: "wasm32-unknown-unknown",
        flags: "",
        memory: "none",
        runs: Runs::WebAssembly,
    },
];

/// Runs all cases on the machines, one after the other.
pub fn run(options: &Options) -> Result<()> {
    let chosen = |machine: &&Machine| steps::is_chosen(machine.name, &options.words);
    let machines: Vec<&Machine> = MACHINES.iter().filter(chosen).collect();
    ensure!(!machines.is_empty(), "no machine has such a name");
    let mut table = Table::new();
    table.set_header(["machine", "target", "cases", "run time"]);
    for machine in machines {
        setup::ensure(&machine.needs())?;
        let spinner = ProgressBar::new_spinner().with_message(machine.name);
        spinner.enable_steady_tick(Duration::from_millis(100));
        let (cases, time) = machine
            .check()
            .with_context(|| format!("on {}", machine.name))?;
        spinner.finish_and_clear();
        let time = format!("{:.1} s", time.as_secs_f64());
        let cases = format!("{cases} as on the host");
        table.add_row([machine.name, machine.target, &cases, &time]);
    }
    println!("{table}");
    Ok(())
}

/// The cases on all of them.
pub fn check_all() -> Result<()> {
    run(&Options { words: Vec::new() })
}

/// The vehicle's gateway on the machine of this name: its file, and what runs it. On one of Arm, UART0 is the standard input
/// and output.
pub fn vehicle(name: &str) -> Result<(PathBuf, Command)> {
    let mut machines = MACHINES.iter();
    let machine = machines.find(|machine| machine.name == name);
    let machine = machine.with_context(|| format!("there is no machine {name}"))?;
    setup::ensure(&machine.needs())?;
    let elf = machine.build(&["--bin", "machines-vehicle", "--features", "vehicle"])?;
    let command = match machine.runs {
        Runs::WebAssembly => {
            let mut node = Command::new("node");
            node.arg(project::root().join("boards/machines/vehicle.mjs"));
            node.arg(&elf);
            node
        }
        Runs::Arm(..) | Runs::RiscV => {
            let mut machine = machine.command(&elf);
            machine.args(["-serial", "stdio"]);
            machine
        }
    };
    Ok((elf, command))
}

impl Machine {
    fn needs(&self) -> [Need; 2] {
        let runs = match self.runs {
            Runs::Arm(..) => Need::Qemu,
            Runs::RiscV => Need::QemuRiscV,
            Runs::WebAssembly => Need::Node,
        };
        [Need::Target(self.target), runs]
    }

    /// Builds and runs the cases: how many there are, and how long they took.
    fn check(&self) -> Result<(usize, Duration)> {
        let elf = self.build(&["--bin", "foxhunt-machines"])?;
        let mut command = self.command(&elf);
        command.args(self.silent());
        let start = Instant::now();
        let output = command
            .stdin(Stdio::null())
            .output()
            .with_context(|| format!("cannot run {}", project::command_line(&command)))?;
        let said = String::from_utf8_lossy(&output.stdout);
        let cases = said.lines().count();
        if !output.status.success() {
            let failed = said.lines().last().unwrap_or("the first case");
            bail!(
                "{failed} fails\n{}",
                String::from_utf8_lossy(&output.stderr)
            );
        }
        Ok((cases, start.elapsed()))
    }

    fn build(&self, what: &[&str]) -> Result<PathBuf> {
        let directory = project::root().join("boards/machines");
        let mut cargo = project::cargo();
        cargo
            .current_dir(&directory)
            .env("FOXHUNT_MACHINE", self.memory)
            // In place of the flags of the emulated board, which has a linker script of its own.
            .env("RUSTFLAGS", self.flags);
        let release = ["--release", "--locked", "--target", self.target];
        project::executable_by(cargo, &[&release, what].concat())
    }

    /// No UART is used, if it has any.
    fn silent(&self) -> &[&str] {
        match self.runs {
            Runs::WebAssembly => &[],
            Runs::Arm(..) | Runs::RiscV => &["-serial", "none"],
        }
    }

    fn command(&self, file: &Path) -> Command {
        let mut command = match self.runs {
            Runs::Arm(board, core) => {
                let mut qemu = Command::new("qemu-system-arm");
                qemu.args(["-machine", board, "-cpu", core]);
                qemu
            }
            Runs::RiscV => {
                let mut qemu = Command::new("qemu-system-riscv32");
                qemu.args(["-machine", "virt", "-bios", "none"]);
                qemu
            }
            Runs::WebAssembly => {
                let mut node = Command::new("node");
                node.arg(project::root().join("boards/machines/run.mjs"));
                node.arg(file);
                return node;
            }
        };
        command.args(["-display", "none", "-monitor", "none"]);
        command.args(["-semihosting-config", "enable=on,target=native"]);
        command.arg("-kernel").arg(file);
        command
    }
}
