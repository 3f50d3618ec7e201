//! The end of a program in the emulator.

use core::panic::PanicInfo;

// Brings the critical section that printing needs.
use cortex_m as _;
use cortex_m_semihosting::{debug, hprintln};

/// Switches the emulator off; its exit code is 0 for success.
pub fn exit(success: bool) -> ! {
    debug::exit(if success {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    // The emulator is off by now.
    loop {
        cortex_m::asm::wfi();
    }
}

/// Prints a panic, and ends with failure.
pub fn panicked(info: &PanicInfo) -> ! {
    hprintln!("{}", info);
    exit(false)
}
