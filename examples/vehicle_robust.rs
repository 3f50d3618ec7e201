//! The firmware `vehicle` for bearings of which some are wrong.
//!
//! ```sh
//! cargo firmware vehicle_robust
//! cargo run --example vehicle_robust FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::robust::{CONFIG, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
