//! Begins outputs.

use std::{
    sync::{Arc, atomic::Ordering::Relaxed},
    time::Duration,
};

use anyhow::Result;

use super::{form::Formatter, mqtt, sink};
use crate::{
    live::{
        Status,
        hub::{Hub, Reader},
    },
    settings::{Output, Settings, Sink},
};

/// Begins an output.
///
/// # Errors
/// If it cannot be begun; what may come later, such as a server, is waited for.
pub async fn start(
    settings: &Settings,
    output: &Output,
    reader: Reader,
    status: Arc<Status>,
) -> Result<()> {
    let formatter = |form| Formatter::new(form, &settings.name, reader_run(&reader));
    match output.sink()? {
        Sink::Mqtt(mqtt) => mqtt::start(&mqtt, &settings.name, reader, status)?,
        Sink::Stdout(form) => sink::stdout_lines(formatter(form), reader, status),
        Sink::Udp(form, address) => sink::udp(formatter(form), address, reader, status).await?,
        Sink::Tcp(form, address) => sink::tcp(formatter(form), address, reader, status),
        Sink::TcpListen(form, address) => {
            sink::tcp_listen(formatter(form), address, reader, status).await?;
        }
        Sink::File(form, file) => sink::file(formatter(form), &file, reader, status).await?,
    }
    Ok(())
}

/// Tells the numbers of this run from those of others.
fn reader_run(reader: &Reader) -> u64 {
    reader.after()
}

/// Waits a little until outputs have sent what there is.
pub async fn settled(hub: &Arc<Hub>, outputs: &[Arc<Status>]) {
    let seq = hub.seq();
    for _ in 0..40 {
        let is_sent = |status: &&Arc<Status>| {
            status.read.load(Relaxed) >= seq && status.queued.load(Relaxed) == 0
                || status.state().0 == crate::engine::message::State::Lost
        };
        if outputs.iter().all(|status| is_sent(&status)) {
            break;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}
