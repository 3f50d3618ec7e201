//! The firmware `vehicle` with a school of fish to move its particles.
//!
//! ```sh
//! cargo firmware vehicle_fish
//! cargo run --example vehicle_fish FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::fish::{CONFIG, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
