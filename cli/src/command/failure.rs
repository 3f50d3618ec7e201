//! Why a command has an exit code of its own.

/// A log has no bearing that was used.
#[derive(Debug)]
pub struct NothingUsed(pub String);

impl std::fmt::Display for NothingUsed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for NothingUsed {}
