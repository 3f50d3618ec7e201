//! Measuring firmware without a board: what it executes, how long that takes, what it occupies.

pub mod cortex_m4;
pub mod disassembly;
pub mod panic_sites;
pub mod panics;
pub mod regions;
pub mod sections;
pub mod stack;
