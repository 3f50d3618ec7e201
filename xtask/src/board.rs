//! The firmwares of the emulated board, and what they answer.

use anyhow::{Context, Result, ensure};

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

/// Whether the output ends with the answer to the query.
pub fn has_status(output: &[u8]) -> bool {
    let reports = || vehicle::parse(output).into_iter();
    output.ends_with(b"\n") && reports().any(|report| matches!(report, Report::Status(_)))
}

/// Fails unless the board has sent what the host says, and then names the first line that differs.
pub fn ensure_same(board: &[u8], host: &[u8]) -> Result<()> {
    let [board, host] = [board, host].map(String::from_utf8_lossy);
    for (number, (board, host)) in board.lines().zip(host.lines()).enumerate() {
        let line = number + 1;
        ensure!(
            board == host,
            "reports differ in line {line}\nboard: {board}\nhost:  {host}"
        );
    }
    ensure!(
        board == host,
        "the board sent {} bytes, the host {}",
        board.len(),
        host.len()
    );
    Ok(())
}
