//! Lines to terminals, files and networks.

use std::{
    collections::VecDeque,
    path::Path,
    sync::{Arc, Mutex, PoisonError, atomic::Ordering::Relaxed},
    time::Duration,
};

use anyhow::{Context, Result};
use tokio::{
    fs::OpenOptions,
    io::{AsyncWrite, AsyncWriteExt, stdout},
    net::{TcpListener, TcpStream, UdpSocket},
    sync::mpsc,
    task::JoinHandle,
    time::timeout,
};

use super::form::Formatter;
use crate::live::{Status, hub::Reader};

/// How long somebody may take to read a line.
const PATIENCE: Duration = Duration::from_secs(5);

/// Lines for each client.
type Clients = Arc<Mutex<Vec<mpsc::Sender<Arc<str>>>>>;

/// Where lines go.
enum Way {
    Written(Box<dyn AsyncWrite + Send + Unpin>),
    Datagrams(UdpSocket, String),
    Clients(Clients),
}

impl Way {
    /// Sends a line; how many were lost.
    async fn send(&mut self, line: String) -> std::io::Result<u64> {
        match self {
            Self::Written(file) => {
                file.write_all(line.as_bytes()).await?;
                file.flush().await?;
                Ok(0)
            }
            Self::Datagrams(socket, address) => {
                socket
                    .send_to(line.trim_end().as_bytes(), &*address)
                    .await?;
                Ok(0)
            }
            Self::Clients(clients) => {
                let (line, mut lost): (Arc<str>, _) = (line.into(), 0);
                let mut all = clients.lock().unwrap_or_else(PoisonError::into_inner);
                all.retain(|client| match client.try_send(line.clone()) {
                    Ok(()) => true,
                    Err(mpsc::error::TrySendError::Full(_)) => {
                        lost += 1;
                        true
                    }
                    Err(mpsc::error::TrySendError::Closed(_)) => false,
                });
                Ok(lost)
            }
        }
    }
}

/// Hands results on until there are no more.
async fn pump(formatter: Formatter, mut reader: Reader, status: Arc<Status>, mut way: Way) {
    status.opened();
    while let Some((items, lost)) = reader.next().await {
        status.lost.fetch_add(lost, Relaxed);
        for item in items {
            for line in formatter.lines(&item.out, item.seq) {
                match way.send(line + formatter.end()).await {
                    Ok(lost) => {
                        status.sent.fetch_add(1, Relaxed);
                        status.lost.fetch_add(lost, Relaxed);
                        status.heard();
                    }
                    Err(error) => {
                        status.lost.fetch_add(1, Relaxed);
                        status.lost(error);
                    }
                }
            }
            status.read.store(item.seq, Relaxed);
        }
    }
}

/// To the terminal, or whoever reads the standard output.
pub fn stdout_lines(formatter: Formatter, reader: Reader, status: Arc<Status>) -> JoinHandle<()> {
    let way = Way::Written(Box::new(stdout()));
    tokio::spawn(pump(formatter, reader, status, way))
}

/// A datagram for each line.
pub async fn udp(
    formatter: Formatter,
    address: String,
    reader: Reader,
    status: Arc<Status>,
) -> Result<JoinHandle<()>> {
    let socket = UdpSocket::bind("0.0.0.0:0")
        .await
        .context("cannot open a socket")?;
    socket.set_broadcast(true)?;
    socket.set_multicast_ttl_v4(1)?;
    let way = Way::Datagrams(socket, address);
    Ok(tokio::spawn(pump(formatter, reader, status, way)))
}

/// Adds to a file.
pub async fn file(
    formatter: Formatter,
    file: &Path,
    reader: Reader,
    status: Arc<Status>,
) -> Result<JoinHandle<()>> {
    let mut open = OpenOptions::new();
    let opened = open.create(true).append(true).open(file).await;
    let file = opened.with_context(|| format!("cannot write {}", file.display()))?;
    let way = Way::Written(Box::new(file));
    Ok(tokio::spawn(pump(formatter, reader, status, way)))
}

/// To a server; connects again when it was lost.
pub fn tcp(
    formatter: Formatter,
    address: String,
    mut reader: Reader,
    status: Arc<Status>,
) -> JoinHandle<()> {
    /// Lines that wait for the server at most.
    const WAITING: usize = 1_000;
    tokio::spawn(async move {
        let end = formatter.end();
        let mut waiting: VecDeque<String> = VecDeque::new();
        let mut stream: Option<TcpStream> = None;
        let mut tried = tokio::time::Instant::now() - PATIENCE;
        loop {
            let next = timeout(Duration::from_secs(1), reader.next()).await;
            match next {
                Ok(None) => return,
                Ok(Some((items, lost))) => {
                    status.lost.fetch_add(lost, Relaxed);
                    for item in items {
                        waiting.extend(formatter.lines(&item.out, item.seq));
                        status.read.store(item.seq, Relaxed);
                    }
                }
                Err(_) => {}
            }
            while waiting.len() > WAITING {
                waiting.pop_front();
                status.lost.fetch_add(1, Relaxed);
            }
            status.queued.store(waiting.len() as u64, Relaxed);
            if stream.is_none() && tried.elapsed() >= Duration::from_secs(1) {
                tried = tokio::time::Instant::now();
                match timeout(PATIENCE, TcpStream::connect(&address)).await {
                    Ok(Ok(open)) => {
                        status.opened();
                        stream = Some(open);
                    }
                    Ok(Err(error)) => status.lost(format_args!("{address}: {error}")),
                    Err(_) => status.lost(format_args!("{address}: no answer")),
                }
            }
            if let Some(open) = &mut stream {
                while let Some(line) = waiting.front() {
                    let line = format!("{line}{end}");
                    match timeout(PATIENCE, open.write_all(line.as_bytes())).await {
                        Ok(Ok(())) => {
                            waiting.pop_front();
                            status.sent.fetch_add(1, Relaxed);
                        }
                        _ => {
                            status.lost(format_args!("{address}: closed"));
                            stream = None;
                            break;
                        }
                    }
                }
            }
            status.queued.store(waiting.len() as u64, Relaxed);
        }
    })
}

/// To all who connect.
pub async fn tcp_listen(
    formatter: Formatter,
    address: String,
    reader: Reader,
    status: Arc<Status>,
) -> Result<JoinHandle<()>> {
    /// The most who may be connected, and the lines that wait for each.
    const CLIENTS: usize = 100;
    const WAITING: usize = 1_000;
    let listener = TcpListener::bind(&address)
        .await
        .with_context(|| format!("cannot listen at {address}"))?;
    let clients = Clients::default();
    let joined = clients.clone();
    tokio::spawn(async move {
        loop {
            let Ok((mut stream, _)) = listener.accept().await else {
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            };
            let (sender, mut lines) = mpsc::channel::<Arc<str>>(WAITING);
            let mut all = joined.lock().unwrap_or_else(PoisonError::into_inner);
            all.retain(|client| !client.is_closed());
            if all.len() >= CLIENTS {
                continue;
            }
            all.push(sender);
            drop(all);
            tokio::spawn(async move {
                while let Some(line) = lines.recv().await {
                    let sent = timeout(PATIENCE, stream.write_all(line.as_bytes())).await;
                    if !matches!(sent, Ok(Ok(()))) {
                        break;
                    }
                }
            });
        }
    });
    let way = Way::Clients(clients);
    Ok(tokio::spawn(pump(formatter, reader, status, way)))
}
