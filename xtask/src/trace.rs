//! A whole drive through the firmware in the emulator and through the same gateway on the host.

use std::{fs, time::Duration};

use anyhow::{Context, Result, ensure};
use foxhunt_host::replay::Replay;

use crate::{
    demo::{EXAMPLE, QUERY, has_status},
    project,
    qemu::Machine,
};

/// Fails unless the firmware answers a drive byte for byte as the host does.
pub fn compare() -> Result<()> {
    let mut bytes = fs::read(project::root().join(EXAMPLE))?;
    bytes.extend(QUERY);
    let host = Replay::of(&bytes);

    let mut machine = Machine::boot(&project::firmware("vehicle")?, Duration::from_secs(120))?;
    machine.send(&bytes)?;
    let mut board = Vec::new();
    while !has_status(&board) {
        board.extend(
            machine
                .receive()
                .context("the firmware ended before the drive did")?,
        );
    }

    let lines = |output: &[u8]| String::from_utf8_lossy(output).into_owned();
    let (board, host) = (lines(&board), lines(host.output()));
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
