//! The main loop of a gateway's firmware, round the gateway that the example names.

use cortex_m::Peripherals;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use heapless::spsc::Queue;

use super::{uart, uart::Uart, watchdog::Watchdog};
use crate::{Gateway, gateway};

/// What arrives in a third of a second at 115,200 baud, while a gateway works on a message.
const RECEIVED_BYTES: usize = 4_096;
const SENT_BYTES: usize = 1_024;

const WATCHDOG_SECONDS: u32 = 10;
/// Ten times a second at 25 MHz: an idle board wakes to feed its watchdog.
const TICKS: u32 = 2_500_000;

#[entry]
fn main() -> ! {
    static mut GATEWAY: Gateway = gateway();
    static mut RECEIVED: Queue<u8, RECEIVED_BYTES> = Queue::new();
    static mut TO_SEND: Queue<u8, SENT_BYTES> = Queue::new();

    if let Some(mut core) = Peripherals::take() {
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(TICKS - 1);
        core.SYST.clear_current();
        core.SYST.enable_interrupt();
        core.SYST.enable_counter();
    }
    let mut watchdog = Watchdog::start(WATCHDOG_SECONDS);
    let mut uart = Uart::start(RECEIVED, TO_SEND);
    let mut overruns = 0;
    // Bytes of the present report that were handed to the UART.
    let mut sent = 0;
    defmt::info!("ready");

    // One byte a turn: the work between two feedings of the watchdog is bounded.
    loop {
        watchdog.feed();
        let unsent = GATEWAY.report().as_bytes().get(sent..).unwrap_or_default();
        // With interrupts held back none can slip in between the question and the sleep; a held one wakes.
        cortex_m::interrupt::free(|_| {
            let is_ready = match unsent {
                [] => uart.has_received(),
                _ => uart.has_room(),
            };
            if !is_ready {
                cortex_m::asm::wfi();
            }
        });
        // The next byte is taken when the report of the last one is on its way: reports are never cut.
        if !unsent.is_empty() {
            sent += uart.write(unsent);
        } else if let Some(byte) = uart.read()
            && let Some(event) = GATEWAY.push(byte)
        {
            sent = 0;
            defmt::info!("{}", event);
        }
        if uart.overruns() != overruns {
            overruns = uart.overruns();
            defmt::warn!("{} overruns of the receiver", overruns);
        }
    }
}

#[exception]
fn SysTick() {}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    uart::interrupt(number);
}

unsafe extern "C" {
    // SAFETY: it does not exist, so a firmware in which it could be called does not link.
    safe fn the_firmware_can_panic() -> !;
}

/// The proof that nothing in the firmware panics: it links.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    the_firmware_can_panic()
}
