//! The raw log: every piece that came in, with its time and its input, in lines of JSON.
//!
//! The first line has the settings, so that a replay is told the same. Bytes stand in a text whose characters U+0000 to U+00FF
//! are the bytes: lines are legible, and nothing is lost.

mod entry;
mod merge;
mod write;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read},
    path::Path,
};

use anyhow::{Context, Result, bail, ensure};

use crate::{engine::Piece, settings::Settings};
use entry::{Entry, Head, VERSION};
pub use merge::merged;
pub use write::Writer;

/// A log to read.
pub enum Log {
    /// A raw log, with the settings of the search.
    Raw {
        /// What the search was told.
        settings: Box<Settings>,
        /// What came in.
        pieces: Pieces,
    },
    /// The bytes of a line, as they came.
    Bytes(Box<dyn Read>),
}

/// The pieces of a raw log.
pub struct Pieces {
    name: String,
    number: usize,
    lines: Box<dyn BufRead>,
}

/// Bytes at the beginning of a raw log.
const BEGINNING: &[u8] = b"{\"foxhunt\":";

/// The most bytes of a line.
const LONGEST: u64 = 1 << 24;

/// Opens a log; `-` is the standard input. The number of its bytes, if that is known.
///
/// # Errors
/// If it cannot be opened, or is damaged at its beginning.
pub fn open(file: &Path) -> Result<(Log, Option<u64>)> {
    let name = name(file);
    let (input, size): (Box<dyn Read>, _) = if file == Path::new("-") {
        (Box::new(io::stdin()), None)
    } else {
        let file = File::open(file).with_context(|| format!("cannot open {name}"))?;
        let size = file.metadata()?.len();
        (Box::new(file), Some(size))
    };
    let mut lines = BufReader::new(input);
    let beginning = peek(&mut lines, &name)?;
    if !beginning.starts_with(BEGINNING) {
        return Ok((Log::Bytes(Box::new(beginning_and(beginning, lines))), size));
    }
    let mut lines: Box<dyn BufRead> = Box::new(BufReader::new(beginning_and(beginning, lines)));
    let mut line = Vec::new();
    (&mut lines)
        .take(LONGEST)
        .read_until(b'\n', &mut line)
        .with_context(|| format!("cannot read {name}"))?;
    let head: Head =
        serde_json::from_slice(&line).with_context(|| format!("{name}:1: no head of a log"))?;
    ensure!(
        head.foxhunt == VERSION,
        "{name}:1: a log of version {}; this program reads version {VERSION}",
        head.foxhunt
    );
    let settings = Settings::of_text(&head.settings).with_context(|| format!("{name}:1"))?;
    let pieces = Pieces {
        name,
        number: 1,
        lines,
    };
    let settings = Box::new(settings);
    Ok((Log::Raw { settings, pieces }, size))
}

fn beginning_and(beginning: Vec<u8>, rest: BufReader<Box<dyn Read>>) -> impl Read {
    io::Cursor::new(beginning).chain(rest)
}

/// The first bytes.
fn peek(lines: &mut impl Read, name: &str) -> Result<Vec<u8>> {
    let mut beginning = Vec::new();
    lines
        .take(BEGINNING.len() as u64)
        .read_to_end(&mut beginning)
        .with_context(|| format!("cannot read {name}"))?;
    Ok(beginning)
}

/// A log as people call it.
pub fn name(file: &Path) -> String {
    if file == Path::new("-") {
        "standard input".into()
    } else {
        file.display().to_string()
    }
}

impl Iterator for Pieces {
    type Item = Result<(Piece, u64)>;

    /// The next piece and the number of bytes of its line.
    fn next(&mut self) -> Option<Self::Item> {
        let mut line = Vec::new();
        self.number += 1;
        let read = (&mut self.lines).take(LONGEST).read_until(b'\n', &mut line);
        let (name, number) = (&self.name, self.number);
        match read.with_context(|| format!("cannot read {name}")) {
            Ok(0) => return None,
            Ok(_) => {}
            Err(error) => return Some(Err(error)),
        }
        // The last line of a program that was killed may lack its end.
        let is_cut = !line.ends_with(b"\n");
        let entry: Option<Entry> = serde_json::from_slice(&line).ok();
        match entry.and_then(Entry::piece) {
            Some(piece) => Some(Ok((piece, line.len() as u64))),
            None if is_cut => None,
            None => {
                let error = anyhow::anyhow!("{name}:{number}: this line is no piece of a log");
                Some(Err(error))
            }
        }
    }
}

/// Fails for a log that holds no bytes of a line.
pub fn bytes_of(log: Log, name: &str) -> Result<Vec<u8>> {
    match log {
        Log::Bytes(mut input) => {
            let mut bytes = Vec::new();
            input
                .read_to_end(&mut bytes)
                .with_context(|| format!("cannot read {name}"))?;
            Ok(bytes)
        }
        Log::Raw { .. } => bail!("{name} is a raw log: it is replayed alone, or with its own kind"),
    }
}
