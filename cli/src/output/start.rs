//! Begins outputs.

use std::{sync::Arc, time::Duration};

use anyhow::Result;
use tokio::{task::JoinHandle, time::timeout};

use super::{form::Formatter, mqtt, sink};
use crate::{
    live::{Status, hub::Reader},
    settings::{Output, Settings, Sink},
};

/// Begins an output; its task ends when there are no more results.
///
/// # Errors
/// If it cannot be begun; what may come later, such as a server, is waited for.
pub async fn start(
    settings: &Settings,
    output: &Output,
    reader: Reader,
    status: Arc<Status>,
) -> Result<JoinHandle<()>> {
    let formatter = |form| Formatter::new(form, &settings.name, reader_run(&reader));
    Ok(match output.sink()? {
        Sink::Mqtt(mqtt) => mqtt::start(&mqtt, &settings.name, reader, status)?,
        Sink::Stdout(form) => sink::stdout_lines(formatter(form), reader, status),
        Sink::Udp(form, address) => sink::udp(formatter(form), address, reader, status).await?,
        Sink::Tcp(form, address) => sink::tcp(formatter(form), address, reader, status),
        Sink::TcpListen(form, address) => {
            sink::tcp_listen(formatter(form), address, reader, status).await?
        }
        Sink::File(form, file) => sink::file(formatter(form), &file, reader, status).await?,
    })
}

/// Tells the numbers of this run from those of others.
fn reader_run(reader: &Reader) -> u64 {
    reader.after()
}

/// Waits a little until outputs have sent what there is.
pub async fn settled(outputs: Vec<JoinHandle<()>>) {
    const PATIENCE: Duration = Duration::from_secs(5);
    let all = futures_util::future::join_all(outputs);
    // Who is not done by then is not waited for.
    let _ = timeout(PATIENCE, all).await;
}
