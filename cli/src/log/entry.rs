//! The lines of a raw log.

use serde::{Deserialize, Serialize};

use crate::engine::{Command, Piece, What};

/// The version of the format.
pub const VERSION: u32 = 1;

/// The first line.
#[derive(Debug, Serialize, Deserialize)]
pub struct Head {
    pub foxhunt: u32,
    pub settings: String,
}

/// Any other line.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Entry {
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
    /// The line of a piece.
    pub fn of(piece: &Piece) -> Self {
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

    /// The piece of a line; `None` if it is none.
    pub fn piece(self) -> Option<Piece> {
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
}
