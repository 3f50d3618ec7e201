//! What the firmwares of an nRF52840 have in common.

#![no_std]

pub mod board;
pub mod hear;
pub mod storage;
