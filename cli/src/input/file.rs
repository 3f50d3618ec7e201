//! A file that another program adds to.

use std::{io::SeekFrom, path::PathBuf, time::Duration};

use tokio::{
    fs::File,
    io::{AsyncReadExt, AsyncSeekExt},
    time::sleep,
};

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// From one look to the next.
const PAUSE: Duration = Duration::from_millis(100);

/// Reads what is added; from the beginning, if a file is begun anew.
pub async fn run(path: PathBuf, from_beginning: bool, feed: Feed) {
    let mut from_beginning = from_beginning;
    again(&feed.status, || {
        let begins = std::mem::replace(&mut from_beginning, true);
        read(&path, begins, &feed)
    })
    .await;
}

async fn read(path: &PathBuf, from_beginning: bool, feed: &Feed) -> Result<Never, Failure> {
    let name = path.display();
    let cannot = |error| Failure::closed(format!("{name}: {error}"));
    let mut file = File::open(path).await.map_err(cannot)?;
    let mut at = 0;
    if !from_beginning {
        at = file.seek(SeekFrom::End(0)).await.map_err(cannot)?;
    }
    feed.status.opened();
    let mut bytes = vec![0; 1 << 14];
    loop {
        match file.read(&mut bytes).await {
            Ok(0) => {
                sleep(PAUSE).await;
                let there = tokio::fs::metadata(path).await;
                if there.is_err() || there.is_ok_and(|there| there.len() < at) {
                    feed.end().await;
                    return Err(Failure::open(format!("{name}: begun anew")));
                }
            }
            Ok(read) => {
                at += read as u64;
                feed.bytes(&bytes[..read]).await;
            }
            Err(error) => return Err(Failure::open(format!("{name}: {error}"))),
        }
    }
}
