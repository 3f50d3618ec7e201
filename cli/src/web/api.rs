//! What the page asks.

use std::{convert::Infallible, sync::Arc, time::Duration};

use axum::{
    Json, Router,
    extract::{DefaultBodyLimit, Path, Query, State, rejection::JsonRejection},
    http::{
        HeaderMap, StatusCode,
        header::{CACHE_CONTROL, CONTENT_TYPE},
    },
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
    routing::{get, post},
};
use futures_util::{
    Stream, StreamExt,
    stream::{iter, unfold},
};
use serde::Deserialize;
use serde_json::{Value, json};

use super::shared::Shared;
use crate::{engine::Command, live::hub::Reader};

/// The most bytes of a request.
const LARGEST: usize = 1 << 14;

/// All that can be asked.
pub fn routes() -> Router<Arc<Shared>> {
    Router::new()
        .route("/state", get(state))
        .route("/events", get(events))
        .route("/retract", post(retract))
        .route("/undo", post(undo))
        .route("/mark", post(mark))
        .route("/background.geojson", get(background))
        .route("/tiles", get(tiles))
        .route("/tiles/{zoom}/{column}/{row}", get(tile))
        .fallback(nothing)
        .layer(DefaultBodyLimit::max(LARGEST))
}

async fn nothing() -> Response {
    refused(StatusCode::NOT_FOUND, "there is nothing of this name")
}

fn refused(status: StatusCode, error: impl Into<Value>) -> Response {
    (status, Json(json!({"error": error.into()}))).into_response()
}

async fn state(State(shared): State<Arc<Shared>>) -> Json<Value> {
    let (seq, messages) = shared.hub.state();
    Json(json!({"seq": seq, "messages": messages}))
}

#[derive(Deserialize)]
struct After {
    after: Option<u64>,
}

async fn events(
    State(shared): State<Arc<Shared>>,
    Query(After { after }): Query<After>,
    headers: HeaderMap,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let last = headers.get("last-event-id");
    let last = last.and_then(|id| id.to_str().ok()?.trim().parse().ok());
    let now = shared.hub.seq();
    // A number from before this run, or of the future, is of no use: all that is known is told then.
    let after = last.or(after).unwrap_or(now);
    let begin = if after > now { 0 } else { after };
    let reader = shared.hub.reader(begin);
    Sse::new(stream(shared, reader)).keep_alive(KeepAlive::new().interval(Duration::from_secs(5)))
}

fn stream(shared: Arc<Shared>, reader: Reader) -> impl Stream<Item = Result<Event, Infallible>> {
    let next = |(shared, mut reader): (Arc<Shared>, Reader)| async move {
        let (items, lost) = reader.next().await?;
        let mut events = Vec::new();
        if lost > 0 {
            // Who has missed something is told everything.
            let (seq, messages) = shared.hub.state();
            for message in messages {
                let json = serde_json::to_string(&message).unwrap_or_default();
                events.push(Ok(Event::default().id(seq.to_string()).data(json)));
            }
            reader = shared.hub.reader(seq);
        } else {
            let told = items.iter().filter(|item| !item.json.is_empty());
            events.extend(told.map(|item| {
                let event = Event::default().id(item.seq.to_string());
                Ok(event.data(&item.json))
            }));
        }
        Some((iter(events), (shared, reader)))
    };
    unfold((shared, reader), next).flatten()
}

/// What a command led to.
async fn done(shared: &Shared, command: Command) -> Response {
    match shared.search.command(command).await {
        Ok(seq) => Json(json!({"seq": seq})).into_response(),
        Err(error) => refused(StatusCode::CONFLICT, error),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Retract {
    id: u64,
}

async fn retract(
    State(shared): State<Arc<Shared>>,
    body: Result<Json<Retract>, JsonRejection>,
) -> Response {
    match body {
        Ok(Json(Retract { id })) => done(&shared, Command::Retract(id)).await,
        Err(error) => refused(StatusCode::BAD_REQUEST, error.body_text()),
    }
}

async fn undo(State(shared): State<Arc<Shared>>) -> Response {
    done(&shared, Command::Undo).await
}

#[derive(Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum Mark {
    Put { lat: f64, lon: f64, text: String },
    Remove { id: u64, removed: bool },
}

async fn mark(
    State(shared): State<Arc<Shared>>,
    body: Result<Json<Mark>, JsonRejection>,
) -> Response {
    let command = match body {
        Ok(Json(Mark::Put { lat, lon, text })) => Command::Mark {
            latitude: lat,
            longitude: lon,
            text,
        },
        Ok(Json(Mark::Remove { id, removed: true })) => Command::Unmark(id),
        Ok(_) => return refused(StatusCode::BAD_REQUEST, "a mark cannot be put back"),
        Err(error) => return refused(StatusCode::BAD_REQUEST, error.body_text()),
    };
    done(&shared, command).await
}

async fn background(State(shared): State<Arc<Shared>>) -> Response {
    let Some(file) = &shared.background else {
        return nothing().await;
    };
    match tokio::fs::read(file).await {
        Ok(bytes) => ([(CONTENT_TYPE, "application/geo+json")], bytes).into_response(),
        Err(_) => refused(StatusCode::NOT_FOUND, "the background cannot be read"),
    }
}

/// What tiles there are.
async fn tiles(State(shared): State<Arc<Shared>>) -> Response {
    match &shared.tiles {
        Some(tiles) => Json(tiles.about.clone()).into_response(),
        None => nothing().await,
    }
}

/// A tile; no content where the map has none.
async fn tile(State(shared): State<Arc<Shared>>, Path(which): Path<[u32; 3]>) -> Response {
    let Some(tiles) = shared.tiles.clone() else {
        return nothing().await;
    };
    let kind = tiles.kind;
    let found = tokio::task::spawn_blocking(move || tiles.tile(which)).await;
    match found {
        Ok(Ok(Some(tile))) => {
            let headers = [(CONTENT_TYPE, kind), (CACHE_CONTROL, "max-age=3600")];
            (headers, tile).into_response()
        }
        Ok(Ok(None)) => StatusCode::NO_CONTENT.into_response(),
        _ => refused(
            StatusCode::INTERNAL_SERVER_ERROR,
            "the tiles cannot be read",
        ),
    }
}
