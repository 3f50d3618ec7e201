//! The way of an input to the search.

use std::sync::Arc;

use crate::{
    engine::{Piece, What},
    live::{Ask, Search, Status, now_ms},
};

/// The way of an input to the search.
#[derive(Clone)]
pub struct Feed {
    input: usize,
    search: Search,
    /// How it does.
    pub status: Arc<Status>,
}

impl Feed {
    /// Of an input, by its number.
    pub fn new(input: usize, search: Search, status: Arc<Status>) -> Self {
        Self {
            input,
            search,
            status,
        }
    }

    fn piece(&self, bytes: &[u8], is_message: bool) -> Piece {
        self.status.heard();
        Piece {
            time_ms: now_ms(),
            what: What::Bytes {
                input: self.input,
                bytes: bytes.to_vec(),
                is_message,
            },
        }
    }

    /// Bytes of a stream; false if the search is over.
    pub async fn bytes(&self, bytes: &[u8]) -> bool {
        let piece = self.piece(bytes, false);
        self.search.send(Ask::Piece(piece, None)).await
    }

    /// The same from a thread.
    pub fn bytes_blocking(&self, bytes: &[u8]) -> bool {
        let piece = self.piece(bytes, false);
        self.search.send_blocking(Ask::Piece(piece, None))
    }

    /// A message of its own; false if the search is over.
    pub async fn message(&self, bytes: &[u8]) -> bool {
        let piece = self.piece(bytes, true);
        self.search.send(Ask::Piece(piece, None)).await
    }

    /// A message of its own, and what became of it.
    ///
    /// # Errors
    /// Why it was of no use.
    pub async fn taken(&self, bytes: &[u8]) -> Result<u64, String> {
        self.search.taken(self.piece(bytes, true)).await
    }

    /// A stream has ended.
    pub async fn end(&self) {
        let what = What::End { input: self.input };
        let time_ms = now_ms();
        let piece = Piece { time_ms, what };
        self.search.send(Ask::Piece(piece, None)).await;
    }
}
