//! The page, and what it asks.

mod api;
pub mod connections;
mod files;
mod guard;
mod shared;
mod start;
mod tiles;

pub use start::start;
