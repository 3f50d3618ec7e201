//! The time.

use std::time::{SystemTime, UNIX_EPOCH};

/// Milliseconds after 1970.
pub fn now_ms() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as i64)
}
