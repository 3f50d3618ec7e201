//! One workload, driven through foxhunt and through other crates' particle filters, so that their
//! cost is measured side by side: in one process on the host, in one image on the microcontroller.

#![no_std]

extern crate alloc;

pub mod filters;
pub mod workload;
