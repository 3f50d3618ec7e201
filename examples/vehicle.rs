//! The firmware of a vehicle: what its receiver and its direction finder say comes in by the UART, where the
//! transmitter is goes out by it.
//!
//! ```sh
//! cargo xtask demo              # a whole drive through the emulated board, with a picture
//! cargo firmware vehicle        # the board alone, its UART on this terminal
//! cargo run --example vehicle FILE   # the same gateway on the host
//! ```
//!
//! `vehicle_fish`, `vehicle_firefly` and `vehicle_evolution` are the same with refinements. What is common to all is in
//! `board`.
//!
//! It logs by defmt over semihosting if it was built to: `DEFMT_LOG=info cargo firmware vehicle`. Without a
//! debugger semihosting stops a real board, so the default is silence.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;

use foxhunt::{
    aoa::locator::{self, Locator},
    gateway::{Settings, Vehicle},
};

/// Two hundred particles, a memory of 64 bearings, the settings for a car.
type Gateway = Vehicle<Locator<200, 64>>;

const fn gateway() -> Gateway {
    Vehicle::new(Settings::new(), Locator::new(locator::Settings::new()))
}

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    board::host::run()
}
