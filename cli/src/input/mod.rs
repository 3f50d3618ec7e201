//! Where bytes come from.

mod demo;
mod file;
mod http;
mod mqtt;
mod post;
mod serial;
mod stdin;
mod tcp;
mod udp;
mod websocket;

use std::{fmt::Display, future::Future, sync::Arc, time::Duration};

use anyhow::Result;

use crate::{
    engine::{Piece, What},
    live::{Ask, Search, Status, now_ms},
    settings::Source,
};
pub use demo::Demo;

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

/// Reads an input for as long as there is one.
pub async fn run(source: Source, feed: Feed, own: String) {
    match source {
        Source::Serial { path, baud } => serial::run(path, baud, feed).await,
        Source::Tcp(address) => tcp::connect(address, b"", feed).await,
        Source::TcpListen(address) => tcp::listen(address, feed).await,
        Source::Udp(address) => udp::run(address, feed).await,
        Source::File {
            path,
            from_beginning,
        } => file::run(path, from_beginning, feed).await,
        Source::Stdin => stdin::run(feed).await,
        Source::Gpsd(address) => {
            let watch = b"?WATCH={\"enable\":true,\"json\":true};\n";
            tcp::connect(address, watch, feed).await;
        }
        Source::Http { url, every_ms } => http::run(url, every_ms, feed).await,
        Source::HttpListen(address) => post::run(address, feed).await,
        Source::WebSocket(url) => websocket::run(url, feed).await,
        Source::Mqtt(mqtt) => mqtt::run(mqtt, own, feed).await,
    }
}

/// Does something again and again; waits longer after each failure, up to half a minute. The work says by its error that it has
/// failed, and by its success that it ran for a while.
pub async fn again<F>(status: &Status, mut work: impl FnMut() -> F)
where
    F: Future<Output = Result<Never, Failure>>,
{
    const SHORTEST: Duration = Duration::from_millis(250);
    const LONGEST: Duration = Duration::from_secs(30);
    let mut wait = SHORTEST;
    loop {
        let Err(failure) = work().await;
        status.lost(&failure.why);
        if failure.was_open {
            wait = SHORTEST;
        }
        tokio::time::sleep(wait).await;
        wait = LONGEST.min(2 * wait);
    }
}

/// What work that never ends by itself gives.
pub enum Never {}

/// Why an input or output is lost.
pub struct Failure {
    why: String,
    was_open: bool,
}

impl Failure {
    /// It could not be opened.
    pub fn closed(why: impl Display) -> Self {
        Self {
            why: why.to_string(),
            was_open: false,
        }
    }

    /// It was open for a while.
    pub fn open(why: impl Display) -> Self {
        Self {
            why: why.to_string(),
            was_open: true,
        }
    }
}
