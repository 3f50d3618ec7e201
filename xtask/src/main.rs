//! The tasks of this repository.

use anyhow::Result;
use clap::Parser;

mod demo;
mod figures;
mod llvm;
mod papers;
mod project;
mod qemu;
mod setup;

/// The tasks of this repository.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Task {
    /// Install what the tasks need: Rust targets and components, and the emulator.
    Setup,
    /// Locate a transmitter with the vehicle firmware in the emulator, and draw it.
    Demo(demo::Options),
    /// Reproduce published results, and compare with their figures.
    Papers(papers::Options),
}

fn main() -> Result<()> {
    match Task::parse() {
        Task::Setup => setup::run(),
        Task::Demo(options) => demo::run(&options),
        Task::Papers(options) => papers::run(&options),
    }
}
