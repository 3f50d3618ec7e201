//! Serial ports.

use std::{io::ErrorKind, path::PathBuf, time::Duration};

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// Reads a port; opens it again when the device was unplugged.
pub async fn run(path: PathBuf, baud: u32, feed: Feed) {
    again(&feed.status, || read(path.clone(), baud, feed.clone())).await;
}

async fn read(path: PathBuf, baud: u32, feed: Feed) -> Result<Never, Failure> {
    let ending = feed.clone();
    let thread = tokio::task::spawn_blocking(move || blocking(&path, baud, &feed));
    let failure = match thread.await {
        Ok(failure) => failure,
        Err(error) => Failure::open(error),
    };
    ending.end().await;
    Err(failure)
}

fn blocking(path: &std::path::Path, baud: u32, feed: &Feed) -> Failure {
    let name = path.display();
    let port = serialport::new(path.to_string_lossy(), baud)
        .timeout(Duration::from_millis(200))
        .open();
    let mut port = match port {
        Ok(port) => port,
        Err(error) => return Failure::closed(format!("{name}: {error}")),
    };
    feed.status.opened();
    let mut bytes = vec![0; 1 << 12];
    loop {
        match port.read(&mut bytes) {
            Ok(0) => return Failure::open(format!("{name}: closed")),
            Ok(read) => {
                if !feed.bytes_blocking(&bytes[..read]) {
                    return Failure::open("the search is over");
                }
            }
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
            Err(error) => return Failure::open(format!("{name}: {error}")),
        }
    }
}
