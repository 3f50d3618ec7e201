//! Begins to serve the page.

use std::{net::SocketAddr, sync::Arc};

use anyhow::{Context, Result};
use axum::{Router, middleware};
use tokio::net::TcpListener;

use super::{
    api, connections, files,
    guard::{self, Guard},
    shared::Shared,
    tiles::Tiles,
};
use crate::{
    live::{Search, hub::Hub},
    settings,
};

/// Begins to serve the page; says where.
///
/// # Errors
/// If the address cannot be listened at, or tiles cannot be read.
pub async fn start(told: &settings::Web, hub: Arc<Hub>, search: Search) -> Result<SocketAddr> {
    let tiles = told.tiles.as_deref().map(Tiles::open).transpose()?;
    let listener = TcpListener::bind(&told.listen)
        .await
        .with_context(|| format!("cannot serve the page at {}", told.listen))?;
    let address = listener.local_addr()?;
    let guard = Guard::new(address, told.token.clone())?;
    match guard.token() {
        Some(token) => eprintln!("page: http://{address}/?token={token}"),
        None => eprintln!("page: http://{address}/"),
    }
    let shared = Shared {
        hub,
        search,
        background: told.background.clone(),
        tiles: tiles.map(Arc::new),
    };
    let app = Router::new()
        .nest("/api", api::routes())
        .fallback(files::file)
        .with_state(Arc::new(shared))
        .layer(middleware::from_fn_with_state(
            Arc::new(guard),
            guard::check,
        ));
    tokio::spawn(connections::serve(listener, app));
    Ok(address)
}
