//! The emulated board, QEMU's `mps2-an386`: a Cortex-M4F with the parts that its firmwares have in common.
//!
//! A *firmware* reads its UARTs for ever, and proves by linking that it cannot panic: [`firmware!`]. A *program* computes
//! something, prints by semihosting and switches the board off: [`program!`]. On the host, [`host`] stands in for the
//! board of a firmware.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(not(target_os = "none"))]
pub mod host;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
pub mod main_loop;
#[cfg(target_os = "none")]
pub mod map;
#[cfg(target_os = "none")]
pub mod region;
#[cfg(target_os = "none")]
pub mod semihosting;
#[cfg(target_os = "none")]
pub mod stopwatch;
#[cfg(target_os = "none")]
pub mod uart;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(target_os = "none")]
pub use cortex_m_rt::{entry, exception};

/// Makes a firmware of a gateway: `firmware!(Type = EMPTY, push)`, with a constant state, and a function or closure that
/// gives the state a byte of a port, which is the number of a UART.
///
/// The type has `report(&self) -> &str`. On the host, the same gateway reads a file or the standard input, as port 0.
#[macro_export]
macro_rules! firmware {
    ($gateway:ty = $empty:expr, $push:expr $(,)?) => {
        #[cfg(target_os = "none")]
        #[$crate::entry]
        fn main() -> ! {
            static mut GATEWAY: $gateway = $empty;
            static mut QUEUES: $crate::main_loop::Queues = $crate::main_loop::Queues::new();
            $crate::main_loop::run(GATEWAY, $push, <$gateway>::report, QUEUES)
        }

        #[cfg(target_os = "none")]
        #[$crate::exception]
        fn SysTick() {}

        #[cfg(target_os = "none")]
        #[$crate::exception]
        unsafe fn DefaultHandler(number: i16) {
            $crate::uart::interrupt(number);
        }

        #[cfg(target_os = "none")]
        unsafe extern "C" {
            // SAFETY: it does not exist, so a firmware in which it could be called does not link.
            safe fn the_firmware_can_panic() -> !;
        }

        /// The proof that nothing in the firmware panics: it links.
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo) -> ! {
            the_firmware_can_panic()
        }

        #[cfg(not(target_os = "none"))]
        fn main() -> std::io::Result<()> {
            $crate::host::run($empty, $push, <$gateway>::report)
        }
    };
}

/// Makes a program of a function: a panic is printed, and the exit code of the emulator is then 1. On the host it does
/// nothing, unless `board:` stands before the function, and a `main` beside it.
#[macro_export]
macro_rules! program {
    ($main:path) => {
        #[cfg(not(target_os = "none"))]
        fn main() {}

        $crate::program!(board: $main);
    };
    (board: $main:path) => {
        #[cfg(target_os = "none")]
        #[$crate::entry]
        fn main() -> ! {
            $main();
            $crate::semihosting::exit(true)
        }

        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(info: &core::panic::PanicInfo) -> ! {
            $crate::semihosting::panicked(info)
        }
    };
}
