//! The proof that the library cannot panic: this firmware calls all of it with arguments that the compiler
//! cannot see, and its panic handler calls a function that does not exist. It links only if no path to the
//! handler is left.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bearings;
#[cfg(target_os = "none")]
mod entry;
#[cfg(target_os = "none")]
mod filters;
#[cfg(target_os = "none")]
mod fingerprints;
#[cfg(target_os = "none")]
mod gateways;
#[cfg(target_os = "none")]
mod values;

/// Nothing: it is not for the host.
#[cfg(not(target_os = "none"))]
fn main() {}
