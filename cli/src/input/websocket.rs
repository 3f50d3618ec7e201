//! A WebSocket: every message is one of its own.

use futures_util::StreamExt;
use tokio_tungstenite::{connect_async, tungstenite::Message};

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// Reads what a server sends.
pub async fn run(url: String, feed: Feed) {
    again(&feed.status, || read(&url, &feed)).await;
}

async fn read(url: &str, feed: &Feed) -> Result<Never, Failure> {
    let connected = connect_async(url).await;
    let (mut socket, _) = connected.map_err(|error| Failure::closed(format!("{url}: {error}")))?;
    feed.status.opened();
    while let Some(message) = socket.next().await {
        match message {
            Ok(Message::Text(text)) => feed.message(text.as_bytes()).await,
            Ok(Message::Binary(bytes)) => feed.message(&bytes).await,
            Ok(_) => true,
            Err(error) => return Err(Failure::open(format!("{url}: {error}"))),
        };
    }
    Err(Failure::open(format!("{url}: closed")))
}
