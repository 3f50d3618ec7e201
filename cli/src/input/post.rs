//! Readings that others post: JSON, doa.xml, lines, or the fields of a form, as a KrakenSDR posts them.

use std::sync::Arc;

use axum::{
    Router,
    body::Bytes,
    extract::{DefaultBodyLimit, State},
    http::{HeaderMap, StatusCode, header::CONTENT_TYPE},
    response::IntoResponse,
    routing::any,
};
use serde_json::json;
use tokio::net::TcpListener;

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};
use crate::web::connections;

/// The most bytes of a reading.
const LARGEST: usize = 1 << 20;

/// Takes posts at any path. Who gets 200 may be sure that the reading was used and is in the log.
pub async fn run(address: String, feed: Feed) {
    again(&feed.status, || listen(&address, &feed)).await;
}

async fn listen(address: &str, feed: &Feed) -> Result<Never, Failure> {
    let cannot = |error| Failure::closed(format!("{address}: {error}"));
    let listener = TcpListener::bind(address).await.map_err(cannot)?;
    feed.status.opened();
    let app = Router::new()
        .fallback(any(take))
        .layer(DefaultBodyLimit::max(LARGEST))
        .with_state(Arc::new(feed.clone()));
    connections::serve(listener, app).await;
    Err(Failure::open(format!("{address}: closed")))
}

async fn take(
    State(feed): State<Arc<Feed>>,
    method: axum::http::Method,
    headers: HeaderMap,
    body: Bytes,
) -> impl IntoResponse {
    if method != axum::http::Method::POST {
        let error = json!({"error": "readings are posted"});
        return (StatusCode::METHOD_NOT_ALLOWED, axum::Json(error));
    }
    let kind = headers
        .get(CONTENT_TYPE)
        .and_then(|kind| kind.to_str().ok());
    let is_form = kind.is_some_and(|kind| kind.starts_with("application/x-www-form-urlencoded"));
    let message = match is_form.then(|| foxhunt_decode::form(&body)).flatten() {
        Some(fields) => fields.into_bytes(),
        None => body.to_vec(),
    };
    match feed.taken(&message).await {
        Ok(seq) => (StatusCode::OK, axum::Json(json!({"seq": seq}))),
        Err(error) => (StatusCode::BAD_REQUEST, axum::Json(json!({"error": error}))),
    }
}
