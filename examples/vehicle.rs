//! The firmware of a vehicle: what its receiver and its direction finder say comes in by the UART, where the
//! transmitter is goes out by it.
//!
//! ```sh
//! cargo xtask demo              # a whole drive through the emulated board, with a picture
//! cargo firmware vehicle        # the board alone, its UART on this terminal
//! cargo run --example vehicle FILE   # the same gateway on the host
//! ```
//!
//! `vehicle_fish`, `vehicle_firefly` and `vehicle_evolution` are the same with refinements. The gateway is in
//! `foxhunt_gateways`, what the firmwares of the board have in common in `foxhunt_emulated`.
//!
//! It logs by defmt over semihosting if it was built to: `DEFMT_LOG=info cargo firmware vehicle`. Without a
//! debugger semihosting stops a real board, so the default is silence.

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::plain::{CONFIG, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, byte| gateway
    .push(0, byte, &CONFIG));
