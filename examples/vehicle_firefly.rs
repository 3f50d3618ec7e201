//! The firmware `vehicle` with a swarm of fireflies to move its particles.
//!
//! ```sh
//! cargo firmware vehicle_firefly
//! cargo run --example vehicle_firefly FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::firefly::{CONFIG, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
