//! What handlers share.

use std::{path::PathBuf, sync::Arc};

use crate::live::{Search, hub::Hub};

/// What handlers share.
pub struct Shared {
    pub hub: Arc<Hub>,
    pub search: Search,
    pub background: Option<PathBuf>,
}
