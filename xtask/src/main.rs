//! The tasks of this repository.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

mod board;
mod boards;
mod book;
mod chapter;
mod choice;
mod constants;
mod cost;
mod damage;
mod demo;
mod drive;
mod expected;
mod features;
mod ffi;
mod figures;
mod fuzz;
mod house;
mod kernels;
mod llvm;
mod load;
mod machines;
mod marks;
mod measure;
mod monitor;
mod mutants;
mod page;
mod papers;
mod project;
mod qemu;
mod release;
mod replay;
mod reports;
mod reset;
mod restarts;
mod setup;
mod steps;
mod test;
mod trace;
mod tunnel;

/// The tasks of this repository.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Task {
    /// Install what the tasks need: Rust targets and components, and the emulator.
    Setup,
    /// Check everything: style, tests here and on the emulated board, panics, features, cost.
    Test(test::Options),
    /// Check what takes too long for every change: the package, its dependencies, and machines of other cores.
    Release(release::Options),
    /// Check how the code is laid out: files need each other one way, are short, and keep to the glossary.
    House,
    /// Count the library's lines of code and its public types.
    Count,
    /// Measure what the library and its firmware take, beside other filters.
    Cost(cost::Options),
    /// Locate a transmitter with the vehicle firmware in the emulator, and draw it.
    Demo(demo::Options),
    /// Run the portable tests, a whole drive and a whole walk on emulated machines of other cores.
    Machines(machines::Options),
    /// Measure the firmwares of real boards, and name what could panic in them.
    Boards(boards::Options),
    /// Send the recorded drive through every build of the vehicle's gateway: all must say the same.
    Replay,
    /// Check the library for C and its header, with programs in C on this computer and on the emulated board.
    C(ffi::Options),
    /// Damage sentences of real receivers, and count the wrong positions that a vehicle's gateway believes.
    Damage(damage::Options),
    /// Look for faults of the gateways and the map reader with random input.
    Fuzz(fuzz::Options),
    /// Put small faults into the library, one at a time, and count those that its tests do not notice.
    Mutants(mutants::Options),
    /// Publish the tags of many gateways through a broker, faster and faster, until it is too much.
    Load(load::Options),
    /// Kill and restart sources and a broker at random while `foxhunt live` runs: nothing acknowledged is lost.
    Restarts(restarts::Options),
    /// Simulate the drive of the demo again, from its seed, and write its file.
    Drive,
    /// Simulate the radio map and the packets of the tunnel's demo again, from their seed, and write their files.
    Tunnel,
    /// Build the WebAssembly of the page.
    Page(page::Options),
    /// Reproduce published results, and compare with their figures.
    Papers(papers::Options),
}

fn main() -> ExitCode {
    match run(Task::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<()> {
    match task {
        Task::Setup => setup::run(),
        Task::Test(options) => test::run_all(&options),
        Task::Release(options) => release::run_all(&options),
        Task::House => house::check(),
        Task::Count => house::print_count(),
        Task::Cost(options) => cost::run(&options),
        Task::Demo(options) => demo::run(&options),
        Task::Mutants(options) => mutants::run(&options),
        Task::Load(options) => load::run(&options),
        Task::Restarts(options) => restarts::run(&options),
        Task::Drive => drive::run(),
        Task::Tunnel => tunnel::run(),
        Task::Machines(options) => machines::run(&options),
        Task::Boards(options) => boards::run(&options),
        Task::Replay => replay::run(),
        Task::C(options) => ffi::run(&options),
        Task::Damage(options) => damage::run(&options),
        Task::Fuzz(options) => fuzz::run(&options),
        Task::Page(options) => page::run_task(&options),
        Task::Papers(options) => papers::run(&options),
    }
}
