//! The gateway of the firmware on the host: a file or the standard input in, the reports out.

use std::io::{Read, Write};

use crate::{Gateway, gateway};

/// Reads to the end.
pub fn run() -> std::io::Result<()> {
    let input: Box<dyn Read> = match std::env::args_os().nth(1) {
        Some(file) => Box::new(std::fs::File::open(file)?),
        None => Box::new(std::io::stdin()),
    };
    let mut gateway: Gateway = gateway();
    let mut output = std::io::stdout().lock();
    for byte in std::io::BufReader::new(input).bytes() {
        if gateway.push(byte?).is_some() {
            output.write_all(gateway.report().as_bytes())?;
        }
    }
    Ok(())
}
