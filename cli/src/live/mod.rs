//! A search as it happens: inputs, the thread of the search, outputs, the page.

mod clock;
mod core;
pub mod hub;
mod run;
mod status;
mod view;

pub use clock::now_ms;
pub use core::{Ask, Search};
pub use run::{Extra, check, run};
pub use status::Status;
