//! A whole drive through the firmware in the emulator and through the same gateway on the host.

use std::time::Duration;

use anyhow::{Context, Result, ensure};
use foxhunt_host::{drive, replay::Replay};

use crate::{project, qemu::Machine};

/// The seed of the drive.
const SEED: u64 = 1;
/// Asks for the status, which is therefore the last sentence of a run.
const QUERY: &[u8] = b"$PFOXQ*50\r\n";
const STATUS: &[u8] = b"$PFOXS";

/// Fails unless the firmware answers a drive byte for byte as the host does.
pub fn compare() -> Result<()> {
    let drive = drive::example(SEED);
    let bytes = [drive.bytes(), QUERY].concat();
    let host = Replay::of(&bytes);

    let mut machine = Machine::boot(&project::firmware("vehicle")?, Duration::from_secs(120))?;
    machine.send(&bytes)?;
    let mut board = Vec::new();
    while !is_complete(&board) {
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

/// Whether the last line is the status, and whole.
fn is_complete(output: &[u8]) -> bool {
    let mut lines = output.rsplit(|&byte| byte == b'\n');
    lines.next() == Some(b"") && lines.next().is_some_and(|line| line.starts_with(STATUS))
}
