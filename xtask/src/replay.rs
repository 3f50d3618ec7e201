//! The task `replay`: the recorded drive through every build of the vehicle's gateway.

use std::{fs, path::Path, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use comfy_table::Table;
use foxhunt_host::replay::Replay;

use crate::{
    board::{self, PLAIN, QUERY, ensure_same},
    boards,
    drive::EXAMPLE,
    ffi, machines,
    measure::panic_sites,
    project,
    qemu::Machine,
};

/// Longer than a drive takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// The main loop of real boards runs under an executor on these cores.
const AWAITED: [&str; 2] = ["Cortex-M33", "Cortex-M4F"];

/// Runs it everywhere, and fails unless all say the same.
pub fn run() -> Result<()> {
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let host = Replay::of(&drive).output().to_vec();
    ensure!(
        host.windows(7).any(|bytes| bytes == b"\n$PFOXF"),
        "nothing was found"
    );
    let mut table = Table::new();
    table.set_header(["the drive through", "bytes of reports", "digest"]);
    let mut add = |what: &str, said: &[u8]| -> Result<()> {
        ensure_same(said, &host).with_context(|| what.to_owned())?;
        let digest = format!("{:016x}", digest(said));
        table.add_row([what, &said.len().to_string(), &digest]);
        Ok(())
    };
    add("this computer", &host)?;
    let emulated = project::firmware(PLAIN)?;
    let mut machine = Machine::boot(&emulated, LIMIT)?;
    add("the emulated board", &asked(&mut machine, &drive)?)?;
    for core in AWAITED {
        let (elf, command) = machines::vehicle(core)?;
        no_panic(&elf)?;
        let mut machine = Machine::start(command, LIMIT)?;
        let what = format!("the main loop of boards, with Embassy, on a {core}");
        add(&what, &asked(&mut machine, &drive)?)?;
    }
    add(
        "the firmware of the STM32F411, on an emulated STM32F405",
        &stm32f4(&drive)?,
    )?;
    let [on_board, on_host] = ffi::replays()?;
    add("the example in C, on the emulated board", &on_board)?;
    add("the example in C, on this computer", &on_host)?;
    add("WebAssembly", &web()?)?;
    println!("{table}");
    Ok(())
}

/// What a machine says to the drive. The query that ends it is answered when all of it has been read.
fn asked(machine: &mut Machine, drive: &[u8]) -> Result<Vec<u8>> {
    let mut said = board::answer(machine, &[drive, QUERY].concat())?;
    let mut replay = Replay::of(drive);
    let length = replay.output().len();
    replay.push(QUERY);
    ensure_same(&said, replay.output())?;
    said.truncate(length);
    Ok(said)
}

/// What the firmware of the STM32F411 says.
fn stm32f4(drive: &[u8]) -> Result<Vec<u8>> {
    let elf = boards::emulated_stm32f4()?;
    // USART1 is that of the receiver, USART2 that of the computer.
    let mut machine = board::stm32f405(&elf, &["null", "stdio"], LIMIT)?;
    board::paced(&mut machine, drive)
}

fn web() -> Result<Vec<u8>> {
    let (_, mut node) = machines::vehicle("WebAssembly")?;
    let output = node.arg(project::root().join(EXAMPLE)).output()?;
    if !output.status.success() {
        bail!("{}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(output.stdout)
}

/// Fails if the main loop or the gateway could panic.
fn no_panic(elf: &Path) -> Result<()> {
    let sites = panic_sites::find(elf, &project::root().join("boards/machines"))?;
    // Nothing asynchronous is without.
    ensure!(!sites.is_empty(), "no lines were found");
    let sites = sites.iter().filter(|site| !site.is_awaited);
    let lines: Vec<&str> = sites.map(|site| site.line.as_str()).collect();
    ensure!(
        lines.is_empty(),
        "these could panic:\n  {}",
        lines.join("\n  ")
    );
    Ok(())
}

/// A 64-bit FNV-1a hash, as of the portable tests.
fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
