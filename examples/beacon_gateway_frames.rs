//! The firmware `beacon_gateway` with packets as binary frames.
//!
//! ```sh
//! cargo xtask demo tunnel --frames
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;
mod gateways {
    pub mod tunnel;
}

use foxhunt::gateway::beacon::Framing;
use gateways::tunnel::{self, Gateway};

const fn gateway() -> Gateway {
    tunnel::gateway(Framing::Frames)
}

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    board::host::run()
}
