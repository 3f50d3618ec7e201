//! Whole drives through the firmware in the emulator and through the same gateway on the host.

use std::{env, fs, path::Path, time::Duration};

use anyhow::{Context, Result, ensure};
use foxhunt_host::{measured::Measured, replay::Replay};

use crate::{
    demo::{DEVIATION_DEGREES, EXAMPLE, QUERY, has_status},
    project,
    qemu::Machine,
};

/// Fails unless the firmware answers the shipped drive, and the measured ones where they are at hand, byte for
/// byte as the host does.
pub fn compare() -> Result<()> {
    compare_drive(fs::read(project::root().join(EXAMPLE))?)?;
    let Some(data) = env::var_os("FOXHUNT_DATA") else {
        println!("measured drives are skipped: FOXHUNT_DATA does not name their directory");
        return Ok(());
    };
    let set = Path::new(&data).join("wsr/los_set_a.csv");
    for transmitter in ["tx2", "tx3", "tx4"] {
        let drive = Measured::read(&set, transmitter)?.drive(DEVIATION_DEGREES)?;
        compare_drive(drive.bytes().to_vec()).context(transmitter)?;
    }
    Ok(())
}

fn compare_drive(mut bytes: Vec<u8>) -> Result<()> {
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
