//! What handlers share.

use std::{path::PathBuf, sync::Arc};

use super::tiles::Tiles;
use crate::live::{Search, hub::Hub};

/// What handlers share.
pub struct Shared {
    pub hub: Arc<Hub>,
    pub search: Search,
    pub background: Option<PathBuf>,
    pub tiles: Option<Arc<Tiles>>,
}
