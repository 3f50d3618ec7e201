//! What is simulated alike on a desk, in a browser and in tests.
//!
//! There is no `std` here, and so no sine and no logarithm but those of `libm`: every platform computes the same bits.
//!
//! - [`random`]: generators and normal samples; [`path`]: where something is at a time;
//! - [`Sight`]: a bearing in f64; [`faults`]: what goes wrong with bearings;
//! - [`scenario`]: a vehicle that drives past sources and takes bearings of them;
//! - [`tunnel`]: a tunnel with beacons, its survey and walks through it; [`survey`]: what a survey is;
//! - [`people`]: eight people in that tunnel; [`sentence`]: lines with a checksum.

#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod faults;
pub mod path;
pub mod people;
pub mod random;
pub mod scenario;
pub mod sentence;
pub mod sight;
pub mod survey;
pub mod tunnel;

pub use sight::Sight;
