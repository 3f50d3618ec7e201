//! TCP: of a server, or of clients.

use std::sync::Arc;

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{TcpListener, TcpStream},
    sync::Semaphore,
};

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// Bytes that are read at a time.
const PIECE: usize = 1 << 14;

/// Reads from a server, to which `hello` is sent first.
pub async fn connect(address: String, hello: &[u8], feed: Feed) {
    again(&feed.status, || read(&address, hello, &feed)).await;
}

async fn read(address: &str, hello: &[u8], feed: &Feed) -> Result<Never, Failure> {
    let cannot = |error| Failure::closed(format!("{address}: {error}"));
    let mut stream = TcpStream::connect(address).await.map_err(cannot)?;
    // Where nobody listens, the system may choose that port for this end, too.
    if stream.local_addr().ok() == stream.peer_addr().ok() {
        return Err(Failure::closed(format!("{address}: nobody listens")));
    }
    stream.write_all(hello).await.map_err(cannot)?;
    feed.status.opened();
    let mut bytes = vec![0; PIECE];
    let mut total = 0;
    let why = loop {
        match stream.read(&mut bytes).await {
            Ok(0) => break format!("{address}: closed"),
            Ok(read) => {
                total += read;
                if !feed.bytes(&bytes[..read]).await {
                    std::future::pending::<()>().await;
                }
            }
            Err(error) => break format!("{address}: {error}"),
        }
    };
    feed.end().await;
    // Who closes at once is not open.
    Err(if total > 0 {
        Failure::open(why)
    } else {
        Failure::closed(why)
    })
}

/// Takes whole lines of all who connect.
pub async fn listen(address: String, feed: Feed) {
    again(&feed.status, || accept(&address, &feed)).await;
}

async fn accept(address: &str, feed: &Feed) -> Result<Never, Failure> {
    /// The most clients at once.
    const CLIENTS: usize = 256;
    let cannot = |error| Failure::closed(format!("{address}: {error}"));
    let listener = TcpListener::bind(address).await.map_err(cannot)?;
    feed.status.opened();
    let places = Arc::new(Semaphore::new(CLIENTS));
    loop {
        let place = places.clone().acquire_owned().await;
        match listener.accept().await {
            Ok((stream, _)) => {
                let feed = feed.clone();
                tokio::spawn(async move {
                    lines(stream, &feed).await;
                    drop(place);
                });
            }
            // Such as too many open files.
            Err(_) => tokio::time::sleep(std::time::Duration::from_millis(100)).await,
        }
    }
}

/// Lines of different clients do not mix: each is handed on when it has ended.
async fn lines(mut stream: TcpStream, feed: &Feed) {
    /// The most bytes of a line.
    const LONGEST: usize = 1 << 16;
    let mut kept = Vec::new();
    let mut bytes = vec![0; PIECE];
    while let Ok(read) = stream.read(&mut bytes).await {
        if read == 0 {
            break;
        }
        kept.extend_from_slice(&bytes[..read]);
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        if let Some(end) = kept.iter().rposition(is_end) {
            let rest = kept.split_off(end + 1);
            feed.bytes(&kept).await;
            kept = rest;
        }
        if kept.len() > LONGEST {
            kept.clear();
        }
    }
    if !kept.is_empty() {
        kept.push(b'\n');
        feed.bytes(&kept).await;
    }
}
