//! The gateways of the firmwares, configured.
//!
//! A firmware, its twin on the host and the tests of both take the gateway from here, so they run the very same one.
//!
//! | module | firmware |
//! |---|---|
//! | [`plain`] | `vehicle` |
//! | [`board`] | those of real boards in `boards` |
//! | [`fish`], [`firefly`], [`evolution`] | `vehicle_fish` and so on: `vehicle` with a refinement |
//! | [`robust`] | `vehicle_robust` |
//! | [`kept`] | `vehicle_kept` |
//! | [`corridor`] | that of a real board in a tunnel |
//! | `tunnel` (a feature) | `beacon_gateway`, `beacon_gateway_frames` |

#![no_std]

pub mod board;
pub mod corridor;
pub mod evolution;
pub mod firefly;
pub mod fish;
pub mod kept;
pub mod plain;
pub mod robust;
#[cfg(feature = "tunnel")]
pub mod tunnel;

/// Ports of a vehicle's gateway: a computer, a receiver and a direction finder, at any of them.
pub const PORTS: usize = 3;
