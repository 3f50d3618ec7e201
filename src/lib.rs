#![no_std]
#![doc = include_str!("../README.md")]

pub mod aoa;
pub mod estimate;
pub mod filter;
#[cfg(feature = "gateway")]
pub mod gateway;
pub mod math;
pub mod model;
pub mod particles;
pub mod random;
pub mod resample;
pub mod weights;
