//! A firmware like `vehicle_robust` that goes on after a reset, be it of its watchdog or by a supply that failed for a moment.
//!
//! ```sh
//! cargo firmware vehicle_kept
//! cargo run --example vehicle_kept FILE   # the same gateway on the host
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

mod keep;

use keep::Gateway;

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, Gateway::push);
