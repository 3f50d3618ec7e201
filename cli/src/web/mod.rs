//! The page, and what it asks.

mod api;
pub mod connections;
mod files;
mod guard;
mod shared;
mod start;

pub use start::start;
