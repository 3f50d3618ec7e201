//! What the methods of the published studies take: whole runs of each, on problems that the board simulates itself.
//!
//! `cargo xtask papers` runs it in the emulator, with a clock that counts instructions. The argument names the study.
//! Lines of `figure<TAB>name<TAB>value<TAB>unit` come back, one of each run.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bearings;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod scalar;
#[cfg(target_os = "none")]
#[path = "../board/semihosting.rs"]
mod semihosting;
#[cfg(target_os = "none")]
#[path = "../board/stopwatch.rs"]
mod stopwatch;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    let mut buffer = [0; 512];
    board::run(board::argument(&mut buffer));
    semihosting::exit(true)
}

/// Nothing: on the host, the methods run within the tasks.
#[cfg(not(target_os = "none"))]
fn main() {}
