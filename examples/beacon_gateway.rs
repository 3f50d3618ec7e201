//! The firmware of a tunnel's gateway: what its radios hear of tags comes in by the UART, where the tags are goes out by
//! it.
//!
//! ```sh
//! cargo xtask demo tunnel              # eight people through the emulated board, with pictures
//! cargo firmware beacon_gateway        # the board alone, its UART on this terminal
//! cargo run --example beacon_gateway examples/data/tunnel.packets   # the same gateway on the host
//! FOXHUNT_MAP=$PWD/site.map cargo firmware beacon_gateway           # with the radio map of another site
//! ```
//!
//! Packets come as sentences; as binary frames in `beacon_gateway_frames`. The gateway is in `foxhunt_gateways`, what
//! the firmwares of the board have in common in `foxhunt_emulated`.

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_gateways::tunnel::{Gateway, LINES};

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, _, byte| {
    gateway.push(byte, &LINES)
});
