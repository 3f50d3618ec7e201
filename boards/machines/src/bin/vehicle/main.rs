//! The gateway of a vehicle on a machine of another core. On one of Arm it is driven by what real boards are driven by: the
//! main loop of `foxhunt-boards` under Embassy's executor, on UART0.
//!
//! `cargo xtask replay` sends it a recorded drive.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(any(target_os = "none", target_family = "wasm"), no_main)]

#[cfg(target_arch = "arm")]
mod firmware;
#[cfg(target_arch = "arm")]
mod uart;
#[cfg(target_family = "wasm")]
mod web;

#[cfg(not(any(target_os = "none", target_family = "wasm")))]
fn main() {}
