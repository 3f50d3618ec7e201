//! The firmware `vehicle` for bearings of which some are wrong.
//!
//! ```sh
//! cargo firmware vehicle_robust
//! cargo run --example vehicle_robust FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;
mod gateways {
    pub mod robust;
}

use gateways::robust::{Gateway, gateway};

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    board::host::run()
}
