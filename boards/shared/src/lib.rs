//! What the firmwares of real boards have in common.
//!
//! A board's own crate sets up clocks, pins and a watchdog. From there on, everything is here: a [`MainLoop`] reads
//! [`Lines`], gives their bytes to an [`Application`], and sends its reports. It has a form that waits, for firmware
//! without an executor, and one for Embassy. Both take any reader and writer of `embedded-io` or `embedded-io-async`.
//!
//! | module | holds |
//! |---|---|
//! | [`main_loop`], [`lines`] | the loop, in both forms |
//! | [`queue`] | a reader and a writer between an interrupt and the loop |
//! | [`either`] | lines of two kinds, such as USB and UART |
//! | [`vehicle`], [`tunnel`] | the gateways as applications |
//! | [`radio`] | packets of tags, from the air and from board to board |
//! | [`slots`], [`kept`] | snapshots in pages of flash |

#![no_std]

pub mod either;
pub mod kept;
pub mod lines;
pub mod main_loop;
pub mod queue;
pub mod radio;
pub mod slots;
pub mod tunnel;
pub mod vehicle;

pub use lines::Lines;
pub use main_loop::{Application, Board, MainLoop};
