//! Connections of browsers and others, as many as this machine can bear.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    time::Duration,
};

use axum::{Router, body::Body, extract::Request};
use hyper::{body::Incoming, server::conn::http1, service::service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::{net::TcpListener, task::AbortHandle};
use tower_service::Service;

/// The most at once. Beyond, the oldest of those that have asked for nothing is closed, so that idle ones keep nobody out.
const MOST: usize = 400;

/// How long the head of a request may take.
const HEAD: Duration = Duration::from_secs(10);

struct Connection {
    task: AbortHandle,
    has_asked: Arc<AtomicBool>,
}

/// Serves until the program ends.
pub async fn serve(listener: TcpListener, app: Router) {
    let mut open: VecDeque<Connection> = VecDeque::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Such as too many open files.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        open.retain(|connection| !connection.task.is_finished());
        if open.len() >= MOST {
            let idle = |connection: &Connection| !connection.has_asked.load(Relaxed);
            let Some(oldest) = open.iter().position(idle) else {
                continue;
            };
            if let Some(connection) = open.remove(oldest) {
                connection.task.abort();
            }
        }
        let has_asked = Arc::new(AtomicBool::new(false));
        let (app, asked) = (app.clone(), has_asked.clone());
        let task = tokio::spawn(async move {
            let service = service_fn(move |request: Request<Incoming>| {
                asked.store(true, Relaxed);
                // A router is always ready.
                app.clone().call(request.map(Body::new))
            });
            // What is no request is answered by 400, or not at all.
            let _ = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEAD)
                .max_buf_size(1 << 16)
                .serve_connection(TokioIo::new(stream), service)
                .await;
        });
        open.push_back(Connection {
            task: task.abort_handle(),
            has_asked,
        });
    }
}
