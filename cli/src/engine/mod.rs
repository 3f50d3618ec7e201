//! The search: pieces of what comes in, and what follows from them. Live and in a replay it is the same, to the last bit.

mod board;
mod commands;
mod dates;
mod gateways;
mod health;
mod hunt;
mod input;
mod kept;
pub mod message;
mod outliers;
mod piece;
mod refused;
mod reported;
mod search;
mod setup;
mod site;
mod words;

pub use piece::{Command, Piece, What};
pub use refused::{legible, why};
pub use search::{Engine, Happened};
pub use setup::Setup;
pub use site::DEMO_MAP;
pub use words::code;
