//! The gateway of a firmware on the host: a file or the standard input in, the reports out.

use std::io::{Read, Write};

/// Reads to the end.
///
/// # Errors
/// When the file cannot be read or the reports cannot be written.
pub fn run<G, E>(
    mut gateway: G,
    push: impl Fn(&mut G, usize, u8) -> Option<E>,
    report: impl Fn(&G) -> &str,
) -> std::io::Result<()> {
    let input: Box<dyn Read> = match std::env::args_os().nth(1) {
        Some(file) => Box::new(std::fs::File::open(file)?),
        None => Box::new(std::io::stdin()),
    };
    let mut output = std::io::stdout().lock();
    for byte in std::io::BufReader::new(input).bytes() {
        if push(&mut gateway, 0, byte?).is_some() {
            output.write_all(report(&gateway).as_bytes())?;
        }
    }
    Ok(())
}
