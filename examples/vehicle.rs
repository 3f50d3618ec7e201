//! The firmware of a vehicle: what its receiver and its direction finder say comes in by UART0 to UART2, where the
//! transmitter is goes out by UART0.
//!
//! ```sh
//! cargo xtask demo              # a whole drive through the emulated board, with a picture
//! cargo firmware vehicle        # the board alone, its UART0 on this terminal
//! cargo firmware vehicle -- -serial /dev/ttyUSB0 -serial /dev/ttyUSB1   # with a receiver and a direction finder
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

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
