//! The firmware `vehicle` with a school of fish to move its particles.
//!
//! ```sh
//! cargo firmware vehicle_fish
//! cargo run --example vehicle_fish FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;
mod gateways {
    pub mod fish;
}

use gateways::fish::{Gateway, gateway};

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    board::host::run()
}
