//! The standard input.

use std::io::{ErrorKind, Read};

use super::feed::Feed;

/// Reads it to its end.
pub async fn run(feed: Feed) {
    let reader = feed.clone();
    reader.status.opened();
    // It cannot be waited for otherwise on every system.
    let read = tokio::task::spawn_blocking(move || {
        let mut bytes = vec![0; 1 << 14];
        loop {
            match std::io::stdin().read(&mut bytes) {
                Ok(0) => break,
                Ok(read) => {
                    if !reader.bytes_blocking(&bytes[..read]) {
                        break;
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => break,
            }
        }
    });
    let _ = read.await;
    feed.end().await;
    feed.status.ended();
}
