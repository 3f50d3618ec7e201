//! The firmware `beacon_gateway` with packets as binary frames.
//!
//! ```sh
//! cargo xtask demo tunnel --frames
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::tunnel::{FRAMES, Gateway};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, _, byte| {
    gateway.push(byte, &FRAMES)
});
