//! The firmware `beacon_gateway` with packets as binary frames.
//!
//! ```sh
//! cargo xtask demo tunnel --frames
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt::gateway::beacon::Framing;
use foxhunt_gateways::tunnel::{Gateway, gateway};

foxhunt_emulated::firmware!(Gateway = gateway(Framing::Frames));
