//! The firmwares of the emulated board, and what they answer.

use std::{path::Path, process::Command, time::Duration};

use anyhow::{Context, Result, ensure};
use foxhunt_host::replay::Replay;

use crate::{
    qemu::Machine,
    reports::vehicle::{self, Report},
};

/// The firmware of a vehicle for bearings of which none is wrong.
pub const PLAIN: &str = "vehicle";

/// The firmware of a vehicle for bearings of which some are wrong.
pub const ROBUST: &str = "vehicle_robust";

/// The firmware that goes on after a reset.
pub const KEPT: &str = "vehicle_kept";

/// The firmwares of a vehicle: with the locator's own moves, for bearings of which some are wrong, also over a reset, and
/// with each refinement.
pub const VEHICLES: [&str; 6] = [
    PLAIN,
    ROBUST,
    KEPT,
    "vehicle_fish",
    "vehicle_firefly",
    "vehicle_evolution",
];

/// The firmware of a tunnel that reads lines.
pub const BEACON: &str = "beacon_gateway";

/// The firmwares of a tunnel, which read lines or frames.
pub const BEACONS: [&str; 2] = [BEACON, "beacon_gateway_frames"];

/// Asks a gateway for its answer and its status.
pub const QUERY: &[u8] = b"$PFOXQ*50\r\n";

/// Sends bytes that end with the query, and returns what the firmware sends, up to its status.
pub fn answer(machine: &mut Machine, bytes: &[u8]) -> Result<Vec<u8>> {
    machine.send(bytes)?;
    let mut output = Vec::new();
    while !has_status(&output) {
        let received = machine.receive();
        output.extend(received.context("the firmware ended before it answered")?);
    }
    Ok(output)
}

/// Boots a firmware on an emulated STM32F405, whose UARTs from the first on are these arguments of QEMU.
pub fn stm32f405(elf: &Path, uarts: &[&str], limit: Duration) -> Result<Machine> {
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "netduinoplus2"]);
    qemu.args(["-display", "none", "-monitor", "none"]);
    qemu.args(uarts.iter().flat_map(|uart| ["-serial", uart]));
    qemu.arg("-kernel").arg(elf);
    Machine::start(qemu, limit)
}

/// What a firmware whose interrupts fill queues says to a drive. The queues bear what comes at the pace of a real line; here,
/// each bearing is answered before more is sent.
pub fn paced(machine: &mut Machine, drive: &[u8]) -> Result<Vec<u8>> {
    let (mut replay, mut said) = (Replay::default(), Vec::new());
    let mut unsent = drive;
    while !unsent.is_empty() {
        let before = replay.output().len();
        let answered = unsent.iter().position(|byte| {
            replay.push(&[*byte]);
            replay.output().len() > before
        });
        let (now, later) = unsent.split_at(answered.map_or(unsent.len(), |last| last + 1));
        unsent = later;
        machine.send(now)?;
        while said.len() < replay.output().len() {
            let bytes = machine.receive();
            said.extend(bytes.context("the firmware ended before it answered")?);
        }
    }
    Ok(said)
}

/// Whether the output ends with the answer to the query.
pub fn has_status(output: &[u8]) -> bool {
    let reports = || vehicle::parse(output).into_iter();
    output.ends_with(b"\n") && reports().any(|report| matches!(report, Report::Status(_)))
}

/// Fails unless it was said what is expected, and then names the first line that differs.
pub fn ensure_same(said: &[u8], expected: &[u8]) -> Result<()> {
    let [said, expected] = [said, expected].map(String::from_utf8_lossy);
    for (number, (said, expected)) in said.lines().zip(expected.lines()).enumerate() {
        let line = number + 1;
        ensure!(
            said == expected,
            "reports differ in line {line}\nsaid:     {said}\nexpected: {expected}"
        );
    }
    ensure!(
        said == expected,
        "there are {} bytes of reports, expected are {}",
        said.len(),
        expected.len()
    );
    Ok(())
}
