//! The raw log: every piece that came in, with its time and its input, in lines of JSON.
//!
//! The first line has the settings, so that a replay is told the same. Bytes stand in a text whose characters U+0000 to U+00FF
//! are the bytes: lines are legible, and nothing is lost.

mod merge;
mod write;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::{
    engine::{Command, Piece, What},
    settings::Settings,
};
pub use merge::merged;
pub use write::Writer;

/// The version of the format.
const VERSION: u32 = 1;

/// The first line.
#[derive(Debug, Serialize, Deserialize)]
struct Head {
    foxhunt: u32,
    settings: String,
}

/// Any other line.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Entry {
    /// Milliseconds after 1970.
    t: i64,
    /// The number of the input.
    #[serde(rename = "in", skip_serializing_if = "Option::is_none", default)]
    input: Option<usize>,
    /// Bytes of a stream.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    bytes: Option<String>,
    /// A message of its own.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    message: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    end: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    retract: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    undo: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    mark: Option<(f64, f64, String)>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    unmark: Option<u64>,
}

fn text(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

fn bytes(text: &str) -> Option<Vec<u8>> {
    text.chars().map(|c| u8::try_from(c).ok()).collect()
}

impl Entry {
    fn of(piece: &Piece) -> Self {
        let t = piece.time_ms;
        let entry = Self {
            t,
            ..Self::default()
        };
        match &piece.what {
            What::Bytes {
                input,
                bytes,
                is_message,
            } => {
                let text = Some(text(bytes));
                let (bytes, message) = if *is_message {
                    (None, text)
                } else {
                    (text, None)
                };
                Self {
                    input: Some(*input),
                    bytes,
                    message,
                    ..entry
                }
            }
            What::End { input } => Self {
                input: Some(*input),
                end: Some(true),
                ..entry
            },
            What::Command(Command::Retract(id)) => Self {
                retract: Some(*id),
                ..entry
            },
            What::Command(Command::Undo) => Self {
                undo: Some(true),
                ..entry
            },
            What::Command(Command::Mark {
                latitude,
                longitude,
                text,
            }) => Self {
                mark: Some((*latitude, *longitude, text.clone())),
                ..entry
            },
            What::Command(Command::Unmark(id)) => Self {
                unmark: Some(*id),
                ..entry
            },
        }
    }

    fn piece(self) -> Option<Piece> {
        let command = |command| Some(What::Command(command));
        let what = match self {
            Self {
                input: Some(input),
                bytes: Some(text),
                ..
            } => Some(What::Bytes {
                input,
                bytes: bytes(&text)?,
                is_message: false,
            }),
            Self {
                input: Some(input),
                message: Some(text),
                ..
            } => Some(What::Bytes {
                input,
                bytes: bytes(&text)?,
                is_message: true,
            }),
            Self {
                input: Some(input),
                end: Some(_),
                ..
            } => Some(What::End { input }),
            Self {
                retract: Some(id), ..
            } => command(Command::Retract(id)),
            Self { undo: Some(_), .. } => command(Command::Undo),
            Self {
                mark: Some((latitude, longitude, text)),
                ..
            } => command(Command::Mark {
                latitude,
                longitude,
                text,
            }),
            Self {
                unmark: Some(id), ..
            } => command(Command::Unmark(id)),
            _ => None,
        };
        Some(Piece {
            time_ms: self.t,
            what: what?,
        })
    }
}

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

/// The files of a log that was rotated, the oldest first: `log.2.jsonl`, `log.1.jsonl`, `log.jsonl`.
pub fn rotated(file: &Path, number: u32) -> PathBuf {
    if number == 0 {
        return file.to_owned();
    }
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    match file.extension() {
        Some(ending) => {
            file.with_file_name(format!("{stem}.{number}.{}", ending.to_string_lossy()))
        }
        None => file.with_file_name(format!("{stem}.{number}")),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_survive() {
        let all: Vec<u8> = (0..=255).collect();
        let bytes = |bytes: Vec<u8>, is_message| What::Bytes {
            input: 3,
            bytes,
            is_message,
        };
        let mark = Command::Mark {
            latitude: 1.5,
            longitude: -2.25,
            text: "here \u{20ac}".into(),
        };
        for what in [
            bytes(all.clone(), false),
            bytes(all, true),
            What::End { input: 3 },
            What::Command(Command::Retract(7)),
            What::Command(Command::Undo),
            What::Command(mark),
            What::Command(Command::Unmark(1)),
        ] {
            let piece = Piece { time_ms: 9, what };
            let line = serde_json::to_string(&Entry::of(&piece)).unwrap();
            assert!(!line.contains('\n'));
            let entry: Entry = serde_json::from_str(&line).unwrap();
            assert_eq!(entry.piece(), Some(piece));
        }
    }

    #[test]
    fn rotated_files_keep_their_ending() {
        assert_eq!(
            rotated(Path::new("a/log.jsonl"), 2),
            Path::new("a/log.2.jsonl")
        );
        assert_eq!(rotated(Path::new("log"), 1), Path::new("log.1"));
        assert_eq!(rotated(Path::new("log.x"), 0), Path::new("log.x"));
    }
}
