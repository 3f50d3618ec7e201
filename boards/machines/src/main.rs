//! The cases of `tests/portable` on a machine of another core: a Cortex-M0+, M3, M7, M33 or M55, a RISC-V one, or one that
//! runs WebAssembly. What they compute must be the same to the last bit everywhere.
//!
//! `cargo xtask machines` builds and runs it on all of them.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(any(target_os = "none", target_family = "wasm"), no_main)]

use foxhunt_portable as cases;

#[cfg(target_os = "none")]
mod start {
    #[cfg(target_arch = "riscv32")]
    use riscv_rt::entry;
    #[cfg(target_arch = "arm")]
    use {cortex_m as _, cortex_m_rt::entry};

    #[entry]
    fn main() -> ! {
        for case in crate::cases::all() {
            semihosting::println!("{}", case.0);
            crate::cases::check(case);
        }
        semihosting::process::exit(0)
    }
}

/// For a program that runs WebAssembly: how many cases there are.
#[cfg(target_family = "wasm")]
#[unsafe(no_mangle)]
pub extern "C" fn count() -> usize {
    cases::all().count()
}

/// For the same: runs the case of this number, and traps if it does not hold.
#[cfg(target_family = "wasm")]
#[unsafe(no_mangle)]
pub extern "C" fn check(case: usize) {
    if let Some(case) = cases::all().nth(case) {
        cases::check(case);
    }
}

#[cfg(not(any(target_os = "none", target_family = "wasm")))]
fn main() {
    for case in cases::all() {
        println!("{}", case.0);
        cases::check(case);
    }
}
