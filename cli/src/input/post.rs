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
use serde_json::{Map, Value, json};
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
    let message = match is_form.then(|| form(&body)).flatten() {
        Some(fields) => fields.into_bytes(),
        None => body.to_vec(),
    };
    match feed.taken(&message).await {
        Ok(seq) => (StatusCode::OK, axum::Json(json!({"seq": seq}))),
        Err(error) => (StatusCode::BAD_REQUEST, axum::Json(json!({"error": error}))),
    }
}

/// The fields of a form as JSON; `None` if it has none, as JSON that was posted without its type.
fn form(body: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(body).ok()?;
    let mut fields = Map::new();
    for pair in text.split('&') {
        let (name, value) = pair.split_once('=')?;
        fields.insert(decoded(name)?, Value::String(decoded(value)?));
    }
    Some(Value::Object(fields).to_string())
}

/// Text of a form: a plus is a blank, a percent begins the two digits of a byte.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digit = |byte: u8| char::from(byte).to_digit(16);
                let value = 16 * digit(rest.next()?)? + digit(rest.next()?)?;
                u8::try_from(value).ok()?
            }
            byte => byte,
        });
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms() {
        let fields = form(b"radiobearing=297&id=fox+1&doaarray=%2C+0.00%2C+1.50").unwrap();
        let fields: Value = serde_json::from_str(&fields).unwrap();
        assert_eq!(fields["id"], "fox 1");
        assert_eq!(fields["doaarray"], ", 0.00, 1.50");
        for none in ["{\"a\":1}", "a=%", "a=%zz", "a"] {
            assert_eq!(form(none.as_bytes()), None);
        }
    }
}
