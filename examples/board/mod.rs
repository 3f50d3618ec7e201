//! What the firmwares of gateways share: everything but the gateway, which the example names.

#[cfg(not(target_os = "none"))]
pub mod host;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod main_loop;
#[cfg(target_os = "none")]
mod uart;
#[cfg(target_os = "none")]
mod watchdog;
