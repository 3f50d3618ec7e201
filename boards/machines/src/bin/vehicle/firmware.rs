//! The firmware. `cargo xtask replay` counts what could panic in it.

use embassy_executor::{Executor, Spawner};
use foxhunt_boards::{Board, MainLoop, vehicle::Hunt};
use foxhunt_gateways::plain::{CONFIG, Gateway};

use crate::uart::Uart;

/// The emulator needs no watchdog.
struct Emulator;

impl Board for Emulator {
    fn feed(&mut self) {}

    async fn tick(&mut self) {
        core::future::pending().await
    }
}

#[embassy_executor::task]
async fn hunt(gateway: &'static mut Gateway) {
    let hunt = Hunt::new(gateway, &CONFIG);
    MainLoop::new(hunt, [Uart::start()], Uart::start())
        .run_async(Emulator)
        .await
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut GATEWAY: Gateway = Gateway::EMPTY;
    static mut EXECUTOR: Option<Executor> = None;
    EXECUTOR.insert(Executor::new()).run(|spawner: Spawner| {
        // There is room for one such task.
        if let Ok(task) = hunt(GATEWAY) {
            spawner.spawn(task);
        }
    })
}

/// Nobody reads a log here.
#[defmt::global_logger]
struct Silence;

// SAFETY: it does nothing.
unsafe impl defmt::Logger for Silence {
    fn acquire() {}

    unsafe fn flush() {}

    unsafe fn release() {}

    unsafe fn write(_: &[u8]) {}
}

/// What the compiler puts into asynchronous code, for futures that are polled again after their end: nobody does.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
