//! foxhunt for C: a static library, with the header `include/foxhunt.h`.
//!
//! | file | holds |
//! |---|---|
//! | `sizes` | how many particles, bearings, ports, tags, beacons and points there is room for |
//! | `types` | the library's types of these sizes |
//! | `door` | where pointers of C become references of Rust: the only file with `unsafe` code |
//! | `result` | what functions return, with texts |
//! | `reasons` | why gateways reject lines and messages |
//! | `words` | observations, answers, the generator |
//! | `clean`, `robust`, `several` | locators |
//! | `vehicle` | the gateway of a vehicle |
//! | `tracker`, `beacon` | the tracker of one tag, and the gateway of many |
//! | `table` | the sizes of all types, for the header |
//!
//! All memory is the caller's. Nothing is allocated, nothing waits, nothing panics: the panic handler calls a function that
//! does not exist, so a program that could panic does not link.
#![cfg_attr(not(test), no_std)]

pub mod beacon;
pub mod clean;
mod door;
mod locator;
pub mod reasons;
pub mod result;
pub mod robust;
pub mod several;
pub mod sizes;
mod table;
#[cfg(test)]
mod tests;
pub mod tracker;
pub mod types;
pub mod vehicle;
pub mod words;
