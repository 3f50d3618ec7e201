//! What comes in, piece by piece.

/// Something that came in, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// When it came, in milliseconds after 1970; 0 if that is not known.
    pub time_ms: i64,
    /// What.
    pub what: What,
}

/// What came in.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Bytes of an input, by its number.
    Bytes {
        input: usize,
        bytes: Vec<u8>,
        /// They are a message of their own, such as a datagram, and not a part of a stream.
        is_message: bool,
    },
    /// The stream of an input has ended; another may begin.
    End { input: usize },
    /// Something that somebody asks for.
    Command(Command),
}

/// What somebody asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// A bearing is to be taken back.
    Retract(u64),
    /// The last bearing, or the last retract, is to be taken back.
    Undo,
    /// A place is marked.
    Mark {
        latitude: f64,
        longitude: f64,
        text: String,
    },
    /// A mark is removed.
    Unmark(u64),
}
