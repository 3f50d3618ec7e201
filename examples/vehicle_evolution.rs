//! The firmware `vehicle` with differential evolution to move its particles.
//!
//! ```sh
//! cargo firmware vehicle_evolution
//! cargo run --example vehicle_evolution FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::evolution::{CONFIG, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
