//! The firmware `vehicle` with differential evolution to move its particles.
//!
//! ```sh
//! cargo firmware vehicle_evolution
//! cargo run --example vehicle_evolution FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;
mod gateways {
    pub mod evolution;
}

use gateways::evolution::{Gateway, gateway};

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    board::host::run()
}
