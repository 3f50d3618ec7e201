//! Work that is begun again when it fails.

use std::{fmt::Display, future::Future, time::Duration};

use crate::live::Status;

/// Does something again and again; waits longer after each failure, up to half a minute. The work says by its error that it has
/// failed, and by its success that it ran for a while.
pub async fn again<F>(status: &Status, mut work: impl FnMut() -> F)
where
    F: Future<Output = Result<Never, Failure>>,
{
    const SHORTEST: Duration = Duration::from_millis(250);
    const LONGEST: Duration = Duration::from_secs(30);
    let mut wait = SHORTEST;
    loop {
        let Err(failure) = work().await;
        status.lost(&failure.why);
        if failure.was_open {
            wait = SHORTEST;
        }
        tokio::time::sleep(wait).await;
        wait = LONGEST.min(2 * wait);
    }
}

/// What work that never ends by itself gives.
pub enum Never {}

/// Why an input or output is lost.
pub struct Failure {
    why: String,
    was_open: bool,
}

impl Failure {
    /// It could not be opened.
    pub fn closed(why: impl Display) -> Self {
        Self {
            why: why.to_string(),
            was_open: false,
        }
    }

    /// It was open for a while.
    pub fn open(why: impl Display) -> Self {
        Self {
            why: why.to_string(),
            was_open: true,
        }
    }
}
